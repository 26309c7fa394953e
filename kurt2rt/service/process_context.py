"""Context of the process around the service: signals, service manager, threads."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from kurt2rt.service.shutdown import ShutdownHandler
from kurt2rt.service.systemd.notifier import Notifier


@dataclass(frozen=True, slots=True)
class ProcessContext:
    """Parts of the process that the service uses."""

    shutdown: ShutdownHandler
    notifier: Notifier
    liveness: Mapping[str, Callable[[], bool]] = field(default_factory=dict)
    """Checks of what must be alive for the heartbeat, without the loop, by name."""
    log: Callable[[str], None] = lambda _: None
    """Gets a line for the log. The loop calls it: it may not wait."""
