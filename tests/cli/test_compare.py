"""`kurt2rt study compare` as a user meets it."""

import json
from pathlib import Path

from tests.cli.helpers import CommandLine

SHORT = (
    *("--set", "teaching.supervised_s=3", "--set", "teaching.corrections_s=2", "--set", "exam.duration_s=2"),
    *("--set", "exam.worlds=[a]", "--seeds", "3904", "--checkpoint", "1", "--jobs", "1", "--out", "made"),
)
MINE = """
import my_helper
from kurt2rt.core.learner.rla_learner import RlaLearner

class Mine(RlaLearner):
    pass
"""


def test_learners_are_taught_once_and_compared(kurt2rt: CommandLine) -> None:
    words = ("study", "compare", "--learner", "k-nn", *SHORT)
    said = kurt2rt(*words, "--json")
    assert said.exit_code == 0, said.err
    document = json.loads(said.out)
    assert set(document) == {"tables", "not_judged", "figure", "report"}
    assert [row[1] for row in document["tables"][0]["rows"]] == ["RLA, as shipped", "5-NN with R"]
    assert Path(document["figure"]).is_file()
    kept = Path("made/results/k-nn/wall_following-3904.json")
    before = kept.stat().st_mtime_ns
    said = kurt2rt(*words)
    assert said.exit_code == 0, said.err
    assert "5-NN with R" in said.out
    assert "1 robot only" in said.out
    assert kept.stat().st_mtime_ns == before


def test_changed_helper_of_a_learner_is_named_as_the_difference(kurt2rt: CommandLine) -> None:
    Path("my_learner.py").write_text(MINE, encoding="utf-8")
    Path("my_helper.py").write_text("HERE = 1\n", encoding="utf-8")
    words = ("study", "compare", "--learner", "my_learner:Mine", *SHORT)
    assert kurt2rt(*words).exit_code == 0
    Path("my_helper.py").write_text("HERE = 2\n", encoding="utf-8")
    refused = kurt2rt.refused(*words)
    assert "my_learner.Mine" in refused
    assert "(what differs: learner)" in refused
