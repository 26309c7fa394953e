"""How much a teacher has to do: what he says, and does with his hands, in each minute of teaching."""

from typing import Literal, NamedTuple

from kurt2rt.core.teaching.commands import Appraise, Command, Correct, DeleteRla, ReplaceAction, Reward, Teach


class WorkloadMinute(NamedTuple):
    """What a teacher said and did in one minute of robot time, also where it changed nothing."""

    lessons: int = 0
    """Answers to the robot's questions."""
    corrections: int = 0
    rewards: int = 0
    """Praise and blame."""
    appraisals: int = 0
    """Lessons for the critic."""
    set_down: int = 0
    """The robot was carried elsewhere, as planned."""
    shown: int = 0
    """An action was shown to the critic."""
    rescued: int = 0
    """The robot was carried elsewhere because it made no way."""
    go: int = 0
    """The robot was told to drive again after the guard had stopped it."""


Hands = Literal["set_down", "shown", "rescued", "go"]
SAID = ("lessons", "corrections", "rewards", "appraisals")
"""What is said; the rest is done."""


class TeacherWorkload:
    """Counts what a teacher says, minute by minute."""

    def __init__(self, ticks: int, period_s: float) -> None:
        """Of a lesson of so many ticks; a minute that is begun counts."""
        self._ticks_per_minute = round(60.0 / period_s)
        self._minutes = [WorkloadMinute()] * max(1, -(-ticks // self._ticks_per_minute))

    @property
    def minutes(self) -> tuple[WorkloadMinute, ...]:
        """One after the other; the last one may be shorter."""
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
            case Reward():
                now = now._replace(rewards=now.rewards + 1)
            case Appraise():
                now = now._replace(appraisals=now.appraisals + 1)
        self._minutes[place] = now

    def count_manual(self, tick: int, what: Hands) -> None:
        """Count a manual act."""
        place = self._place(tick)
        now = self._minutes[place]
        self._minutes[place] = now._replace(**{what: getattr(now, what) + 1})

    def _place(self, tick: int) -> int:
        return min((tick - 1) // self._ticks_per_minute, len(self._minutes) - 1)
