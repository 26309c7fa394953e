"""What keeps the program up and ends it well, for whoever serves."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from threading import Thread

from kurt2rt.service.config_reload import ConfigReloader
from kurt2rt.service.shutdown import ShutdownHandler
from kurt2rt.service.systemd.notifier import Notifier


@dataclass(frozen=True, slots=True)
class ProcessContext:
    """Made by the program around its service."""

    shutdown: ShutdownHandler
    notifier: Notifier
    reloader: ConfigReloader | None = None
    """None: settings stay as they were at the start."""
    liveness: Mapping[str, Callable[[], bool]] = field(default_factory=dict)
    """What has to be alive beside the loop, by name."""
    guard_threads: Callable[[], Iterable[Thread]] = tuple
    """Threads that have to overtake the loop."""
    log: Callable[[str], None] = lambda _: None
    """Takes what whoever reads the log should know. Called from the loop: it may not wait."""
