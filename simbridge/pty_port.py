"""Robot's end of a pseudo-terminal, which other programs open as a serial port."""

import contextlib
import os
import tty
from pathlib import Path

from hal.bus import BusError

_MOST_BYTES = 1 << 16


class PtyPort:
    """Pseudo-terminal as a robot's serial line (hal.byte_port.BytePort).

    Other programs open its path `device`.
    """

    waiting = 0

    def __init__(self, device: str = "") -> None:
        """Open a pseudo-terminal; `device`: path of a link to it. Raises hal.bus.BusError if the path is in use."""
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.device = device or os.ttyname(self._slave)
        self.name = f"pseudo-terminal {self.device}"
        self._link = Path(device) if device else None
        self._closed = False
        if self._link is not None:
            try:
                if self._link.is_symlink() and not self._link.exists():  # of a program that was killed
                    self._link.unlink()
                self._link.symlink_to(os.ttyname(self._slave))
            except OSError as error:
                self._link = None
                self.close()
                raise BusError(str(error.strerror), where=self.name, do="take another path, or delete it") from error

    def read(self) -> bytes:
        """Return all bytes that arrived."""
        with contextlib.suppress(BlockingIOError):
            return os.read(self._master, _MOST_BYTES)
        return b""

    def write(self, data: bytes) -> None:
        """Write bytes; they are lost while no other program reads the earlier ones."""
        with contextlib.suppress(BlockingIOError):
            os.write(self._master, data)

    def reopen(self) -> None:
        """Do nothing: this end is never lost."""

    def close(self) -> None:
        """Close both ends and remove the link, which is like unplugging the robot; may be called twice."""
        if self._closed:
            return
        self._closed = True
        own, link = os.ttyname(self._slave), self._link
        os.close(self._master)
        os.close(self._slave)
        if link is not None and link.is_symlink() and str(link.readlink()) == own:  # not the link of a later program
            link.unlink()
