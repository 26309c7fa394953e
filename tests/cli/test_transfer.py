"""`kurt2rt study transfer` as a user meets it."""

import json
from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine, results_in

WORDS = ("study", "transfer", "--checkpoint", "1", "--checkpoint", "0", "--teacher", "superhuman")
SHORT = (
    *("--set", "teaching.supervised_s=3", "--set", "teaching.corrections_s=2", "--set", "exam.duration_s=2"),
    *("--seconds", "3", "--jobs", "1", "--out", "made"),
)


def test_robots_are_taught_on_once_and_reported(kurt2rt: CommandLine) -> None:
    words = (*WORDS, "--seeds", "1100,1101", *SHORT)
    said = kurt2rt(*words, "--json")
    assert said.exit_code == 0, said.err
    document = json.loads(said.out)
    assert set(document) == {"tables", "not_judged", "figure", "report"}
    assert [row[:2] for row in document["tables"][-1]["rows"]] == [["1100", "rooms-1100"], ["1101", "rooms-1101"]]
    assert Path(document["figure"]).is_file()
    kept = Path("made/results/rooms-SEED/wall_following-1100.json")
    before = kept.stat().st_mtime_ns
    said = kurt2rt(*words)
    assert said.exit_code == 0, said.err
    assert "superhuman" in said.out
    assert kept.stat().st_mtime_ns == before


@pytest.mark.deep
def test_transfer_in_the_batch_has_the_results_of_the_bus(kurt2rt: CommandLine) -> None:
    words = (*WORDS, "--seeds", "1100", *SHORT[:-1])
    for engine in ("compiled", "can"):
        told = kurt2rt(*words, engine, "--engine", engine)
        assert told.exit_code == 0, told.err
    assert results_in("compiled") == results_in("can")
    assert len(list(Path("compiled/results/witnesses").rglob("*.json"))) == 2
