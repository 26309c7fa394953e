"""Changes of knowledge are tried on a recorded run before anything is changed."""

import io
import os
import re
import shutil
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from mcap.records import McapRecord, Message

from hal.robot_settings import load_robot
from kurt2rt.core.rla.events import RlaCreated, TeachingEvent
from kurt2rt.core.rla.lesson_history import lesson_stack
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import BeginSession, Resume, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.versions.undo import apply_plan, plan_redo, plan_undo
from kurt2rt.runs.recording.recover import _copy as copy_records
from kurt2rt.runs.recording.segment_reader import SegmentReader
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from kurt2rt.runs.replay.trial import compatible_runs, newest_compatible_run
from kurt2rt.runs.replay.undo_preview import preview, preview_on_newest
from tests.cli.helpers import CommandLine
from tests.knowledge.reading import folded
from tests.knowledge.refusals import refused
from tests.runs.replay.stories import NAME, Scene, record_story

STAMP = "2026-11-22T03:10:05.000+00:00"
FAR = (-5000.0,) * 72


def untaught(scene: Scene, record: TickRecord) -> None:
    """Send no command to the robot."""


def taught_at_once(scene: Scene, record: TickRecord) -> None:
    """Resume as soon as the robot runs, and answer each question."""
    if record.tick % 5 == 0:
        scene.runtime.inbox.put(Watch(NAME, record.tick))
    scene.let_teach(record)
    if record.tick == 10:
        scene.say(lambda name: BeginSession(name, NAME, "walls"))
        scene.say(lambda name: Resume(name, NAME))


def quietly(run: str, done_s: float, whole_s: float) -> None:
    """Ignore the progress."""


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with one run of five seconds, in which a robot was taught to follow a wall."""
    folder = tmp_path_factory.mktemp("runs")
    record_story("walls", folder, seconds=5, other=taught_at_once).rename(folder / "20260320T094640Z-wall_following")
    return folder


@pytest.fixture(scope="module")
def lessons(recordings: Path) -> list[TeachingEvent]:
    """Return the lessons of the run."""
    (path,) = recordings.iterdir()
    replay = Replay(read_run(path))
    for entry in replay.run.entries():
        replay.step(entry)
    return [record.event for record in replay.runtime.level.system.history.records if not record.undone]


def unneeded(lessons: list[TeachingEvent], number: int = 1) -> RlaCreated:
    """Return the creation of an RLA that is far from every situation of the run."""
    new_id = max(event.rla.rla_id for event in lessons if isinstance(event, RlaCreated)) + number
    return RlaCreated(Rla(new_id, FAR, "forward", None, Origin(f"far-{number}", "Ann", Phase.SUPERVISED, 1)))


@pytest.fixture
def knowledge(tmp_path: Path, lessons: list[TeachingEvent]) -> Path:
    """Return a knowledge file with the run's lessons and two unneeded RLAs."""
    path = tmp_path / "walls.knowledge"
    with open_knowledge(path, load_robot(), load_task("wall_following")) as journal:
        far = unneeded(lessons), unneeded(lessons, 2)
        journal.append([JournalEntry(event, STAMP) for event in (*lessons, *far)])
    return path


def test_no_run_or_none_that_fits_is_refused(knowledge: Path, recordings: Path, tmp_path: Path) -> None:
    with Journal.read_only(knowledge) as look:
        binding = look.binding
    for folder in (tmp_path, tmp_path / "nowhere"):
        with refused(KnowledgeCode.NO_RECORDED_RUN):
            compatible_runs(folder, binding)
    with refused(KnowledgeCode.NO_RUN_FITS):
        compatible_runs(recordings, replace(binding, feature_hash="another"))


def test_an_undo_is_tried_before_it_is_made(knowledge: Path, recordings: Path, lessons: list[TeachingEvent]) -> None:
    before = folded(knowledge)
    planned = plan_undo(knowledge, "far-2", teacher="Ann")
    assert [lesson_stack(record.event) for record in planned.lessons] == [before.rlas[-1].rla_id]
    shown = preview(planned, recordings, quietly)
    (tried,) = shown.runs
    assert tried.found.same
    assert (tried.from_s, tried.found.ticks, shown.notes) == (0.0, 500, ())
    assert preview_on_newest(planned, recordings, quietly) == shown

    first = next(event for event in lessons if isinstance(event, RlaCreated))
    planned = plan_undo(knowledge, taught_by=first.origin.teacher, teacher="Ann")
    assert len(planned.lessons) == len(lessons)
    (tried,) = preview(planned, recordings, quietly).runs
    # nothing would be left but what is far off
    assert (tried.found.other_action, tried.found.would_drive) == (0, 0)
    assert 0 < tried.found.would_ask <= tried.found.decided
    assert any(each.was.rla == folded(knowledge).get(first.rla.rla_id) for each in tried.found.stretches)
    assert folded(knowledge).rlas == before.rlas
    with refused(KnowledgeCode.LESSON_REFUSED):
        plan_undo(knowledge, "far-9", teacher="Ann")

    apply_plan(planned, STAMP)
    (back,) = preview(plan_redo(knowledge, taught_by=first.origin.teacher, teacher="Ann"), recordings, quietly).runs
    assert (back.found.would_ask, back.found.would_drive) == (0, tried.found.would_ask)


@pytest.fixture
def runs(recordings: Path, tmp_path: Path) -> Path:
    """Return a copy of the recordings, which the test may change."""
    return Path(shutil.copytree(recordings, tmp_path / "runs"))


def test_the_newest_run_is_tried_that_can_be(knowledge: Path, runs: Path) -> None:
    with Journal.read_only(knowledge) as journal:
        binding = journal.binding
    assert newest_compatible_run(runs / "nowhere", binding, knowledge).runs == ()
    assert newest_compatible_run(runs, replace(binding, feature_hash="another"), knowledge).runs == ()
    stood = record_story("walls", runs, seconds=1, other=untaught).rename(runs / "20260321T094640Z-wall_following")
    truncated = runs / "20260322T114640Z-torn"
    truncated.mkdir()
    (truncated / "0001.mcap").write_bytes(b"nonsense")

    found = newest_compatible_run(runs, binding, knowledge)
    assert [run.name for run in found.runs] == [str(stood)]
    (note,) = found.notes
    assert truncated.name in note
    shown = preview_on_newest(plan_undo(knowledge, teacher="Ann"), runs, quietly)
    assert [tried.run for tried in shown.runs] == [str(stood)]
    assert shown.notes == (note,)


def test_a_run_of_another_kurt2rt_stands_in_no_undos_way(knowledge: Path, runs: Path) -> None:
    (own,) = runs.iterdir()
    newer = Path(shutil.copytree(own, runs / "20260321T094640Z-wall_following"))
    (segment,) = newer.iterdir()
    segment.write_bytes(segment.read_bytes().replace(b"settings/situations/basic", b"settings/situations/later"))
    planned = plan_undo(knowledge, teacher="Ann")
    for shown in (preview_on_newest(planned, runs, quietly), preview(planned, runs, quietly)):
        assert [tried.run for tried in shown.runs] == [str(own)]
        (note,) = shown.notes
        assert note.startswith(f"{newer}: ")
        assert "basic" in note


def test_preview_of_a_long_run_tries_its_end_of_a_very_long_none(knowledge: Path, recordings: Path) -> None:
    planned = plan_undo(knowledge, taught_by="scripted teacher", teacher="Ann")
    (whole,) = preview(planned, recordings, quietly).runs
    (end,) = preview_on_newest(planned, recordings, quietly, last_s=1.0).runs
    assert end.from_s == pytest.approx(3.99)
    assert end.found.ticks == 101
    assert 0 < end.found.would_ask < whole.found.would_ask
    assert all(each.from_s >= end.from_s for each in end.found.stretches)

    very_long = preview_on_newest(planned, recordings, quietly, longest_s=4.0)
    assert very_long.runs == ()
    (note,) = very_long.notes
    assert "--runs" in note


class Lossy(SegmentReader):
    """Reads a file in which these messages, counted from 1 in each topic, are missing."""

    def __init__(self, path: Path, lost: range) -> None:
        super().__init__(path)
        self._lost = lost

    def records(self) -> Iterator[McapRecord]:
        seen = Counter[int]()
        for record in super().records():
            if isinstance(record, Message):
                seen[record.channel_id] += 1
                if seen[record.channel_id] in self._lost:
                    continue
            yield record


def read_anew(run: Path, reader: Callable[[Path], SegmentReader]) -> None:
    """Put in the place of a run that is one file what a reader reads of it."""
    (segment,) = run.iterdir()
    whole = segment.rename(run / "whole")
    with segment.open("xb") as file:
        copy_records(reader(whole), file)
    whole.unlink()


def test_preview_of_a_run_with_a_gap_tries_the_part_before_it(knowledge: Path, runs: Path) -> None:
    planned = plan_undo(knowledge, taught_by="scripted teacher", teacher="Ann")
    (whole,) = preview(planned, runs, quietly).runs
    (run,) = runs.iterdir()
    read_anew(run, lambda path: Lossy(path, range(401, 451)))
    shown = preview_on_newest(planned, runs, quietly, last_s=0.75)
    (tried,) = shown.runs
    assert tried.from_s == pytest.approx(3.24)
    assert tried.found.ticks == 76
    assert 0 < tried.found.would_ask < whole.found.would_ask
    assert all(tried.from_s <= each.from_s <= each.to_s < 4.0 for each in tried.found.stretches)
    (note,) = shown.notes
    assert note.startswith(f"{run}: 50 ticks ")
    assert " 4.50 s " in note

    (short,) = preview_on_newest(planned, runs, quietly, last_s=4.5).runs
    assert (short.from_s, short.found.ticks) == (0.0, 400)


def test_a_run_that_cannot_be_read_is_left_out_and_told(knowledge: Path, recordings: Path, tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    shutil.copytree(recordings, folder)
    (folder / "20260320T114640Z-torn").mkdir()
    (folder / "20260320T114640Z-torn" / "0001.mcap").write_bytes(b"nonsense")
    with Journal.read_only(knowledge) as journal:
        found = compatible_runs(folder, journal.binding)
    assert len(found.runs) == 1
    (note,) = found.notes
    assert "20260320T114640Z-torn" in note


@pytest.fixture
def kurt2rt(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path) -> CommandLine:
    """Return the command line, in a temporary folder."""
    monkeypatch.chdir(tmp_path)
    return CommandLine(monkeypatch, capfd)


def test_an_undo_is_tried_on_the_runs_that_are_named(kurt2rt: CommandLine, knowledge: Path, recordings: Path) -> None:
    said = kurt2rt(
        "knowledge", "undo", knowledge, "--teacher", "scripted teacher", "--dry-run", "--runs", recordings
    ).out
    assert re.search(r"20260320T094640Z-wall_following: .*\b490\b.*\b490\b.* ask", said)
    assert " s  asks, instead" in said
    said = kurt2rt("knowledge", "undo", knowledge, "--lesson", "far-1", "--dry-run", "--runs", recordings).out
    assert "not one" in said
    assert "nowhere: " in kurt2rt.refused("knowledge", "undo", knowledge, "--runs", "nowhere")
    assert folded(knowledge).history.last_standing == "far-2"


class Typed(io.StringIO):
    """Standard input that a user types at a terminal."""

    def isatty(self) -> bool:
        return True


def test_at_a_terminal_an_undo_asks_first(kurt2rt: CommandLine, knowledge: Path) -> None:
    for answer in ("n\n", "\n"):
        refused = kurt2rt("knowledge", "undo", knowledge, typed=Typed(answer))
        assert refused.exit_code == 1
        assert "far-2" in refused.err
        assert "[y/N]" in refused.err
        assert folded(knowledge).history.last_standing == "far-2"
    agreed = kurt2rt("knowledge", "undo", knowledge, "--teacher", "Ann", typed=Typed("y\n"))
    assert " 2 " in agreed.err
    assert "[y/N]" in agreed.err
    assert "2 lessons of Ann" in agreed.out
    agreed = kurt2rt("knowledge", "redo", knowledge, typed=Typed("y\n"))
    assert "far-1" in agreed.err
    assert "[y/N]" in agreed.err
    for quick in ("--yes", "--no-preview"):
        assert kurt2rt("knowledge", "redo", knowledge, quick, typed=Typed()).err == ""
        kurt2rt("knowledge", "undo", knowledge, quick, typed=Typed())


def test_declined_undo_leaves_no_files_next_to_the_knowledge(kurt2rt: CommandLine, knowledge: Path) -> None:
    given = Path("given") / "mine.knowledge"  # from elsewhere: no robot has run on it here
    given.parent.mkdir()
    shutil.copy(knowledge, given)
    before = given.read_bytes()
    assert kurt2rt("knowledge", "undo", given, typed=Typed("n\n")).exit_code == 1
    assert list(given.parent.iterdir()) == [given]
    assert given.read_bytes() == before


def test_undo_in_unwritable_folder_is_refused_before_the_preview(
    kurt2rt: CommandLine, knowledge: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = Path("given") / "mine.knowledge"
    given.parent.mkdir()
    shutil.copy(knowledge, given)
    monkeypatch.setattr(os, "access", lambda path, _: Path(path) != given.parent.resolve())  # root may write anywhere
    assert f"{given.resolve()}: " in kurt2rt.refused("knowledge", "undo", given)
