"""What the health report reads of a robot's program. Nothing here waits."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

from hal.health import Health


class JournalStats(Protocol):
    """Where lessons are kept; kurt2rt.knowledge.journal.writer.JournalWriter is one."""

    @property
    def unwritten(self) -> int:
        """Lessons that are not durable yet."""
        ...

    @property
    def error(self) -> str | None:
        """Why lessons cannot be saved, and what to do; None when they can."""
        ...

    @property
    def last_write_s(self) -> float | None:
        """How long the disk took to keep the last ones; None before the first."""
        ...


@dataclass(frozen=True, slots=True)
class Probes:
    """The parts of a program that are no part of its runtime."""

    bus: Callable[[], Health] | None = None
    """Counters of the robot's bus; None where there is none."""
    drops: Mapping[str, Callable[[], int]] = field(default_factory=dict)
    """By queue, how much it threw away so far."""
    errors: Mapping[str, Callable[[], str]] = field(default_factory=dict)
    """By part, what is wrong with it and what to do, in a line; empty when nothing is."""
    folders: Mapping[str, Path] = field(default_factory=dict)
    """What is kept, and in which folder there has to be room for it."""
    pages: Callable[[], tuple[str, ...]] = tuple
    """Links to the teacher's page, with their tokens; none where this program serves no page."""

    def with_more(
        self,
        drops: Mapping[str, Callable[[], int]] | None = None,
        errors: Mapping[str, Callable[[], str]] | None = None,
    ) -> "Probes":
        """These and others."""
        return replace(self, drops={**self.drops, **(drops or {})}, errors={**self.errors, **(errors or {})})
