"""A simulated robot is taught, and its decisions are looked into."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import Phase
from kurt2rt.runs.explain.picture import draw_why
from kurt2rt.runs.explain.reasons import headline
from tests.runs.explain.helpers import ROBOT, Lesson
from tests.teacher.helpers import correct, set_phase, stop, teach

PNG = b"\x89PNG"
FORWARD = 100
"""Ticks."""


@pytest.fixture
def lesson() -> Iterator[Lesson]:
    lesson = Lesson(seed=7)
    yield lesson
    lesson.close()


def give(lesson: Lesson) -> Lesson:
    """Teach forward, and a bow to the right where a wall comes near; return the lesson."""
    lesson.go_on(20)
    lesson.go_on(FORWARD, teach("forward"))
    lesson.go_on(1, set_phase(Phase.CORRECTIONS))
    lesson.go_on(20, correct("bear_right"))
    return lesson


@pytest.fixture(scope="module")
def taught_lesson() -> Iterator[Lesson]:
    """One that was given; to be looked at."""
    lesson = Lesson(seed=7)
    yield give(lesson)
    lesson.close()


def test_why_before_the_first_lesson_has_no_counterfactuals(lesson: Lesson, tmp_path: Path) -> None:
    lesson.go_on(20)
    facts = lesson.facts
    assert (facts.cause, facts.basic.nearest, facts.basic.count) == (DecisionCause.UNKNOWN, None, 0)
    assert lesson.counterfactuals == ()
    draw_why(facts, (), ROBOT, "nothing yet", tmp_path / "why.png")
    assert (tmp_path / "why.png").read_bytes().startswith(PNG)


def test_the_facts_are_those_of_the_decision(taught_lesson: Lesson) -> None:
    record, facts = taught_lesson.records[-1], taught_lesson.facts
    match = record.decision.match
    assert match is not None
    nearest = facts.basic.nearest
    assert nearest is not None
    assert (nearest.rla_id, nearest.distance, nearest.radius) == (match.rla.rla_id, match.distance, match.radius)
    runner_up = facts.basic.runner_up
    assert runner_up is not None
    assert match.runner_up is not None
    assert runner_up.rla_id == match.runner_up.rla_id
    assert runner_up.distance == pytest.approx(match.runner_up_distance, rel=1e-4)
    assert facts.basic.vector == tuple(record.situation.vector)
    assert headline(facts) == record.decision.action


def test_counterfactuals_are_empty_for_a_stop(lesson: Lesson) -> None:
    give(lesson).go_on(2, stop())
    assert lesson.facts.stopped
    assert lesson.counterfactuals == ()


def test_lessons_that_cannot_be_saved_are_among_the_facts(lesson: Lesson) -> None:
    give(lesson).notebook.saving_error = "ENOSPC"
    lesson.go_on(1)
    assert (lesson.facts.cause, lesson.facts.trouble) == (DecisionCause.UNSAVED, "ENOSPC")


@pytest.mark.parametrize("ending", [pytest.param("png", marks=pytest.mark.deep), "svg"])
def test_picture_of_a_decision_is_identical_each_time(taught_lesson: Lesson, tmp_path: Path, ending: str) -> None:
    facts, sensor_counterfactuals = taught_lesson.facts, taught_lesson.counterfactuals
    for name in ("one", "two"):
        draw_why(facts, sensor_counterfactuals, ROBOT, "a title", tmp_path / f"{name}.{ending}")
    drawn = (tmp_path / f"one.{ending}").read_bytes()
    assert drawn == (tmp_path / f"two.{ending}").read_bytes()
    if ending == "svg":
        for words in ("a title", "Now: tick 141", "As taught: RLA 2 (bear_right)", "to RLA 2", "RLA 1 (forward)"):
            assert words.encode() in drawn
