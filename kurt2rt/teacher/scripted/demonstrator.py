"""Demonstration by a scripted person: they drive by hand, look at the segments, and have them taught."""

from collections.abc import Callable, Mapping
from typing import Literal

from hal.robot import WheelSpeeds
from kurt2rt.core.rla.programs import SCRIPTED
from kurt2rt.core.teaching.commands import Command, Drive, Stop, TeachShown
from kurt2rt.teacher.scripted.basic_teacher import TeacherView
from kurt2rt.teacher.scripted.hand import Hand
from kurt2rt.teacher.scripted.human_limits import DelaySampler

_STANDSTILL = WheelSpeeds(0.0, 0.0)

_Step = Literal["drives", "let go", "looks"]


class Demonstrator:
    """The presses of one demonstration: a drive by hand, and the confirmation of its segments.

    The person confirms all segments. What the hand did too late is taught, too.
    """

    def __init__(self, hand: Hand, speeds: Mapping[str, WheelSpeeds], takes: DelaySampler) -> None:
        """Plan the presses.

        Args:
            hand: that drives until its release.
            speeds: wheel speeds of each action that the hand can drive; the robot stands for others.
            takes: draws the time to look over the segments.
        """
        self._hand = hand
        self._speeds = speeds
        self._takes = takes
        self._step: _Step = "drives"
        self._due = 0
        self.over = False
        """True once the segments were confirmed, or there were none."""

    def update(self, now: int, picture: TeacherView, right: str, next_id: Callable[[], str]) -> Command | None:
        """Take a picture in tick `now`; return the command that is due, None without one.

        Args:
            now: tick of the person's own clock.
            picture: newest state.
            right: action that is right in it.
            next_id: gives the id of a command.
        """
        if self._step == "drives":
            return self._drive(now, picture, right, next_id)
        if self._step == "let go" and not picture.driving:
            self._step, self._due = "looks", now + self._takes.draw(now)
        if self._step != "looks" or now < self._due:
            return None
        self.over = True
        if not picture.segments:
            return None
        return TeachShown(next_id(), SCRIPTED, self._hand.press_id, tuple(range(picture.segments)))

    def _drive(self, now: int, picture: TeacherView, right: str, next_id: Callable[[], str]) -> Command:
        hand = self._hand
        if now >= hand.ends:
            self._step = "let go"
            return Stop(next_id(), SCRIPTED, hand.press_id)
        hand.follow(now, right)
        hand.move(now)
        return Drive(SCRIPTED, picture.tick, hand.press_id, *self._speeds.get(hand.action, _STANDSTILL))
