"""Bitwise comparison of a recorded tick with its replay."""

from collections.abc import Iterator
from typing import NamedTuple

from kurt2rt.core.rla.rla_system import knowledge_hash_of
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.recording.entries import TickEntry, tick_entry


class TickDifference(NamedTuple):
    """Field of a tick whose replayed value differs from the recorded one."""

    tick: int
    field: str
    """Path of the field in the recording, with dots between its levels."""
    recorded: object
    replayed: object

    @property
    def text(self) -> str:
        """Line with the recorded and the replayed value."""
        return f"{self.field} was {_short_repr(self.recorded)}, and is {_short_repr(self.replayed)} now"

    def __str__(self) -> str:
        return f"tick {self.tick}: {self.text}"


def compare(entry: TickEntry, record: TickRecord) -> list[TickDifference]:
    """Return the differences of a replayed tick from the recorded one; empty if it is equal to the last bit."""
    knowledge = None
    if entry.knowledge is not None and record.knowledge is not None:
        knowledge = knowledge_hash_of(sorted(record.knowledge, key=lambda rla: rla.rla_id))
    again = tick_entry(record, saved=entry.saved, knowledge=knowledge)
    entry, again = _without_words(entry), _without_words(again)
    if repr(again) == repr(entry):  # `==` takes 0.0 for -0.0 and True for 1, and NaN for another one
        return []
    return [TickDifference(entry.tick, *each) for each in _differences("", entry, again)]


def _without_words(entry: TickEntry) -> TickEntry:
    """Return the entry without the sentences of its results."""
    return entry._replace(results=tuple(each._replace(text="") for each in entry.results))


def _differences(place: str, recorded: object, replayed: object) -> Iterator[tuple[str, object, object]]:
    if isinstance(recorded, tuple) and hasattr(recorded, "_fields") and type(recorded) is type(replayed):
        for name in recorded._fields:
            below = f"{place}.{name}" if place else name
            yield from _differences(below, getattr(recorded, name), getattr(replayed, name))
    elif repr(recorded) != repr(replayed):
        yield place, recorded, replayed


def _short_repr(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 120 else f"{text[:117]}..."
