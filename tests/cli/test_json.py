"""--json in every command that reports: one JSON document on standard output, nothing else, and the same exit code."""

import json

import pytest

from tests.cli.helpers import CommandLine
from tests.runs.replay.stored_runs import STORED

WALLS = str(STORED / "walls.mcap")
SHORT = ("--set", "teaching.supervised_s=2", "--set", "teaching.corrections_s=1", "--set", "exam.duration_s=1")
REPORTS: dict[tuple[str, ...], set[str]] = {
    ("demo", *SHORT, "--set", "exam.worlds=[a]"): {"lesson", "task", "exams", "picture", "knowledge"},
    ("train", *SHORT): {"lesson", "task", "exams", "knowledge"},
    ("train", "--seeds", "7", "--jobs", "1", *SHORT): {"task", "robots", "teacher", "tables", "not_judged", "report"},
    ("exam", "mine.knowledge", "--world", "a", *SHORT[-2:]): {"knowledge", "seed", "task", "exams"},
    ("why", WALLS, "--at", "1"): {"run", "at_s", "facts", "tips", "difference", "trouble", "picture"},
    ("why", WALLS, "--to", "5", "--picture", "made.svg"): {
        *("run", "task", "from_s", "to_s", "ticks", "missed", "stretches", "notes", "trouble", "picture")
    },
    ("recording", "export", WALLS, "--out", "set"): {"folder", "fps", "runs"},
    ("pair", "--list"): {"paired"},
    ("knowledge", "list", "."): {"files", "unreadable"},
    ("knowledge", "lessons", "mine.knowledge"): {"file", "lessons", "older"},
    ("knowledge", "show", "mine.knowledge"): {
        *("file", "task", "robot", "definition", "lessons", "rlas", "named", "hidden")
    },
    ("knowledge", "check", "mine.knowledge"): {"file", "sound", "faults"},
    ("knowledge", "contradictions", "mine.knowledge"): {"file", "rlas", "contradictions"},
    ("knowledge", "table", "mine.knowledge"): {"table", "sha256"},
}


@pytest.mark.usefixtures("mine")
@pytest.mark.parametrize(("words", "keys"), REPORTS.items(), ids=[" ".join(words[:2]) for words in REPORTS])
def test_json_is_one_document_and_nothing_else(kurt2rt: CommandLine, words: tuple[str, ...], keys: set[str]) -> None:
    said = kurt2rt(*words, "--json")
    assert said.exit_code == 0, said.err
    assert set(json.loads(said.out)) == keys


def test_json_of_refused_input_leaves_standard_output_empty(kurt2rt: CommandLine) -> None:
    said = kurt2rt("knowledge", "show", "none", "--json")
    assert (said.exit_code, said.out) == (2, "")


@pytest.mark.usefixtures("mine")
def test_rlas_come_with_conditions_and_teachers(kurt2rt: CommandLine) -> None:
    rlas = json.loads(kurt2rt("knowledge", "show", "mine.knowledge", "--json").out)["rlas"]
    (first,) = [each for each in rlas if each["rla"] == 1]
    assert first["teacher"] == "scripted teacher"
    assert len(first["condition"]) == 72
    whole = json.loads(kurt2rt("knowledge", "show", "mine.knowledge", "--rla", "1", "--json").out)
    assert whole["condition"] == first["condition"]
    assert kurt2rt("knowledge", "show", "mine.knowledge", "--limit", "1", "--json").out.count('"rla":') == 1
