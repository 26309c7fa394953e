"""A disk under SQLite that keeps a trace of what is done to it, and whose calls fail when they are told to.

Stands between SQLite and its own way to the disk (its `vfs`), so it needs no other program, and sees a call as SQLite
makes it.
"""

import _sqlite3
import ctypes
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any

import pytest

from tests.crash.operations import FolderSynced, Made, Operation, Synced, SyncFailed, Truncated, Unlinked, Written


class Call(StrEnum):
    """Calls of SQLite to a disk that can fail."""

    OPEN = "open"
    READ = "read"
    WRITE = "write"
    TRUNCATE = "truncate"
    SYNC = "sync"
    SIZE = "size"
    LOCK = "lock"
    DELETE = "delete"
    MAP = "map"


class Failure(StrEnum):
    """Errors of a failing call; a failing write has written half."""

    FULL = "ENOSPC"
    BROKEN = "EIO"


_BROKEN = {
    Call.OPEN: sqlite3.SQLITE_CANTOPEN,
    Call.READ: sqlite3.SQLITE_IOERR_READ,
    Call.WRITE: sqlite3.SQLITE_IOERR_WRITE,
    Call.TRUNCATE: sqlite3.SQLITE_IOERR_TRUNCATE,
    Call.SYNC: sqlite3.SQLITE_IOERR_FSYNC,
    Call.SIZE: sqlite3.SQLITE_IOERR_FSTAT,
    Call.LOCK: sqlite3.SQLITE_IOERR_LOCK,
    Call.DELETE: sqlite3.SQLITE_IOERR_DELETE,
    Call.MAP: sqlite3.SQLITE_IOERR_SHMMAP,
}
_FULL = {Call.WRITE: sqlite3.SQLITE_FULL, Call.SYNC: sqlite3.SQLITE_FULL, Call.MAP: sqlite3.SQLITE_FULL}

_INT, _I64, _POINTER, _TEXT = ctypes.c_int, ctypes.c_int64, ctypes.c_void_p, ctypes.c_char_p
# Names stay addresses: SQLite keeps them, and more stands behind their end.
_OPEN = ctypes.CFUNCTYPE(_INT, _POINTER, _POINTER, _POINTER, _INT, _POINTER)
_DELETE = ctypes.CFUNCTYPE(_INT, _POINTER, _POINTER, _INT)
_CLOSE = ctypes.CFUNCTYPE(_INT, _POINTER)
_TRANSFER = ctypes.CFUNCTYPE(_INT, _POINTER, _POINTER, _INT, _I64)
_RESIZE = ctypes.CFUNCTYPE(_INT, _POINTER, _I64)
_WITH_INT = ctypes.CFUNCTYPE(_INT, _POINTER, _INT)
_SIZE = ctypes.CFUNCTYPE(_INT, _POINTER, _POINTER)
_MAP = ctypes.CFUNCTYPE(_INT, _POINTER, _INT, _INT, _INT, _POINTER)


class _Vfs(ctypes.Structure):
    """sqlite3_vfs of sqlite3.h."""

    _fields_ = (
        ("version", _INT),
        ("file_bytes", _INT),
        ("longest_path", _INT),
        ("next", _POINTER),
        ("name", _TEXT),
        ("own", _POINTER),
        ("open", _OPEN),
        ("delete", _DELETE),
        ("others", _POINTER * 14),
    )


class _Methods(ctypes.Structure):
    """sqlite3_io_methods of sqlite3.h."""

    _fields_ = (
        ("version", _INT),
        ("close", _CLOSE),
        ("read", _TRANSFER),
        ("write", _TRANSFER),
        ("truncate", _RESIZE),
        ("sync", _WITH_INT),
        ("size", _SIZE),
        ("lock", _WITH_INT),
        ("unlock", _WITH_INT),
        ("between", _POINTER * 4),
        ("map", _MAP),
        ("others", _POINTER * 5),
    )


class _File(ctypes.Structure):
    """sqlite3_file of sqlite3.h."""

    _fields_ = (("methods", ctypes.POINTER(_Methods)),)


@dataclass(frozen=True, slots=True)
class Fault:
    """The call of that number, from 1, fails in that way."""

    number: int
    failure: Failure
    lasts: int = 1
    """So many calls fail one after the other."""


@dataclass
class WatchedDisk:
    """Disk that logs its calls in order and fails one of them."""

    fault: Fault | None = None
    calls: list[Call] = field(default_factory=list)
    operations: list[Operation] = field(default_factory=list)
    failed: list[Call] = field(default_factory=list)
    """The calls that were made to fail."""

    def note(self, operation: Operation) -> None:
        """Put something between the operations: that a lesson was acknowledged."""
        self.operations.append(operation)

    def failure(self, call: Call) -> Failure | None:
        """Count a call; how it is to fail."""
        self.calls.append(call)
        fault = self.fault
        if fault is None or not fault.number <= len(self.calls) < fault.number + fault.lasts:
            return None
        self.failed.append(call)
        return fault.failure


def _library() -> Any:
    """SQLite as Python itself uses it, or a reason to skip."""
    library: Any = ctypes.CDLL(_sqlite3.__file__)
    try:
        library.sqlite3_vfs_find.restype = ctypes.POINTER(_Vfs)
    except AttributeError:
        pytest.skip("this Python has SQLite built in and shows none of its functions")
    library.sqlite3_vfs_register.argtypes = (_POINTER, _INT)
    library.sqlite3_vfs_unregister.argtypes = (_POINTER,)
    return library


def _path(address: int) -> Path:
    return Path(ctypes.string_at(address).decode())


class _Shim:
    """The functions that SQLite calls in place of its own, and everything that must live as long as they may be."""

    def __init__(self, sound: _Vfs, disk: WatchedDisk) -> None:
        self._sound = sound
        self._disk = disk
        self._names: dict[int, str] = {}
        self._folder_is_synced: dict[int, bool] = {}
        self._methods: dict[int, tuple[Any, _Methods]] = {}
        self.vfs = _Vfs.from_buffer_copy(sound)
        self.vfs.name = b"watched"
        self.vfs.open = _OPEN(self._open)
        self.vfs.delete = _DELETE(self._delete)

    def _fails(self, call: Call) -> int:
        failure = self._disk.failure(call)
        if failure is None:
            return sqlite3.SQLITE_OK
        errors = _FULL if failure is Failure.FULL else _BROKEN
        return errors.get(call, _BROKEN[call])

    def _open(self, vfs: int, name: int | None, file: int, flags: int, out_flags: int) -> int:
        error = self._fails(Call.OPEN)
        opened = _File.from_address(file)
        if error:
            ctypes.memset(file, 0, ctypes.sizeof(_POINTER))
            return error
        is_new = name is not None and not _path(name).exists()
        result = int(self._sound.open(vfs, name, file, flags, out_flags))
        if result == sqlite3.SQLITE_OK and name is not None:
            sound = opened.methods.contents
            known = ctypes.addressof(sound)
            if known not in self._methods:
                self._methods[known] = (sound, self._watching(sound))
            opened.methods = ctypes.pointer(self._methods[known][1])
            self._names[file] = _path(name).name
            if is_new:
                self._disk.note(Made(self._names[file]))
            # SQLite syncs the folder of a log with the log, the first time.
            self._folder_is_synced[file] = not self._names[file].endswith(("-wal", "-journal"))
        return result

    def _delete(self, vfs: int, name: int, sync_folder: int) -> int:
        error = self._fails(Call.DELETE)
        if error:
            return error
        result = int(self._sound.delete(vfs, name, sync_folder))
        if result == sqlite3.SQLITE_OK:
            self._disk.note(Unlinked(_path(name).name))
            if sync_folder:
                self._disk.note(FolderSynced())
        return result

    def _watching(self, sound: _Methods) -> _Methods:
        """Return a table of methods that log each call, then forward it."""
        disk, names = self._disk, self._names

        def read(file: int, buffer: int, count: int, at: int) -> int:
            return self._fails(Call.READ) or int(sound.read(file, buffer, count, at))

        def write(file: int, buffer: int, count: int, at: int) -> int:
            error = self._fails(Call.WRITE)
            written = count // 2 if error else count
            result = int(sound.write(file, buffer, written, at)) if written else sqlite3.SQLITE_OK
            disk.note(Written(names[file], at, ctypes.string_at(buffer, written)))
            return error or result

        def truncate(file: int, size: int) -> int:
            error = self._fails(Call.TRUNCATE)
            if error:
                return error
            disk.note(Truncated(names[file], size))
            return int(sound.truncate(file, size))

        def sync(file: int, flags: int) -> int:
            error = self._fails(Call.SYNC)
            if error:
                disk.note(SyncFailed(names[file]))
                return error
            disk.note(Synced(names[file], folder=not self._folder_is_synced[file]))
            self._folder_is_synced[file] = True
            return int(sound.sync(file, flags))

        def size(file: int, result: int) -> int:
            return self._fails(Call.SIZE) or int(sound.size(file, result))

        def lock(file: int, level: int) -> int:
            return self._fails(Call.LOCK) or int(sound.lock(file, level))

        def shared_memory(file: int, page: int, size: int, extend: int, result: int) -> int:
            return self._fails(Call.MAP) or int(sound.map(file, page, size, extend, result))

        methods = _Methods.from_buffer_copy(sound)
        methods.read, methods.write = _TRANSFER(read), _TRANSFER(write)
        methods.truncate, methods.sync, methods.size = _RESIZE(truncate), _WITH_INT(sync), _SIZE(size)
        methods.lock, methods.map = _WITH_INT(lock), _MAP(shared_memory)
        return methods


@contextmanager
def watched(disk: WatchedDisk) -> Iterator[WatchedDisk]:
    """Every file that SQLite opens meanwhile is on that disk."""
    library = _library()
    sound = library.sqlite3_vfs_find(None).contents
    shim = _Shim(sound, disk)
    library.sqlite3_vfs_register(ctypes.byref(shim.vfs), 1)
    try:
        yield disk
    finally:
        library.sqlite3_vfs_register(ctypes.byref(sound), 1)
        library.sqlite3_vfs_unregister(ctypes.byref(shim.vfs))
