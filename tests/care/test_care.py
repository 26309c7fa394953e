"""Changes of knowledge are tried on a recorded run before anything is changed."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from hal.robot_settings import load_robot
from kurt2rt.care.compacting import TEACHER, Compaction, compact
from kurt2rt.care.preview import preview_undo
from kurt2rt.care.trial import Known, answers, runs_to_try
from kurt2rt.knowledge.entry import JournalEntry
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.fold import check_knowledge, fold_journal
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.opening import open_knowledge
from kurt2rt.knowledge.statistics import Statistics
from kurt2rt.knowledge.undo import undo_lessons_of
from kurt2rt.replay.reading import read_run
from kurt2rt.replay.replay import Replay
from kurt2rt.rla.rla import Origin, Phase, Rla, RlaCreated, RlaDeleted, TeachingEvent
from kurt2rt.rla.rla_system import RlaSystem
from kurt2rt.tasks.settings import load_task
from kurt2rt.tick import TickRecord
from tests.cli.helpers import CommandLine
from tests.replay.stories import Scene, record_story

STAMP = "2026-11-22T03:10:05.000+00:00"
FAR = (-5000.0,) * 72


def nobody(scene: Scene, record: TickRecord) -> None:
    """Says nothing to the robot."""


def quietly(run: str, ticks: int) -> None:
    """Nobody watches the progress."""


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with one run of ten seconds, in which a robot was taught to follow a wall."""
    folder = tmp_path_factory.mktemp("runs")
    record_story("walls", folder, seconds=10).rename(folder / "20260320T094640Z-wall_following")
    return folder


@pytest.fixture(scope="module")
def lessons(recordings: Path) -> list[TeachingEvent]:
    """What it knew at its end."""
    (path,) = recordings.iterdir()
    replay = Replay(read_run(path))
    for entry in replay.run.entries():
        replay.step(entry)
    return [record.event for record in replay.runtime.level.system.lessons if not record.undone]


def unneeded(lessons: list[TeachingEvent], number: int = 1) -> RlaCreated:
    """An RLA so far off that nothing ever came near it."""
    new_id = max(event.rla.rla_id for event in lessons if isinstance(event, RlaCreated)) + number
    return RlaCreated(Rla(new_id, FAR, "forward", None, Origin(f"far-{number}", "Ann", Phase.SUPERVISED, 1)))


@pytest.fixture
def knowledge(tmp_path: Path, lessons: list[TeachingEvent]) -> Path:
    """What was taught in the run, and two RLAs that nobody needs."""
    path = tmp_path / "walls.knowledge"
    with open_knowledge(path, load_robot(), load_task("wall_following")) as journal:
        far = unneeded(lessons), unneeded(lessons, 2)
        journal.append([JournalEntry(event, STAMP) for event in (*lessons, *far)])
    return path


def folded(path: Path) -> RlaSystem:
    with Journal.read_only(path) as journal:
        assert check_knowledge(journal) == []
        return fold_journal(journal, radius=1.0)


def compacted(path: Path, recordings: Path, *, dry_run: bool = False) -> Compaction:
    return compact(path, recordings, stamp=STAMP, dry_run=dry_run, report=quietly)


def test_what_no_decision_needs_is_deleted_and_every_decision_comes_out_the_same(
    knowledge: Path, recordings: Path
) -> None:
    before = folded(knowledge)
    done = compacted(knowledge, recordings, dry_run=True)
    assert folded(knowledge).rlas == before.rlas

    assert compacted(knowledge, recordings) == done
    after = folded(knowledge)
    assert {"far-1", "far-2"} <= {rla.origin.command_id for rla in done.deleted}
    assert len(after) == done.kept == len(before) - len(done.deleted)
    assert done.kept > 0
    assert (done.runs, done.ticks, done.notes, done.other_behaviours) == (1, 1000, (), ())
    assert 100 < done.driven_ticks < done.ticks

    again = compacted(knowledge, recordings)
    assert (again.deleted, again.kept) == ((), done.kept)
    undo_lessons_of(knowledge, TEACHER, teacher="command line", stamp=STAMP)
    assert folded(knowledge).rlas == before.rlas


def test_each_rla_that_is_left_is_needed(knowledge: Path, recordings: Path) -> None:
    compacted(knowledge, recordings)
    with Journal.read_only(knowledge) as journal:
        known = Known(tuple(journal.events()), Statistics())
        (run,) = runs_to_try(recordings, journal.binding).runs
    nearest = {answered.basic.nearest for _, (answered,) in answers(run, (known,), quietly)}
    assert {rla.rla_id for rla in nearest if rla is not None} == {rla.rla_id for rla in folded(knowledge).rlas}


def test_a_robot_that_only_stood_proves_nothing(knowledge: Path, recordings: Path, tmp_path: Path) -> None:
    before = folded(knowledge)
    folder = tmp_path / "runs"
    stood = record_story("walls", folder, seconds=1, other=nobody)
    stood.rename(folder / "20260320T084640Z-wall_following")
    with pytest.raises(KnowledgeError, match=r"in none of its 1 runs .* anything drove \(0 s\).* nothing was deleted"):
        compacted(knowledge, folder)
    assert folded(knowledge).rlas == before.rlas

    shutil.copytree(recordings, folder, dirs_exist_ok=True)
    done = compacted(knowledge, folder, dry_run=True)
    assert done.runs == 1
    (note,) = done.notes
    assert note.endswith("20260320T084640Z-wall_following: nothing drove in it, so it proves nothing")


def test_a_robot_that_runs_and_a_folder_without_runs_change_nothing(
    knowledge: Path, recordings: Path, tmp_path: Path
) -> None:
    with Journal.read_only(knowledge) as look:
        binding = look.binding
    with Journal.open(knowledge, binding), pytest.raises(KnowledgeError, match="another kurt2rt is writing it"):
        compacted(knowledge, recordings)
    for folder in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(KnowledgeError, match="holds no recorded run"):
            compacted(knowledge, folder)
    other = replace(binding, feature_hash="another")
    with pytest.raises(KnowledgeError, match=r"none of its runs can be tried: .* other features"):
        runs_to_try(recordings, other)
    with Journal.read_only(knowledge) as journal:
        assert not any(isinstance(event, RlaDeleted) for event in journal.events())


def test_an_undo_is_tried_before_it_is_made(knowledge: Path, recordings: Path, lessons: list[TeachingEvent]) -> None:
    before = folded(knowledge)
    nothing = preview_undo(knowledge, "far-2", None, recordings, quietly)
    assert [record.text for record in nothing.lessons] == [f"RLA {before.rlas[-1].rla_id} taught: forward"]
    (tried,) = nothing.runs
    assert tried.found.same
    assert nothing.notes == ()

    first = next(event for event in lessons if isinstance(event, RlaCreated))
    all_of_one = preview_undo(knowledge, None, first.origin.teacher, recordings, quietly)
    (tried,) = all_of_one.runs
    assert len(all_of_one.lessons) == len(lessons)
    # nothing would be left but what is far off
    assert (tried.found.other_action, tried.found.would_drive) == (0, 0)
    assert 0 < tried.found.would_ask <= tried.found.decided
    assert any(each.was.rla == folded(knowledge).get(first.rla.rla_id) for each in tried.found.stretches)
    assert folded(knowledge).rlas == before.rlas
    with pytest.raises(KnowledgeError, match="there is no lesson 'far-9'"):
        preview_undo(knowledge, "far-9", None, recordings, quietly)


def test_a_run_that_cannot_be_read_is_left_out_and_told(knowledge: Path, recordings: Path, tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    shutil.copytree(recordings, folder)
    (folder / "20260320T114640Z-torn").mkdir()
    (folder / "20260320T114640Z-torn" / "0001.mcap").write_bytes(b"nonsense")
    with Journal.read_only(knowledge) as journal:
        found = runs_to_try(folder, journal.binding)
    assert len(found.runs) == 1
    (note,) = found.notes
    assert "20260320T114640Z-torn" in note


def test_on_the_command_line(
    knowledge: Path, recordings: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    kurt2rt = CommandLine(monkeypatch, capfd)
    said = kurt2rt("knowledge", "undo", knowledge, "--of", "scripted teacher", "--preview", "--runs", recordings).out
    assert " s  asks, instead of " in said
    assert said.endswith("nothing was changed\n")
    said = kurt2rt("knowledge", "undo", knowledge, "--lesson", "far-1", "--preview", "--runs", recordings).out
    assert "20260320T094640Z-wall_following: not one of " in said
    dry = kurt2rt("knowledge", "compact", knowledge, "--runs", recordings, "--dry-run").out
    assert "would delete: RLA " in dry
    done = kurt2rt("knowledge", "compact", knowledge, "--runs", recordings).out
    assert re.search(r"tried on 1000 ticks \(10 s, [1-9] s of them driven\) of 1 runs", done)
    assert f"to take all of that back: kurt2rt knowledge undo {knowledge} --of compact" in done
    assert "holds no recorded run" in kurt2rt.refused("knowledge", "compact", knowledge, "--runs", "nowhere")
