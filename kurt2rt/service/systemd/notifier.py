"""Messages to the service manager by sd_notify(3): datagrams to the socket that the environment names."""

import os
import socket
from collections.abc import Mapping
from typing import Self


class Notifier:
    """Sender of messages to the service manager; without a manager it does nothing.

    It never waits and never raises: messages that the manager does not accept are dropped and counted.
    """

    def __init__(self, environment: Mapping[str, str] | None = None) -> None:
        """Open the socket. Raises OSError.

        `environment`: NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID; None: the environment of this process.
        """
        environment = os.environ if environment is None else environment
        self._address = _address(environment.get("NOTIFY_SOCKET", ""))
        self._socket: socket.socket | None = None
        if self._address is not None:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)
            self._socket.setblocking(False)
        self.watchdog_s = _watchdog_s(environment) if self._socket is not None else None
        """Time without a ping after which the manager restarts the service, in s; None: it expects no pings."""
        self.lost = 0
        """Messages that the manager did not accept."""
        self._status = ""

    def ready(self) -> None:
        """Report that the service is up."""
        self._send("READY=1")

    def stopping(self) -> None:
        """Report that the service ends."""
        self._send("STOPPING=1")

    def ping(self) -> None:
        """Send a ping of the manager's watchdog; due at least every `watchdog_s`."""
        self._send("WATCHDOG=1")

    def status(self, text: str) -> None:
        """Set the status line of the unit; an unchanged line is not sent again."""
        line = " ".join(text.split())
        if line != self._status:
            self._status = line
            self._send(f"STATUS={line}")

    def close(self) -> None:
        """Close the socket; may be called twice."""
        opened, self._socket = self._socket, None
        if opened is not None:
            opened.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _send(self, lines: str) -> None:
        opened = self._socket
        if opened is None or self._address is None:
            return
        try:
            opened.sendto(lines.encode(), self._address)
        except OSError:  # a manager that is busy or gone must not delay a tick
            self.lost += 1


def _address(named: str) -> str | None:
    """Return a path, or a name in Linux's abstract space, which systemd writes with @ for the zero byte; else None."""
    if named.startswith("@"):
        return f"\0{named[1:]}"
    return named if named.startswith("/") else None


def _watchdog_s(environment: Mapping[str, str]) -> float | None:
    """Return the watchdog time in s as sd_watchdog_enabled(3) does; None unless it is meant for this process."""
    if environment.get("WATCHDOG_PID", str(os.getpid())) != str(os.getpid()):
        return None
    microseconds = environment.get("WATCHDOG_USEC", "")
    return int(microseconds) / 1e6 if microseconds.isdecimal() and int(microseconds) > 0 else None
