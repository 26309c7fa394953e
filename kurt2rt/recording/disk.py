"""The disk under a recording: the few calls that can fail, in one place, so that tests can have them fail."""

import fcntl
import os
from pathlib import Path
from typing import Protocol


class WritableFile(Protocol):
    """A file that was made anew."""

    def write_at(self, offset: int, data: bytes | bytearray) -> None:
        """Write all of `data` from `offset` bytes on. Raises OSError; some of it may be written then."""
        ...

    def sync(self) -> None:
        """Wait until the disk has all of it. Raises OSError; nobody knows what it has then."""
        ...

    def close(self) -> None:
        """Give the file back. Raises OSError."""
        ...


class Disk(Protocol):
    """Where recordings are kept. All of it may wait."""

    def make_folder(self, path: Path) -> None:
        """Make a folder, with those above it. Raises OSError; FileExistsError where it is there already."""
        ...

    def create(self, path: Path) -> WritableFile:
        """Make a file whose name outlives a power cut. Raises OSError; FileExistsError where it is there already."""
        ...

    def free_bytes(self, path: Path) -> int:
        """That may still be written where `path` is. Raises OSError."""
        ...


class RealFile:
    """A file on a real disk (WritableFile)."""

    def __init__(self, path: Path) -> None:
        self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        # Tells other programs, until this one ends however it ends, that the file is still being written.
        fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def write_at(self, offset: int, data: bytes | bytearray) -> None:
        """Write all of `data` from `offset` bytes on. Raises OSError."""
        rest = memoryview(bytes(data))
        while rest:
            written = os.pwrite(self._descriptor, rest, offset)
            offset += written
            rest = rest[written:]

    def sync(self) -> None:
        """Wait until the disk has all of it. Raises OSError."""
        os.fdatasync(self._descriptor)

    def close(self) -> None:
        """Give the file back. Raises OSError."""
        os.close(self._descriptor)


class RealDisk:
    """The disk of this machine (Disk)."""

    def make_folder(self, path: Path) -> None:
        """Make a folder, with those above it. Raises OSError."""
        path.parent.mkdir(parents=True, exist_ok=True)
        path.mkdir()
        _keep_names_in(path.parent)

    def create(self, path: Path) -> WritableFile:
        """Make a file whose name outlives a power cut. Raises OSError."""
        file = RealFile(path)
        _keep_names_in(path.parent)
        return file

    def free_bytes(self, path: Path) -> int:
        """That may still be written where `path` is. Raises OSError."""
        room = os.statvfs(path)
        return room.f_bavail * room.f_frsize


def is_being_written(path: Path) -> bool:
    """Whether some program has the file open to record on. Raises OSError."""
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


def _keep_names_in(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
