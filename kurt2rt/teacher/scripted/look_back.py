"""Correction by rewind: a person stops the robot, looks back for the moment that went wrong, and names the action."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from kurt2rt.core.rla.rla import SCRIPTED
from kurt2rt.core.teaching.commands import Command, Correct, Resume, Stop
from kurt2rt.teacher.scripted.basic_teacher import TeacherView
from kurt2rt.teacher.scripted.human_limits import DelaySampler

_LOOKS_AGAIN_S = 1.0
"""A robot that does not drive so long after a resume gets another one."""


_Step = Literal["stop", "stopped", "looks", "taught", "resumed"]


@dataclass(frozen=True, slots=True)
class Mistake:
    """Moment that a teacher believes to have gone wrong, and the action that it names for it."""

    tick: int
    """Tick in which the teacher believes that it began."""
    action: str
    """Action that the teacher names."""
    is_slip: bool = False
    """True if the finger slips: it is not the action that the teacher means."""


class LookBack:
    """Presses of one look back, in their order: stop, the right action at the mistake's tick, and resume.

    After it the page lets the robot drive on, as after the answer to a question.
    """

    def __init__(self, mistake: Mistake, takes: DelaySampler, period_s: float) -> None:
        """Plan the presses.

        Args:
            mistake: the one that is corrected.
            takes: draws the time to find its moment.
            period_s: length of a tick.
        """
        self._mistake = mistake
        self._takes = takes
        self._looks_again_ticks = round(_LOOKS_AGAIN_S / period_s)
        self._step: _Step = "stop"
        self._due = 0
        self.slip: str | None = None
        """Command id of the lesson, if a slip of the finger gave it."""
        self.over = False
        """True once the robot was seen to drive or to ask after the resume."""

    def update(self, now: int, picture: TeacherView, next_id: Callable[[], str]) -> Command | None:
        """Process the state that the teacher sees in tick `now`; return the press that is due, if any."""
        moves = picture.driving or picture.asking
        if self._step == "resumed" and moves:
            self.over = True
        elif self._step == "stopped" and not moves:
            self._step, self._due = "looks", now + self._takes.draw(now)
        if self._step == "stop":
            self._step = "stopped"
            return Stop(next_id(), SCRIPTED)
        if now < self._due or self.over:
            return None
        if self._step == "looks":
            mistake, lesson = self._mistake, next_id()
            self._step, self._due = "taught", now
            if mistake.is_slip:
                self.slip = lesson
            return Correct(lesson, SCRIPTED, mistake.action, decision_tick=mistake.tick)
        if self._step in ("taught", "resumed"):
            self._step, self._due = "resumed", now + self._looks_again_ticks
            return Resume(next_id(), SCRIPTED, seen_tick=picture.tick)
        return None
