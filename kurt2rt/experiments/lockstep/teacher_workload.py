"""Workload of a teacher: commands and manual acts in each minute."""

from typing import Literal, NamedTuple

from kurt2rt.core.teaching.commands import (
    Appraise,
    Command,
    Correct,
    DeleteRla,
    HoldAction,
    ReplaceAction,
    Reward,
    Stop,
    Teach,
    Undo,
)


class WorkloadMinute(NamedTuple):
    """Commands and manual acts of a teacher in one minute of robot time."""

    lessons: int = 0
    """Answers to the robot's questions."""
    corrections: int = 0
    """Corrections by a press, and held actions, also those that answer a question."""
    rewards: int = 0
    """Rewards of +1 and -1."""
    appraisals: int = 0
    """Lessons for the critic."""
    set_down: int = 0
    """Planned repositionings by hand."""
    shown: int = 0
    """Actions demonstrated to the critic."""
    rescued: int = 0
    """Rescues of a stuck robot."""
    go: int = 0
    """Resume commands after a latched stop."""
    stops: int = 0
    """Stops to look back (rewind)."""
    undone: int = 0
    """Undos of own wrong presses."""

    @property
    def presses(self) -> int:
        """Number of presses: answers and corrections, with the stops, resumes and undos that they took."""
        return self.lessons + self.corrections + self.stops + self.go + self.undone


Hands = Literal["set_down", "shown", "rescued", "go"]
SAID = ("lessons", "corrections", "rewards", "appraisals")
"""Commands; the other fields are manual acts."""


class TeacherWorkload:
    """Counter of commands and manual acts, minute by minute."""

    def __init__(self, ticks: int, period_s: float) -> None:
        """Count for `ticks` ticks of `period_s`; the last minute may be shorter."""
        self._ticks_per_minute = round(60.0 / period_s)
        self._held_press = 0
        self.press_ticks: list[int] = []
        """Tick of each press, in order; one tick may have several."""
        self._minutes = [WorkloadMinute()] * max(1, -(-ticks // self._ticks_per_minute))

    @property
    def minutes(self) -> tuple[WorkloadMinute, ...]:
        """Minutes in their order; the last one may be shorter."""
        return tuple(self._minutes)

    def count(self, tick: int, command: Command) -> None:
        """Count a command; commands that do not teach are left out."""
        place = self._place(tick)
        now = self._minutes[place]
        match command:
            case Teach():
                now = now._replace(lessons=now.lessons + 1)
            case Correct() | ReplaceAction() | DeleteRla():
                now = now._replace(corrections=now.corrections + 1)
            case HoldAction(press_id=press_id) if press_id != self._held_press:
                self._held_press = press_id
                now = now._replace(corrections=now.corrections + 1)
            case Reward():
                now = now._replace(rewards=now.rewards + 1)
            case Stop(press_id=None):
                now = now._replace(stops=now.stops + 1)
            case Undo():
                now = now._replace(undone=now.undone + 1)
            case Appraise():
                now = now._replace(appraisals=now.appraisals + 1)
        self._set(place, now, tick)

    def count_manual(self, tick: int, what: Hands) -> None:
        """Count a manual act of a kind, such as a rescue, in the minute of `tick`."""
        place = self._place(tick)
        now = self._minutes[place]
        self._set(place, now._replace(**{what: getattr(now, what) + 1}), tick)

    def _set(self, place: int, minute: WorkloadMinute, tick: int) -> None:
        before = self._minutes[place]
        self.press_ticks.extend([tick] * (minute.presses - before.presses))
        self._minutes[place] = minute

    def _place(self, tick: int) -> int:
        return min((tick - 1) // self._ticks_per_minute, len(self._minutes) - 1)
