"""`kurt2rt replay`, of the stored runs."""

import json
from pathlib import Path

import pytest

from kurt2rt.core.outcome import Outcome, ResultCode
from kurt2rt.core.teaching.knowledge_updater import LessonResult
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.runs.replay.reader import read_run
from tests.cli.helpers import CommandLine
from tests.runs.replay.stored_runs import STORED
from tests.runs.replay.stories import slim

WALLS = STORED / "walls.mcap"


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the first 13 s of the stored run."""
    slim(WALLS, segment := tmp_path_factory.mktemp("short") / "walls.mcap", 13.0)
    return segment


@pytest.mark.deep
def test_a_whole_run_is_the_same_again(kurt2rt: CommandLine) -> None:
    said = json.loads(kurt2rt("replay", WALLS, "--json").out)
    assert (said["same"], said["ticks"]) == (True, 4400)


def test_settings_of_today_change_nothing(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, short: Path
) -> None:
    monkeypatch.setattr("config.settings_files.CONFIG_DIR", tmp_path / "there are none")
    settings = Path(__file__).parents[2] / "config" / "runtime" / "default.yaml"
    said = kurt2rt("replay", short, "--settings", settings)
    assert said.exit_code == 0, said.err


def test_replay_that_differs_names_the_field_and_ends_with_1(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, short: Path
) -> None:
    monkeypatch.setattr("kurt2rt.core.teaching.lesson_builder.LessonBuilder.build", _teaches_nothing)
    said = kurt2rt("replay", short)
    assert said.exit_code == 1
    assert said.out
    assert json.loads(kurt2rt("replay", short, "--json").out)["differences"][0]["field"]


def test_other_knowledge_looks_on(kurt2rt: CommandLine, tmp_path: Path, short: Path) -> None:
    run = read_run(short)
    some = [event for entry in run.entries() for event in entry.events][:4]
    knowledge = tmp_path / "some.knowledge"
    with open_knowledge(knowledge, run.robot, run.task) as journal:
        journal.append([JournalEntry(event, "2026-11-22T03:00:00Z") for event in some])
    said = kurt2rt("replay", short, "--compare", knowledge)
    assert said.exit_code == 0, said.err
    assert f" {knowledge}:" in said.out
    assert "; the longest:" in said.out
    as_json = json.loads(kurt2rt("replay", short, "--compare", knowledge, "--json").out)
    assert as_json["same"] is False
    assert sum(each["ticks"] for each in as_json["stretches"]) == (
        as_json["other_action"] + as_json["would_ask"] + as_json["would_drive"]
    )


def _teaches_nothing(*_: object) -> LessonResult:
    return LessonResult(Outcome(ResultCode.REPEATED))
