"""Free space of the disks, read by one thread each, so that a disk that hangs delays nothing else."""

import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

from kurt2rt.channel.protocol.health import DiskSpace
from kurt2rt.platform.durable_files import free_bytes

_EVERY_S = 1.0
_ANSWERS_WITHIN_S = 4.0


class DiskMonitor:
    """Threads that read the free space once a second; an answer counts for 4 s."""

    def __init__(self, folders: Mapping[str, Path], now: Callable[[], float] = time.monotonic) -> None:
        """`folders`: by the name of their content; `now`: a clock in s."""
        self._folders = dict(folders)
        self._now = now
        self._said: dict[str, tuple[float, int]] = {}
        self._ending = threading.Event()
        self._threads = [
            threading.Thread(target=self._run, args=(of,), name=f"room for {of}", daemon=True) for of in self._folders
        ]

    def poll(self, of: str) -> None:
        """Read the free space of one disk; may wait for the disk."""
        try:
            found = free_bytes(self._folders[of])
        except OSError:
            return  # reported as a disk that does not answer
        self._said[of] = self._now(), found

    def spaces(self) -> tuple[DiskSpace, ...]:
        """Return the newest space of each disk, without waiting; `free_bytes` is None if the disk does not answer."""
        now_s = self._now()
        found = []
        for of in self._folders:
            said_at_s, free_bytes = self._said.get(of, (float("-inf"), 0))
            found.append(DiskSpace(of, free_bytes if now_s - said_at_s <= _ANSWERS_WITHIN_S else None))
        return tuple(found)

    def __enter__(self) -> Self:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ending.set()  # not joined: a disk that hangs would hang the end

    def _run(self, of: str) -> None:
        self.poll(of)
        while not self._ending.wait(_EVERY_S):
            self.poll(of)
