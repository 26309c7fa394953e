"""Checkpoints of a lesson: the knowledge after some of its presses, and exams with it."""

from collections.abc import Awaitable, Callable, Sequence

from config.settings import Settings
from kurt2rt.core.learner.learner import Label
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.lesson import GivenLesson

Examine = Callable[[Sequence[TeachingEvent], Sequence[Label]], Awaitable[tuple[DriveRow, ...]]]
"""Examines the knowledge of RLAs and, if learners were taught in their place, of learners."""


class Checkpoint(Settings):
    """Knowledge after a number of presses, and its exams."""

    presses: int
    """Presses asked for; a robot that gave cause for fewer has all that it was taught."""
    teaching_s: float
    """Time of teaching up to the first press that does not count, or to the end."""
    lessons: int
    """Teaching events of the lesson so far, undos included."""
    drives: tuple[DriveRow, ...]
    """Exams in each world in order, up to the first that failed."""

    @property
    def judged(self) -> bool:
        """True if a drive has a verdict."""
        return any(drive.judged for drive in self.drives)

    @property
    def passed(self) -> bool:
        """True if all drives with a verdict passed, and there is one."""
        return self.judged and all(drive.passed for drive in self.drives if drive.judged)


async def run_checkpoints(
    given: GivenLesson, after: Sequence[int], period_s: float, examine: Examine, *, known: int = 0
) -> list[Checkpoint]:
    """Examine the knowledge after each of these numbers of presses; equal knowledge is examined once.

    Args:
        given: lesson with all events that its file then holds.
        after: numbers of presses, ascending.
        period_s: of a tick, in s.
        examine: gives the exams.
        known: number of events before the lesson.
    """
    lesson, events = given
    checkpoints: list[Checkpoint] = []
    before: tuple[int, ...] = ()
    ticks = lesson.press_ticks
    for presses in after:
        lessons = events_before_press(events[known:], ticks, presses)
        labels = lesson.labels[min(presses, len(lesson.labels) - 1)] if lesson.labels else ()
        now = (lessons, *map(id, labels))
        drives = checkpoints[-1].drives if now == before else await examine(events[: known + lessons], labels)
        taught_s = ticks[presses] * period_s if presses < len(ticks) else lesson.teaching_s
        checkpoints.append(Checkpoint(presses=presses, teaching_s=taught_s, lessons=lessons, drives=drives))
        before = now
    return checkpoints


def events_before_press(events: Sequence[TeachingEvent], press_ticks: Sequence[int], presses: int) -> int:
    """Return how many events of a lesson were applied before the press that follows `presses` others.

    A hold teaches until its release, and so all lessons of a press come before the next press.

    Args:
        events: of the lesson alone, in order.
        press_ticks: tick in which each press of the lesson was sent; the robot applies it in a later tick.
        presses: number of presses that count.
    """
    if presses >= len(press_ticks):
        return len(events)
    return sum(event.origin.tick <= press_ticks[presses] for event in events)
