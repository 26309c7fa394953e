"""Commands about places and goals: naming situations, setting the location, seeking goals."""

from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.planning.navigator import Navigator
from kurt2rt.core.rla.events import SituationNamed, TeachingEvent
from kurt2rt.core.rla.rla import MID, Origin
from kurt2rt.core.teaching.commands import BeAt, NameSituation, Seek, StopSeeking
from kurt2rt.core.teaching.mid_lessons import MidLessons

LONGEST_NAME = 64


class GoalCommands:
    """Part of the command handler for goals: names situations, and gives goals to the navigator."""

    def __init__(self, navigator: Navigator, lessons: MidLessons) -> None:
        self._navigator = navigator
        self._lessons = lessons
        self._seen_tick = -1
        """Tick that the teacher had seen at the last goal command."""
        self._planned_tick = -1

    def name_situation(self, command: NameSituation, origin: Origin) -> tuple[Outcome, TeachingEvent]:
        """Return the outcome and the event that gives a mid-level situation a name.

        Raises CommandRefusedError for a bad name, a forgotten tick, and if the robot did not know its place.
        """
        name = command.name
        if not 0 < len(name) <= LONGEST_NAME or not name.isprintable() or name != name.strip():
            raise CommandRefusedError(RefusalCode.BAD_NAME, name=name, longest=LONGEST_NAME)
        situation = tuple(self._lessons.context_of(command.decision_tick).vector.tolist())
        return Outcome.of(ResultCode.SITUATION_NAMED, name=name), SituationNamed(name, situation, MID, origin)

    def carry_out(self, command: Seek | StopSeeking | BeAt, tick: int) -> Outcome:
        """Carry out a command in this tick and return the outcome.

        Raises CommandRefusedError for an unknown goal or place, and for a command that a later command or junction
        supersedes.
        """
        seen_tick = tick if command.seen_tick is None else command.seen_tick
        if isinstance(command, BeAt):
            return self._locate(command.name, seen_tick)
        if seen_tick < self._seen_tick:
            raise CommandRefusedError(RefusalCode.GOAL_SINCE)
        said = self._seek(command, tick)
        self._seen_tick = seen_tick
        return said

    def _seek(self, command: Seek | StopSeeking, tick: int) -> Outcome:
        if isinstance(command, StopSeeking):
            self._navigator.stop()
            return Outcome(ResultCode.GOAL_DROPPED)
        if tick == self._planned_tick:  # a plan takes a good part of a tick
            raise CommandRefusedError(RefusalCode.GOAL_IN_SAME_TICK)
        status = self._navigator.seek(command.goal)
        self._planned_tick = tick
        return Outcome.of(ResultCode.GOAL_SOUGHT, goal=command.goal.text, status=status.value)

    def _locate(self, name: str, seen_tick: int) -> Outcome:
        if seen_tick < self._lessons.passed_at_tick:
            raise CommandRefusedError(RefusalCode.JUNCTION_PASSED)
        self._navigator.localise(name)
        return Outcome.of(ResultCode.LOCATED, name=name)
