"""The disk under a recording: the few calls that can fail, in one place, so that tests can have them fail."""

import contextlib
import errno
import fcntl
import os
from pathlib import Path
from typing import Protocol

from kurt2rt.platform.durable_files import free_bytes, fsync_folder, make_private_folder

_NO_LOCKS = frozenset({errno.ENOLCK, errno.EOPNOTSUPP, errno.EBADF, errno.ENOSYS})
"""What a disk answers that knows no locks: of a folder, NFS says EBADF."""


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
        """That may still be written where `path` is, or is going to be. Raises OSError."""
        ...


class RealFile:
    """A file on a real disk (WritableFile)."""

    def __init__(self, path: Path) -> None:
        self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)

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
        """Make a folder, with those above it. Raises OSError; then it is not there."""
        make_private_folder(path.parent)
        path.mkdir()
        try:
            fsync_folder(path.parent)
        except OSError:
            with contextlib.suppress(OSError):  # the first error is the one to tell
                path.rmdir()
            raise

    def create(self, path: Path) -> WritableFile:
        """Make a file whose name outlives a power cut. Raises OSError."""
        file = RealFile(path)
        try:
            fsync_folder(path.parent)
        except OSError:
            file.close()
            raise
        return file

    def free_bytes(self, path: Path) -> int:
        """That may still be written where `path` is, or is going to be. Raises OSError."""
        return free_bytes(path)


class LockedFolder:
    """A run's folder, held as one's own, so that no other program deletes it to make room.

    The kernel lets it go when this program ends, however it ends. A disk that knows no locks does without.
    """

    def __init__(self, path: Path) -> None:
        """Raises OSError, also where another program looks at this very moment whether it is held."""
        self._descriptor = _open_folder(path)
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno not in _NO_LOCKS:
                os.close(self._descriptor)
                raise

    def close(self) -> None:
        """Let it go."""
        os.close(self._descriptor)


def is_locked(folder: Path) -> bool:
    """Whether some program records to this folder. Raises OSError."""
    descriptor = _open_folder(folder)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
    finally:
        os.close(descriptor)
    return False


def _open_folder(folder: Path) -> int:
    return os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
