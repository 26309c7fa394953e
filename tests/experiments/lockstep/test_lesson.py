import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import Phase
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt
from kurt2rt.knowledge.journal.fold import check_knowledge, fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import read_lessons
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.experiments.helpers import ROBOT, Taught, short_task, teach


def test_a_robot_that_knows_nothing_asks_is_taught_and_drives(taught: Taught) -> None:
    result = taught.result
    assert result.growth[0] == 0  # the teacher thinks for a second
    assert result.counts.asks >= 2
    assert list(result.growth) == sorted(result.growth)
    assert len(result.growth) == 15
    assert result.growth[-1] == len(result.rlas) > 3
    first, last = result.trail[0], result.trail[-1]
    assert abs(last.x_m - first.x_m) + abs(last.y_m - first.y_m) > 0.5
    assert len(result.trail) == 75
    assert len(result.ask_positions) == result.counts.asks
    assert (result.counts.seed, result.counts.world, result.counts.teaching_s, result.counts.rescues) == (
        1,
        "a",
        15.0,
        0,
    )
    assert taught.reported_s == [*map(float, range(1, 16)), 15.0]


def test_training_result_equals_the_knowledge_file(taught: Taught) -> None:
    result = taught.result
    with Journal.read_only(taught.knowledge) as journal:
        assert check_knowledge(journal) == []
        system = fold_journal(journal, taught.task.learning.radius)
        assert journal.events() == taught.events
        statistics = journal.statistics()
    assert system.rlas == result.rlas
    assert system.knowledge_hash() == result.counts.knowledge_hash
    assert statistics.uses == result.saved.uses
    assert statistics.transitions == result.saved.transitions
    assert read_lessons(taught.knowledge, ROBOT, taught.task) == taught.events


def test_teacher_corrects_from_phase_2_on(taught: Taught) -> None:
    origins = [event.origin for event in taught.events]
    assert [each.phase for each in origins] == sorted(each.phase for each in origins)
    assert all((each.phase is Phase.SUPERVISED) is (each.tick <= 900) for each in origins)
    assert {each.phase for each in origins} == {Phase.SUPERVISED, Phase.CORRECTIONS}
    answers = sum(each.phase is Phase.SUPERVISED for each in origins)
    assert answers + taught.result.counts.corrections >= len(origins)


def test_same_seed_gives_the_same_knowledge_and_trail(taught: Taught, tmp_path: Path) -> None:
    again = teach(tmp_path / "again")
    assert again.result == taught.result
    assert again.result.saved.uses == taught.result.saved.uses
    assert again.events == taught.events


def test_a_lesson_goes_on_from_what_the_file_holds(tmp_path: Path) -> None:
    task = short_task(2.5, 1.5)
    first = teach(tmp_path / "knowledge", task)
    second = teach(tmp_path / "knowledge", task, seed=2)
    again = teach(tmp_path / "knowledge", task)

    assert second.events[: len(first.events)] == first.events
    assert again.events[: len(second.events)] == second.events
    assert len(second.events) > len(first.events)
    assert second.result.growth[0] == len(first.result.rlas)
    command_ids = [event.origin.command_id for event in again.events]
    assert len(set(command_ids)) == len(command_ids)
    created = [event.rla.rla_id for event in again.events if isinstance(event, RlaCreated)]
    assert created == list(range(1, len(created) + 1))
    # Counts too: each lesson adds to what was counted before it.
    with Journal.read_only(tmp_path / "knowledge") as journal:
        assert journal.statistics().uses == again.result.saved.uses
    for before, after in ((first, second), (second, again)):
        uses = after.result.saved.uses
        assert all(uses[rla_id] >= count for rla_id, count in before.result.saved.uses.items())
        assert sum(uses.values()) > sum(before.result.saved.uses.values())


def test_a_robot_that_makes_no_way_is_set_down_elsewhere(tmp_path: Path) -> None:
    task = short_task(3.0, 0.0)
    impatient = task.teaching.model_copy(update={"rescue_after_s": 1.0})
    rescued = teach(tmp_path / "knowledge", task.model_copy(update={"teaching": impatient})).result
    assert rescued.counts.rescues > 0


def test_lessons_that_cannot_be_saved_are_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def on_a_dead_disk(self: Journal, entries: object) -> object:  # noqa: ARG001
        raise KnowledgeError(KnowledgeCode.DISK_FULL, where=self.path, error="")

    def without_patience(self: JournalWriter, timeout_s: float) -> bool:  # noqa: ARG001
        return flush(self, 0.05)

    flush = JournalWriter.flush
    monkeypatch.setattr(JournalWriter, "flush", without_patience)
    monkeypatch.setattr(Journal, "append", on_a_dead_disk)
    with pytest.raises((LessonLostError, KnowledgeError), match=re.escape(KnowledgeCode.DISK_FULL.text)):
        teach(tmp_path / "knowledge", short_task(2.0, 0.0))


def test_a_lesson_that_the_journal_refuses_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(self: Journal, entries: Sequence[JournalEntry]) -> list[Receipt]:  # noqa: ARG001
        return [Receipt(each.event.origin.command_id, 7, each.stamped_at, new=False, agrees=False) for each in entries]

    monkeypatch.setattr(Journal, "append", refuse)
    with pytest.raises(LessonLostError, match=r"knowledge: .*'lesson-1-after-0-1'"):
        teach(tmp_path / "knowledge", short_task(2.0, 0.0))
