"""What is noted of a run beside the loop, and how it is logged."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from hal.simulation import SimulatedPlace, WorldPlan
from kurt2rt.core.tick import TickRecord
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.runs.recording.topics import Topics


class TickNote(NamedTuple):
    """A tick has been."""

    record: TickRecord
    time_ns: int
    """Since 1970."""
    saved: bool
    """Statistics were saved after it."""
    truth: SimulatedPlace | None
    world: WorldPlan | None


class QuestionNote(NamedTuple):
    """The robot begins to ask."""

    question: object
    """`str` of it is the question."""


class HealthNote(NamedTuple):
    """Health report of the program."""

    report: Mapping[str, Any]
    """As plain values."""


Note = TickNote | QuestionNote | HealthNote | Acknowledgement


class NoteLog:
    """Logs notes to the topics of one place, each at the time of the newest tick."""

    def __init__(self, topics: Topics, began_ns: int) -> None:
        """`began_ns`: time since 1970 of what is noted before the first tick."""
        self.topics = topics
        self._time_ns = began_ns
        self._world: WorldPlan | None = None

    def log(self, note: Note) -> None:
        """One note. Raises RecordingError for one that cannot be written."""
        topics = self.topics
        match note:
            case TickNote(record, time_ns, saved, truth, world):
                self._time_ns = time_ns
                topics.tick(record, saved=saved, truth=truth, time_ns=time_ns)
                self._world = world or self._world
                if self._world is not None:
                    topics.log_world(self._world, record.tick, time_ns)
            case QuestionNote(question):
                topics.on_question(str(question), self._time_ns)
            case HealthNote(report):
                topics.on_health(report, self._time_ns)
            case Acknowledgement():
                topics.on_acknowledged(note, self._time_ns)
