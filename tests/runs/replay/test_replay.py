"""A recorded run comes out again as it was: each decision, and all that is known, bit for bit."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from hal.robot import WheelSpeeds
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import BASIC, MID
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Resume, Teach, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_folder import segments_in
from kurt2rt.runs.recording.run_head import RunHead
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from kurt2rt.runs.replay.run import Run, RunSource
from tests.core.basic.helpers import keep, with_repertoire
from tests.processors import OF_2004, OF_2013
from tests.runs.replay.stored_runs import NAMES, STORED, stored
from tests.runs.replay.stories import NAME, STORIES, Scene, record_story

HERE = Path(__file__).parents[3]


def differences(run: Run) -> tuple[int, list[str]]:
    """Return the number of compared ticks, and the first differences."""
    ticks, found = 0, []
    for entry, record in Replay(run):
        ticks += 1
        found += [str(each) for each in compare(entry, record)]
    return ticks, found[:5]


@pytest.mark.parametrize("name", STORIES)
def test_a_stored_run_is_decided_again_as_it_was(name: str) -> None:
    run = read_run(STORED / f"{name}.mcap")
    assert differences(run) == (round(STORIES[name].seconds * 100), [])
    assert not run.trouble


@pytest.mark.parametrize(
    ("processor", "seconds"),
    [
        pytest.param(OF_2004, 5, id="of 2004"),
        pytest.param(OF_2004, 44, id="of 2004, whole", marks=pytest.mark.deep),
        pytest.param(OF_2013, 44, id="of 2013, whole", marks=pytest.mark.deep),
    ],
)
def test_on_other_processors_too(processor: dict[str, str], seconds: int) -> None:
    told = subprocess.run(
        [sys.executable, "-m", "tests.runs.replay.on_this_processor", str(seconds)],
        cwd=HERE,
        env={**os.environ, **processor},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (told.returncode, told.stdout.splitlines()) == (0, [f"{name}: the same" for name in NAMES]), told.stderr


def test_the_stored_run_holds_what_a_run_may_hold() -> None:
    """Or it would prove little."""
    walls = list(stored("walls").entries())
    kinds = {type(command).__name__ for entry in walls for command in entry.commands}
    assert {"Watch", "Drive", "Teach", "Correct", "Undo", "Reward", "Appraise", "PairingRenewed"} <= kinds
    events = {type(event).__name__ for entry in walls for event in entry.events}
    assert {"RlaCreated", "ActionReplaced", "ActionWithdrawn", "RlaRewarded", "LessonUndone"} <= events
    causes = {entry.decision.cause.value for entry in walls}
    assert {"rla", "held", "teacher", "unknown", "stopped", "unsaved"} <= causes
    assert any(entry.opinion is not None for entry in walls)
    errand = list(stored("errand").entries())
    assert any(entry.surprise is not None for entry in errand + walls)
    assert any(entry.decision.mid is not None and entry.decision.mid.event is not None for entry in errand)
    assert any(entry.decision.plan is not None for entry in errand)
    assert any(event.rla.level == MID for entry in errand for event in entry.events if hasattr(event, "rla"))


def test_verify_missing_lesson_is_the_first_difference() -> None:
    run = stored("walls")
    replay = Replay(run)
    for entry in run.entries():
        if entry.events:  # the first lesson does not come
            entry = entry._replace(commands=())
            break
        replay.step(entry)
    first = compare(entry, replay.step(entry))
    assert any(each.field == "events" for each in first)
    assert f"tick {entry.tick}" in str(first[0])


def test_replay_tells_zeros_by_sign_and_booleans_from_numbers() -> None:
    """Both are equal for Python, and not what was recorded."""
    entry, record = next(iter(Replay(stored("walls"))))
    still = entry.decision._replace(wheel_speeds=WheelSpeeds(-0.0, 0.0))
    (found,) = compare(entry._replace(decision=still), record)
    assert found.field == "decision.wheel_speeds.left_m_s"
    assert repr((found.recorded, found.replayed)) == "(-0.0, 0.0)"
    (found,) = compare(entry._replace(readings=entry.readings._replace(bumpers=False)), record)
    assert found.field == "readings.bumpers"


@pytest.fixture(scope="module")
def fresh(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run that was recorded just now, as the robot program records it."""
    return record_story("walls", tmp_path_factory.mktemp("runs"), seconds=6)


def test_run_just_recorded_is_replayed_from_its_folder(fresh: Path) -> None:
    run = read_run(fresh)
    assert differences(run) == (600, [])
    (segment,) = segments_in(fresh)
    assert read_run(segment).head == run.head


def test_a_torn_run_is_replayed_up_to_its_last_whole_chunk(fresh: Path, tmp_path: Path) -> None:
    (segment,) = segments_in(fresh)
    truncated = tmp_path / "torn.mcap"
    truncated.write_bytes(segment.read_bytes()[: segment.stat().st_size * 2 // 3])
    run = read_run(truncated)
    ticks, found = differences(run)
    assert 100 < ticks < 600
    assert found == []
    assert "torn.mcap" in run.trouble


def without(entries: Iterator[TickEntry], lost: range) -> Iterator[TickEntry]:
    return (entry for entry in entries if entry.number not in lost)


def part_of(run: Run, lost: range) -> Run:
    return Run("a run with a gap", run.head, run._attachments, RunSource(lambda: without(run._source.ticks(), lost)))


def test_replay_ends_at_a_gap_and_reports_it() -> None:
    run = part_of(stored("walls"), range(201, 204))
    assert differences(run) == (200, [])
    assert not run.has_no_gap
    assert run.trouble.startswith("3 ticks ")
    assert "(tick 204)" in run.trouble


def test_a_run_whose_beginning_is_gone_says_so() -> None:
    run = stored("walls")
    kept = {name: data for name, data in run._attachments.items() if name != "knowledge.jsonl"}
    with pytest.raises(RecordingError, match=r"late: .*knowledge\.jsonl"):
        Run("late", run.head, kept, run._source)


def test_damaged_settings_are_refused() -> None:
    run = stored("walls")
    kept = {**run._attachments, "settings/robot.json": b"{}"}
    with pytest.raises(RecordingError, match=r"worn: .*settings/robot\.json"):
        Run("worn", run.head, kept, run._source)


def test_settings_of_another_version_are_refused_with_its_name() -> None:
    run = stored("walls")
    head = RunHead(**{**{name: getattr(run.head, name) for name in RunHead.__slots__}, "fingerprints": {}})
    with pytest.raises(RecordingError, match=r"old: .* story,"):
        Run("old", head, {**run._attachments, "settings/robot.json": b"{}"}, run._source)


@pytest.mark.parametrize("name", ["settings/../../escaped", "/escaped", "settings/task.json/escaped"])
def test_a_run_that_would_write_elsewhere_is_refused(name: str) -> None:
    run = stored("walls")
    with pytest.raises(RecordingError, match=r"evil: .*escaped|evil: .*'settings/task\.json'"):
        Run("evil", run.head, {**run._attachments, name: b"!"}, run._source)


def test_read_run_of_another_file_raises_recording_error(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=re.escape(f"{tmp_path}: ")):
        read_run(tmp_path)
    with pytest.raises(RecordingError, match="nothing: "):
        read_run(tmp_path / "nothing")
    (tmp_path / "empty.mcap").write_bytes(b"")
    with pytest.raises(RecordingError, match=r"empty\.mcap: "):
        read_run(tmp_path / "empty.mcap")


def follow_the_wall(scene: Scene, record: TickRecord) -> None:
    """Drive by a taught action, which is lost now and then."""
    scene.runtime.inbox.put(Watch(NAME, record.tick))
    if record.tick == 20:
        scene.say(lambda name: Resume(name, NAME))
    if record.decision.asking and record.tick % 50 == 0:
        scene.say(lambda name: Teach(name, NAME, "follow" if record.tick < 300 else "curve_left"))


def test_taught_actions_are_stored_with_the_run(tmp_path: Path) -> None:
    task = load_task("wall_following")
    mine = tmp_path / "mine"
    mine.mkdir()
    taught = (event for entry in stored("walls", 20).entries() for event in entry.events)
    lessons = [event for event in taught if isinstance(event, RlaCreated) and event.rla.level == BASIC]
    keep(mine / "walls.knowledge", task, *lessons)
    follows = "kind: task, name: follow, task: wall_following, knowledge: walls.knowledge"
    curve = "kind: motor, name: curve_left, left_m_s: 0.1, right_m_s: 0.2"
    task = with_repertoire(task, mine, follows, curve)
    folder = record_story("walls", tmp_path / "runs", seconds=8, task=task, other=follow_the_wall)
    shutil.rmtree(mine)
    run = read_run(folder)
    assert any(entry.decision.action == "follow" for entry in run.entries())
    assert differences(run) == (800, [])


@pytest.mark.deep
@pytest.mark.parametrize("name", STORIES)
def test_so_is_a_run_of_some_minutes(name: str, tmp_path: Path) -> None:
    run = read_run(record_story(name, tmp_path, seconds=300))
    assert differences(run) == (30_000, [])
