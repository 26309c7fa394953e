"""Parts of a robot program that the health report reads. Nothing here waits."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from hal.health import Health


@dataclass(frozen=True, slots=True)
class Probes:
    """Functions and folders by which the health report reads parts of the program outside the runtime."""

    bus: Callable[[], Health] | None = None
    """Returns the counters of the robot's bus; None: no bus."""
    drops: Mapping[str, Callable[[], int]] = field(default_factory=dict)
    """Number of dropped items so far, by queue."""
    errors: Mapping[str, Callable[[], str]] = field(default_factory=dict)
    """Error and cure of each part, in a line; empty if nothing is wrong."""
    folders: Mapping[str, Path] = field(default_factory=dict)
    """Folders that need free space, by the name of their content."""
    pages: Callable[[], tuple[str, ...]] = tuple
    """Returns the links to the teacher's page, with their tokens; empty if no page is served."""
    reached: Callable[[], str] = str
    """Returns the progress of a simulated robot with its task, such as `1.5 laps`; empty if it is not measured."""

    def with_more(
        self,
        drops: Mapping[str, Callable[[], int]] | None = None,
        errors: Mapping[str, Callable[[], str]] | None = None,
    ) -> "Probes":
        """Return a copy of these probes with more counters and errors, by name of the queue or part."""
        return replace(self, drops={**self.drops, **(drops or {})}, errors={**self.errors, **(errors or {})})
