"""What a service tells its manager: sd_notify(3), a datagram of lines to the socket that the environment names."""

import os
import socket
from collections.abc import Mapping
from types import TracebackType
from typing import Self


class Notifier:
    """Says how the service is. Never waits and never raises: what the manager does not take is lost and counted.

    Without a service manager all of it is said to nobody.
    """

    def __init__(self, environment: Mapping[str, str] | None = None) -> None:
        """`environment`: in which NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID may stand; this process's unless given.

        Raises OSError where no socket can be had.
        """
        environment = os.environ if environment is None else environment
        self._address = _address(environment.get("NOTIFY_SOCKET", ""))
        self._socket: socket.socket | None = None
        if self._address is not None:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)
            self._socket.setblocking(False)
        self.watchdog_s = _watchdog_s(environment) if self._socket is not None else None
        """Silence after which the manager ends the service and starts it anew; None: it does not listen for pings."""
        self.lost = 0
        """Messages that the manager did not take."""
        self._status = ""

    @property
    def has_manager(self) -> bool:
        """Whether there is a service manager."""
        return self._socket is not None

    def ready(self) -> None:
        """The service is up, or up again after a reload."""
        self._send("READY=1")

    def reloading(self, monotonic_us: int) -> None:
        """Settings are read anew; `ready` ends it."""
        self._send(f"RELOADING=1\nMONOTONIC_USEC={monotonic_us}")

    def stopping(self) -> None:
        """The service ends."""
        self._send("STOPPING=1")

    def ping(self) -> None:
        """The service is well."""
        self._send("WATCHDOG=1")

    def status(self, text: str) -> None:
        """One line for whoever looks at the unit; said only when it is another one than before."""
        line = " ".join(text.split())
        if line != self._status:
            self._status = line
            self._send(f"STATUS={line}")

    def close(self) -> None:
        """Say nothing more; may be called twice."""
        opened, self._socket = self._socket, None
        if opened is not None:
            opened.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _send(self, lines: str) -> None:
        opened = self._socket
        if opened is None or self._address is None:
            return
        try:
            opened.sendto(lines.encode(), self._address)
        except OSError:  # a manager that is busy or gone must not hold up a tick, and nobody else could be told
            self.lost += 1


def _address(named: str) -> str | None:
    """A path, or a name in Linux's abstract space, which systemd writes with @ for the zero byte."""
    if named.startswith("@"):
        return f"\0{named[1:]}"
    return named if named.startswith("/") else None


def _watchdog_s(environment: Mapping[str, str]) -> float | None:
    """As sd_watchdog_enabled(3): meant for this very process, and more than nothing."""
    if environment.get("WATCHDOG_PID", str(os.getpid())) != str(os.getpid()):
        return None
    microseconds = environment.get("WATCHDOG_USEC", "")
    return int(microseconds) / 1e6 if microseconds.isdecimal() and int(microseconds) > 0 else None
