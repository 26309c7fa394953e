"""Lessons that are measured are lessons: in the journal when the run is over."""

from dataclasses import replace
from itertools import count
from pathlib import Path

import pytest

from kurt2rt.checks.bench.lesson import _LessonTimer, measure_lessons
from kurt2rt.checks.bench.robot_under_test import BenchFixture
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.knowledge.refusals import refused


async def test_every_lesson_that_was_timed_is_in_the_file(subject: BenchFixture, tmp_path: Path) -> None:
    told: list[float] = []
    result = await measure_lessons(subject, tmp_path, 4, told.append)
    assert told == [0.25, 0.5, 0.75, 1.0]
    with open_knowledge(tmp_path / "lesson.knowledge", subject.settings, subject.task) as journal:
        taught = journal.events()[len(subject.events) :]
    assert len(taught) == 4
    assert all(event.origin.command_id.startswith("bench-lesson-") for event in taught)
    assert 0.0 < result.took.median_us <= result.took.p99_us <= result.took.worst_us
    assert result.reference is not None
    assert result.reference.took_us > 0.0
    assert [str(goal) for goal in result.goals] == ["p99 us <= 20000"]


async def test_an_answer_that_is_no_lesson_is_followed_by_another(
    subject: BenchFixture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    after_tick, answers = _LessonTimer.after_tick, count()

    def after_tick_known(timer: _LessonTimer, record: TickRecord) -> None:
        if record.results and next(answers) % 2:
            record = record._replace(results=tuple(replace(each, lesson=False) for each in record.results))
        after_tick(timer, record)

    monkeypatch.setattr(_LessonTimer, "after_tick", after_tick_known)
    result = await measure_lessons(subject, tmp_path, 3, lambda _: None)
    assert result.note.startswith("3 lessons")
    assert next(answers) == 5


@pytest.mark.deep  # closing a writer whose disk fails takes its patience of 10 s
async def test_a_disk_that_fails_ends_the_run_and_says_why(subject: BenchFixture, tmp_path: Path) -> None:
    path = tmp_path / "lesson.knowledge"

    def take_the_file_away(_: float) -> None:
        path.unlink()

    moved = KnowledgeError(KnowledgeCode.MOVED_IN_USE, where=path)
    with refused(KnowledgeCode.LESSONS_NOT_WRITTEN, reason=str(moved), count=1):
        await measure_lessons(subject, tmp_path, 3, take_the_file_away, patience_s=0.5)
