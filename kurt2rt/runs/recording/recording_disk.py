"""Disk operations of a recording behind a protocol, so that tests can inject failures."""

import contextlib
import errno
import fcntl
import os
from pathlib import Path
from typing import Protocol

from kurt2rt.platform.durable_files import free_bytes, fsync_folder, make_private_folder

_NO_LOCKS = frozenset({errno.ENOLCK, errno.EOPNOTSUPP, errno.EBADF, errno.ENOSYS})
"""Error numbers of file systems without locks; NFS returns EBADF for a folder."""


class WritableFile(Protocol):
    """File of a recording that its thread writes at offsets; tests put failing ones in its place."""

    def write_at(self, offset: int, data: bytes | bytearray) -> None:
        """Write all of `data` at `offset` bytes. Raises OSError; part of it may be written then."""
        ...

    def sync(self) -> None:
        """Wait until the data is durable. Raises OSError; the disk's content is undefined then."""
        ...

    def close(self) -> None:
        """Close the file, without a sync. Raises OSError."""
        ...


class Disk(Protocol):
    """Disk that holds recordings; tests put failing ones in its place. Every call may block."""

    def make_folder(self, path: Path) -> None:
        """Create a folder and its parents. Raises OSError; FileExistsError if it exists."""
        ...

    def create(self, path: Path) -> WritableFile:
        """Create a file whose name survives a power cut. Raises OSError; FileExistsError if it exists."""
        ...

    def free_bytes(self, path: Path) -> int:
        """Return the free bytes of the file system that holds, or will hold, `path`. Raises OSError."""
        ...


class RealFile:
    """File of a recording on a disk of this machine (WritableFile)."""

    def __init__(self, path: Path) -> None:
        self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)

    def write_at(self, offset: int, data: bytes | bytearray) -> None:
        """Write all of `data` at `offset` bytes. Raises OSError."""
        rest = memoryview(bytes(data))
        while rest:
            written = os.pwrite(self._descriptor, rest, offset)
            offset += written
            rest = rest[written:]

    def sync(self) -> None:
        """Wait until the data is durable. Raises OSError."""
        os.fdatasync(self._descriptor)

    def close(self) -> None:
        """Close the file. Raises OSError."""
        os.close(self._descriptor)


class RealDisk:
    """Disk of this machine, on which recordings are written (Disk)."""

    def make_folder(self, path: Path) -> None:
        """Create a folder and its parents. Raises OSError; the folder does not exist then."""
        make_private_folder(path.parent)
        path.mkdir()
        try:
            fsync_folder(path.parent)
        except OSError:
            with contextlib.suppress(OSError):  # the first error is the one to tell
                path.rmdir()
            raise

    def create(self, path: Path) -> WritableFile:
        """Create a file whose name survives a power cut. Raises OSError."""
        file = RealFile(path)
        try:
            fsync_folder(path.parent)
        except OSError:
            file.close()
            raise
        return file

    def free_bytes(self, path: Path) -> int:
        """Return the free bytes of the file system that holds, or will hold, `path`. Raises OSError."""
        return free_bytes(path)


class LockedFolder:
    """Lock on a run's folder against deletion by another program.

    The kernel releases the lock at the end of the program. File systems without locks are accepted.
    """

    def __init__(self, path: Path) -> None:
        """Lock the folder.

        Raises OSError, also while another program tests the lock.
        """
        self._descriptor = _open_folder(path)
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno not in _NO_LOCKS:
                os.close(self._descriptor)
                raise

    def close(self) -> None:
        """Release the lock, so that another program may record there."""
        os.close(self._descriptor)


def is_locked(folder: Path) -> bool:
    """Return whether some program records to this folder. Raises OSError."""
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
