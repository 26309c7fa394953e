"""Texts that stay long enough to be read: while the robot drives, and while noise lets it drive during a question."""

from collections.abc import Iterator

import pytest

from kurt2rt.core.decision.standing import Standing, StandReason
from tests.teacher.page.lesson import Lesson

ASKS = Standing(StandReason.ASKS, asks=True)
_HOLD_CLOCK = "window.heldMs = performance.now() + 5000; performance.now = () => window.heldMs;"
_LATER = "window.heldMs += arguments[0];"
_FREE_CLOCK = "delete performance.now;"


@pytest.fixture
def lesson(a_lesson: Lesson) -> Iterator[Lesson]:
    """Return a lesson on a page whose clock only the test advances."""
    a_lesson.begin(standing=Standing())
    a_lesson.phone.run(_HOLD_CLOCK)
    yield a_lesson
    a_lesson.phone.run(_FREE_CLOCK)


def show(lesson: Lesson, second: int, **changes: object) -> str:
    """Show a state and wait until the page has it; return the sentence."""
    lesson.show(clock_s=3600.0 + second, **changes)
    lesson.reads("#clock", f"60:{second:02}")
    return lesson.phone.text("#sentence")


def test_sentence_of_a_driving_robot_changes_once_a_second(lesson: Lesson) -> None:
    assert show(lesson, 1, rla=2).startswith("RLA 2 ")
    lesson.phone.run(_LATER, 999)
    assert show(lesson, 2, rla=3, distance=500.0).startswith("RLA 2 ")
    lesson.phone.run(_LATER, 1)
    assert show(lesson, 3).startswith("RLA 3 ")


def test_open_question_keeps_its_words_while_noise_lets_it_drive(lesson: Lesson) -> None:
    assert show(lesson, 1, rla=2).startswith("RLA 2 ")
    asks = {"cause": "unknown", "action": None, "rla": None, "standing": ASKS, "distance": 710.0}
    question = "I don't know this situation, teach me"
    assert show(lesson, 2, **asks) == question  # at once
    lesson.phone.run(_LATER, 1000)
    assert show(lesson, 3, cause="rla", action="forward", rla=1, distance=690.0) == question
    assert lesson.phone.text("#gauge-text") == "710 of R 700"
    answered = {"cause": "rla", "action": "forward", "rla": 2, "distance": 0.0, "standing": Standing(), "lessons": 2}
    assert show(lesson, 4, **answered).startswith("RLA 2 ")  # at once
