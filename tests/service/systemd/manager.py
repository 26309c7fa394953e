"""A service manager's ear: a real datagram socket, as systemd has one."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class Manager:
    """Hears what a service tells it."""

    def __init__(self, address: str) -> None:
        self.address = address
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(f"\0{address[1:]}" if address.startswith("@") else address)

    def environment(self, watchdog_s: float | None = None) -> dict[str, str]:
        """Return the environment of a service under systemd; with a watchdog, it names this process."""
        watchdog = {} if watchdog_s is None else {"WATCHDOG_USEC": str(round(watchdog_s * 1e6))}
        return {"NOTIFY_SOCKET": self.address, "WATCHDOG_PID": str(os.getpid()), **watchdog}

    def heard(self) -> list[str]:
        """Return the lines of all messages since the last call."""
        lines: list[str] = []
        while True:
            try:
                lines += self._socket.recv(4096, socket.MSG_DONTWAIT).decode().splitlines()
            except BlockingIOError:
                return lines

    def wait_for(self, text: str, longest_s: float = 60.0) -> list[str]:
        """All lines up to one with the text in it; the time is for a line that never comes."""
        self._socket.settimeout(longest_s)
        lines: list[str] = []
        while not any(text in each for each in lines):
            lines += self._socket.recv(4096).decode().splitlines()
        return lines

    def close(self) -> None:
        self._socket.close()


@contextmanager
def manager(folder: Path) -> Iterator[Manager]:
    opened = Manager(str(folder / "notify"))
    try:
        yield opened
    finally:
        opened.close()
