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

_COUNTED: dict[type[Command], str] = {
    Teach: "lessons",
    Correct: "corrections",
    ReplaceAction: "corrections",
    DeleteRla: "corrections",
    Reward: "rewards",
    Appraise: "appraisals",
    Stop: "stops",
    Undo: "undone",
}


class TeacherWorkload:
    """Count of a teacher's teaching commands and manual acts, such as rescues, in each minute of a run."""

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
        if isinstance(command, HoldAction):
            if command.press_id != self._held_press:
                self._held_press = command.press_id
                self._add(tick, "corrections")
        elif type(command) in _COUNTED and not (isinstance(command, Stop) and command.press_id is not None):
            self._add(tick, _COUNTED[type(command)])

    def count_manual(self, tick: int, what: Hands) -> None:
        """Count a manual act of a kind, such as a rescue, in the minute of `tick`."""
        self._add(tick, what)

    def _add(self, tick: int, what: str) -> None:
        place = min((tick - 1) // self._ticks_per_minute, len(self._minutes) - 1)
        before = self._minutes[place]
        minute = self._minutes[place] = before._replace(**{what: getattr(before, what) + 1})
        self.press_ticks.extend([tick] * (minute.presses - before.presses))
