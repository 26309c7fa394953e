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

    ending: ShutdownHandler
    notifier: Notifier
    reloading: ConfigReloader | None = None
    """None: settings stay as they were at the start."""
    parts: Mapping[str, Callable[[], bool]] = field(default_factory=dict)
    """What has to be alive beside the loop, by name."""
    guards: Callable[[], Iterable[Thread]] = tuple
    """Threads that have to overtake the loop."""
    tell: Callable[[str], None] = lambda _: None
    """Takes what whoever reads the log should know. Called from the loop: it may not wait."""
