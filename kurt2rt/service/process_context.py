"""Context of the process around the service: signals, service manager, threads."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from threading import Thread

from kurt2rt.service.config_reload import ConfigReloader
from kurt2rt.service.shutdown import ShutdownHandler
from kurt2rt.service.systemd.notifier import Notifier


@dataclass(frozen=True, slots=True)
class ProcessContext:
    """Parts of the process that the service uses."""

    shutdown: ShutdownHandler
    notifier: Notifier
    reloader: ConfigReloader | None = None
    """None: settings are not reloaded."""
    liveness: Mapping[str, Callable[[], bool]] = field(default_factory=dict)
    """Checks of what must be alive for the heartbeat, without the loop, by name."""
    guard_threads: Callable[[], Iterable[Thread]] = tuple
    """Returns the threads that must preempt the loop."""
    log: Callable[[str], None] = lambda _: None
    """Gets a line for the log. The loop calls it: it may not wait."""
