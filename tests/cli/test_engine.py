"""`kurt2rt train --engine compiled`."""

from pathlib import Path

from tests.cli.helpers import CommandLine

SHORT = ("--set", "teaching.supervised_s=5", "--set", "teaching.corrections_s=0", "--set", "exam.duration_s=2")


def test_train_goes_on_in_no_folder_in_which_a_witness_differs(kurt2rt: CommandLine) -> None:
    words = ("train", *SHORT, "--seeds", "1", "--jobs", "1", "--engine", "compiled")
    assert kurt2rt(*words).exit_code == 0
    (path,) = Path("results/train/results/witnesses").glob("*.json")
    path.write_text(path.read_text().replace('"differing":[]', '"differing":["lesson.asks"]'))
    for engine in ("compiled", "can"):
        assert "differ in lesson.asks; all results" in kurt2rt.refused(*words[:-1], engine)
