"""Event store: what the tick gives its teaching events to, so that they are saved outside the tick."""

from dataclasses import dataclass, field
from typing import Protocol

from kurt2rt.core.rla.events import TeachingEvent


class EventStore(Protocol):
    """Queue of teaching events to the disk; it works outside the tick, and its methods return at once.

    A full disk appears as `saving_error`, and the robot stands until lessons can be saved. The tick submits events
    in order, and none is dropped.
    """

    @property
    def saving_error(self) -> str | None:
        """Reason that lessons cannot be saved now, in one line; None if they can."""
        ...

    def submit(self, event: TeachingEvent) -> None:
        """Queue an event for saving; return at once. A failure appears in `saving_error`."""
        ...


@dataclass(slots=True)
class InMemoryEventStore:
    """Event store that keeps lessons in a list and not in a file, for simulated training (EventStore)."""

    events: list[TeachingEvent] = field(default_factory=list)
    saving_error: str | None = None

    def submit(self, event: TeachingEvent) -> None:
        """Append an event to the list."""
        self.events.append(event)
