"""Notes of a run on their way to the recording, and their logging."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from hal.simulation import SimulatedPlace, WorldPlan
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.runs.recording.topics import Topics


class TickNote(NamedTuple):
    """Record of one tick."""

    record: TickRecord
    time_ns: int
    """Time since 1970."""
    saved: bool
    """True if statistics were saved after the tick."""
    truth: SimulatedPlace | None
    world: WorldPlan | None


class QuestionNote(NamedTuple):
    """Question of the robot."""

    question: object
    """Object whose `str` is the question."""


class HealthNote(NamedTuple):
    """Health report of the program."""

    report: Mapping[str, Any]
    """Report as plain values."""


Note = TickNote | QuestionNote | HealthNote | Acknowledgement


class NoteLog:
    """Logger of notes to the topics of one destination, at the time of the newest tick."""

    def __init__(self, topics: Topics, began_ns: int) -> None:
        """`began_ns`: time since 1970 of notes before the first tick."""
        self.topics = topics
        self._time_ns = began_ns
        self._world: WorldPlan | None = None

    def log(self, note: Note) -> None:
        """Log one note to its topic. Raises RecordingError or KnowledgeError for a note that cannot be encoded."""
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
