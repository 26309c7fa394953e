"""List of the newest lessons for teachers, with those that contradict their neighbours."""

from collections.abc import Callable, Iterator, Mapping

from kurt2rt.channel.protocol.lesson_list import Contradicting, LessonLine
from kurt2rt.channel.protocol.limits import MOST_CONTRADICTIONS
from kurt2rt.core.outcome import Field
from kurt2rt.core.rla.contradiction import Contradiction, find_contradiction
from kurt2rt.core.rla.events import ActionReplaced, RlaCreated
from kurt2rt.core.rla.lesson_history import LessonRecord, hold_of, hold_text, rla_id_of
from kurt2rt.core.rla.rla_system import RlaSystem


class LessonList:
    """Rows of the newest lessons, computed between two ticks for each request."""

    def __init__(self, system: RlaSystem, stamp_of: Callable[[str], str], groups: Mapping[str, str]) -> None:
        """Connect the knowledge.

        Args:
            system: with the lessons.
            stamp_of: returns the time when the lesson of a command became durable, UTC; empty before.
            groups: group of each action (behaviors.action_groups).
        """
        self._system = system
        self._stamp_of = stamp_of
        self._groups = groups

    def newest(self, count: int) -> Iterator[LessonLine]:
        """Yield the newest lessons, at most `count`, newest first; the lessons of a hold are one line.

        A line tells which of its lessons contradict their neighbours, as long as they are not too many in all.
        """
        left = MOST_CONTRADICTIONS
        for command_id, text, records in self._newest(count):
            origin = records[0].event.origin
            stamp = self._stamp_of(origin.command_id)
            undone = all(each.undone for each in records)
            found = (self.contradiction_of(each.event.origin.command_id) for each in records[:left])
            against = tuple(_told(each) for each in found if each is not None)
            left -= len(records[:left])
            yield LessonLine(command_id, text, origin.teacher, int(origin.phase), origin.tick, stamp, undone, against)

    def fields_of(self, command_id: str) -> dict[str, Field]:
        """Return the fields `against` and `nearest` of the answer to a lesson; none if it contradicts nothing."""
        found = self.contradiction_of(command_id)
        return {} if found is None else {"against": found.actions, "nearest": found.neighbours[0].rla_id}

    def contradiction_of(self, command_id: str) -> Contradiction | None:
        """Return the contradiction that a lesson made and that lasts; None if there is none."""
        record = self._system.history.get(command_id)
        if record is None or record.undone or not isinstance(record.event, RlaCreated | ActionReplaced):
            return None
        rla = self._system.get(rla_id_of(record.event))
        if rla is None or rla.origin.command_id != command_id:  # another lesson gave it its present action
            return None
        return find_contradiction(self._system, rla, self._groups)

    def _newest(self, count: int) -> Iterator[tuple[str, str, tuple[LessonRecord, ...]]]:
        """Yield the id that undoes a row, its text, and its lessons, at least one, newest row first."""
        holds: set[str] = set()
        listed = 0
        for record in reversed(self._system.history.records if count else ()):
            command_id = record.event.origin.command_id
            hold = hold_of(command_id)
            if hold in holds:
                continue
            if listed == count:
                return
            listed += 1
            if hold is None:
                yield command_id, record.text, (record,)
                continue
            holds.add(hold)
            given = tuple(filter(None, map(self._system.history.get, self._system.history.of_hold(hold))))
            yield hold, hold_text(given), (record, *(each for each in given if each is not record))


def _told(found: Contradiction) -> Contradicting:
    rla = found.rla
    return Contradicting(rla.origin.command_id, rla.rla_id, rla.action, found.neighbours[0].rla_id, found.actions)
