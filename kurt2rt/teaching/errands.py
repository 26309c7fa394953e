"""What a teacher says of places and goals: names for situations, where the robot is, where it is to go."""

from kurt2rt.planning.navigator import Navigator
from kurt2rt.planning.target import NoSuchGoalError
from kurt2rt.rla.rla import MID, Origin, SituationNamed, TeachingEvent
from kurt2rt.teaching.commands import BeAt, NameSituation, Seek, StopSeeking
from kurt2rt.teaching.mid_lessons import MidLessons
from kurt2rt.teaching.refused import RefusedError

ErrandCommand = NameSituation | Seek | StopSeeking | BeAt

LONGEST_NAME = 64


class Errands:
    """Carries these commands out, with the navigator."""

    def __init__(self, navigator: Navigator, lessons: MidLessons) -> None:
        self._navigator = navigator
        self._lessons = lessons
        self._seen_tick = -1
        """What the teacher had seen when he said what is sought now."""
        self._planned_tick = -1

    def name(self, command: NameSituation, origin: Origin) -> tuple[str, TeachingEvent]:
        """The event that gives a situation its name. Raises RefusedError."""
        name = command.name
        if not 0 < len(name) <= LONGEST_NAME or not name.isprintable() or name != name.strip():
            raise RefusedError(f"{name!r} is no name for a situation; give 1 to {LONGEST_NAME} letters on one line")
        situation = tuple(self._lessons.meant(command.decision_tick).vector.tolist())
        return f"situation named: {name}", SituationNamed(name, situation, MID, origin)

    def carry_out(self, command: Seek | StopSeeking | BeAt, tick: int) -> str:
        """What was done, in words. Raises RefusedError, also for what comes so late that it is not meant any more."""
        seen_tick = tick if command.seen_tick is None else command.seen_tick
        if isinstance(command, BeAt):
            return self._be_at(command.name, seen_tick)
        if seen_tick < self._seen_tick:
            raise RefusedError("another goal was given after this was said; look at the robot, then say it again")
        said = self._seek(command, tick)
        self._seen_tick = seen_tick
        return said

    def _seek(self, command: Seek | StopSeeking, tick: int) -> str:
        if isinstance(command, StopSeeking):
            self._navigator.stop()
            return "no goal is sought"
        if tick == self._planned_tick:  # a tick has no time for as many plans as somebody may send
            raise RefusedError("another goal was given in the same moment; say it again")
        try:
            said = self._navigator.seek(command.goal)
        except NoSuchGoalError as error:
            raise RefusedError(str(error)) from error
        self._planned_tick = tick
        return said

    def _be_at(self, name: str, seen_tick: int) -> str:
        if seen_tick < self._lessons.passed_at_tick:
            raise RefusedError("a junction was passed after this was said; look at the robot, then say it again")
        try:
            self._navigator.be_at(name)
        except ValueError as error:
            raise RefusedError(str(error)) from error
        return f"the robot is at {name}"
