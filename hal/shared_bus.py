"""CAN bus across processes of this machine without the kernel's CAN: `shared:NAME`."""

import contextlib
import fcntl
import mmap
import os
import re
import secrets
import stat
import struct
import time
import zlib
from pathlib import Path
from threading import RLock

import can

from hal.bus_frame import frame_of, is_heard, pack_bus_frame

SHARED_MEMORY = Path("/dev/shm")
KEPT_FRAMES = 8192
"""Frames that the bus keeps for a reader that is behind."""

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,63}")
_HEAD = b"kurt2rt shared CAN bus, layout 1"
_STAMP_AND_SENDER = struct.Struct("=dI")
_CHECKSUM = struct.Struct("=I")
_RECORD = struct.Struct("=IB3x8sdII")
_RECORD_BYTES = _RECORD.size
_CHECKED_BYTES = _RECORD_BYTES - _CHECKSUM.size
_HOLE = bytes(_RECORD_BYTES)
_BLOCK_BYTES = 4096
_HEAD_BYTES = mmap.ALLOCATIONGRANULARITY  # a page of its own: memory is given back in pages, and the head stays
_KEPT_BYTES = KEPT_FRAMES * _RECORD_BYTES
_GIVE_BACK_BYTES = 16 * mmap.ALLOCATIONGRANULARITY
_OPENING_TRIES = 20
_LOOK_EVERY = 128  # of the looks that find nothing also sees whether the file still has its name
_PASSED_AT_ONCE = 4096  # records that a look may pass over: a flood of what is not heard must not hold up a tick
_POLL_S = 0.001


class SharedBus(can.BusABC):
    """One end of a bus that all processes of one user share through a file in memory.

    Every frame is one record at the end of the file, put there by one `write` in append mode. The kernel puts
    appends one after the other, whole or not at all (a record never crosses a page): so all readers see one order,
    there is no lock that a stopped or killed process could hold, and a writer never waits for a reader. What is older
    than KEPT_FRAMES is given back to the system as a hole in the file; a reader that is further behind goes on
    after the hole and counts what it lost. Time stamps are those of the sender, on the monotonic clock of the machine.

    The file exists while a process has the bus open. The last one removes it, and files of killed processes.
    """

    receives_own_frames = False

    def __init__(self, name: str) -> None:
        """Join the bus of that name; frames count from now. Raises can.CanInitializationError, OSError."""
        if not _NAME.fullmatch(name):
            raise can.CanInitializationError("a name is up to 64 letters, digits and _ . -")
        self.channel = name
        self.channel_info = f"shared CAN bus {name}"
        self.overruns = 0
        """Frames lost before this end read them, own and filtered ones included."""
        self.damaged = 0
        """Records that are no frames of this program."""
        self._path = _folder() / name
        self._sender = secrets.randbits(32)
        self._heard: frozenset[int] | None = None
        # Reentrant, for a signal handler may send in the middle of the same thread's send.
        self._lock = RLock()
        self._file: int | None = _join(self._path)
        self._position = os.fstat(self._file).st_size
        self._block = b""
        self._at = 0
        self._suspect = -1
        self._empty_looks = 0
        self._is_removed = False
        super().__init__(channel=name)

    def now_s(self) -> float | None:
        """Return the monotonic clock in s, which all processes of a machine share; never None."""
        return time.monotonic()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Deliver only frames with these standard identifiers, and error frames."""
        self._heard = frame_ids

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Return the oldest frame, or None after `timeout` seconds. Raises can.CanOperationError if the bus is lost."""
        return self._next() if timeout == 0 else super().recv(timeout)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Append a frame; `timeout` (s) is unused.

        Raises can.CanOperationError if the bus is lost, ValueError for a frame that is not classic CAN.
        """
        record = pack_bus_frame(msg) + _STAMP_AND_SENDER.pack(time.monotonic(), self._sender)
        record += _CHECKSUM.pack(zlib.crc32(record))
        with self._lock:  # no other thread closes the file meanwhile
            file = self._opened()
            try:
                if os.write(file, record) != _RECORD_BYTES:
                    raise can.CanOperationError(f"{self._path}: no room")
                end = os.lseek(file, 0, os.SEEK_CUR)
                if end % _GIVE_BACK_BYTES < _RECORD_BYTES:
                    _give_back(file, end - _KEPT_BYTES)
            except OSError as error:
                raise can.CanOperationError(f"{self._path}: {error.strerror}", error.errno) from error

    def shutdown(self) -> None:
        """Leave the bus; may be called twice."""
        super().shutdown()
        with self._lock:
            file, self._file = self._file, None
            if file is not None:
                os.close(file)
                _remove_unused(self._path.parent)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        """Wait up to `timeout` seconds for python-can's tools, by polling."""
        until_s = None if timeout is None else time.monotonic() + timeout
        while True:
            frame = self._next()
            if frame is not None or (until_s is not None and time.monotonic() >= until_s):
                return frame, False
            time.sleep(_POLL_S)

    def _opened(self) -> int:
        if self._file is None:
            raise can.CanOperationError("is shut down")
        return self._file

    def _next(self) -> can.Message | None:
        passed_over = 0
        while passed_over < _PASSED_AT_ONCE:
            at = self._at
            if at == len(self._block):
                if not self._read_on():
                    return None
                at = 0
            flagged_id, length, payload, stamp_s, sender, checksum = _RECORD.unpack_from(self._block, at)
            if checksum != zlib.crc32(self._block[at : at + _CHECKED_BYTES]):
                if not self._pass_over(self._block[at : at + _RECORD_BYTES]):
                    return None
                continue
            self._at = at + _RECORD_BYTES
            self._position += _RECORD_BYTES
            if sender != self._sender:
                frame = frame_of(flagged_id, length, payload)
                if is_heard(frame, self._heard):
                    frame.timestamp = stamp_s
                    frame.channel = self.channel
                    return frame
            passed_over += 1
        return None

    def _read_on(self) -> bool:
        """Read the following records; return False if there are none."""
        file = self._opened()
        block = os.pread(file, _BLOCK_BYTES, self._position)
        self._block = block[: len(block) // _RECORD_BYTES * _RECORD_BYTES]
        self._at = 0
        if self._block:
            return True
        self._empty_looks += 1
        if self._empty_looks % _LOOK_EVERY == 0:
            self._is_removed = os.fstat(file).st_nlink == 0
        if self._is_removed:
            raise can.CanOperationError(f"{self._path} was removed; others meet at a new one")
        return False

    def _pass_over(self, record: bytes) -> bool:
        """Skip a record that is no frame; return False if it may still become one."""
        file = self._opened()
        self._block, self._at = b"", 0
        if record == _HOLE:
            with self._lock:  # a write that looks for its own end must not find this one
                try:
                    data = os.lseek(file, self._position, os.SEEK_DATA)
                except OSError:  # nothing but the hole
                    data = os.fstat(file).st_size
            if data > self._position:
                self.overruns += (data - self._position) // _RECORD_BYTES
                self._position = data
                return True
        if record != _HEAD:  # which two who came first may both have written
            if self._suspect != self._position:  # memory that another core has just written: look again
                self._suspect = self._position
                return False
            self.damaged += 1
        self._position += _RECORD_BYTES
        return True


def shared_bus_names() -> list[str]:
    """Return the names of this user's buses, sorted; a bus of killed processes may be among them."""
    try:
        return sorted(path.name for path in _folder().iterdir() if _NAME.fullmatch(path.name))
    except FileNotFoundError:  # no program has opened one yet
        return []


def _folder() -> Path:
    return SHARED_MEMORY / f"kurt2rt-can-{os.geteuid()}"


def _join(path: Path) -> int:
    """Open or create the file of a bus, with a shared lock that marks it as in use."""
    with contextlib.suppress(FileExistsError):
        path.parent.mkdir(mode=0o700)
    folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        _require(folder, path.parent, is_folder=True)
        for _ in range(_OPENING_TRIES):
            flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_CLOEXEC | os.O_NONBLOCK
            file = os.open(path.name, flags, 0o600, dir_fd=folder)
            try:
                _require(file, path, is_folder=False)
                fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
                if os.fstat(file).st_nlink:
                    _require_head(file, path)
                    return file
            except BlockingIOError:
                time.sleep(_POLL_S)  # the last process is about to remove it
            except BaseException:
                os.close(file)
                raise
            os.close(file)
    finally:
        os.close(folder)
    raise can.CanInitializationError(f"{path} is being removed; try again")


def _require(opened: int, path: Path, *, is_folder: bool) -> None:
    """Check that no other user may read or write here. Raises OSError."""
    status = os.fstat(opened)
    right_kind = stat.S_ISDIR(status.st_mode) if is_folder else stat.S_ISREG(status.st_mode)
    if not right_kind or status.st_uid != os.geteuid() or status.st_mode & 0o077:
        raise can.CanInitializationError(f"{path} is not a {'folder' if is_folder else 'file'} of this user alone")


def _require_head(file: int, path: Path) -> None:
    size = os.fstat(file).st_size
    if size == 0:
        os.write(file, _HEAD * (_HEAD_BYTES // _RECORD_BYTES))
    if size % _RECORD_BYTES or os.pread(file, _RECORD_BYTES, 0) != _HEAD:
        raise can.CanInitializationError(f"{path} is not a bus of this version; remove it when no program uses it")


def _remove_unused(folder: Path) -> None:
    """Remove the files of all buses without a process, also those of killed processes."""
    for path in folder.iterdir():
        # In use by a process, or opened meanwhile, or not a bus.
        with contextlib.suppress(OSError):
            file = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC | os.O_NONBLOCK)
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if os.pread(file, _RECORD_BYTES, 0) == _HEAD and path.stat().st_ino == os.fstat(file).st_ino:
                    path.unlink()
            finally:
                os.close(file)


def _give_back(file: int, until: int) -> None:
    """Free the memory of all records before `until`, also those that another writer failed to free."""
    until = until // mmap.ALLOCATIONGRANULARITY * mmap.ALLOCATIONGRANULARITY
    if until <= _HEAD_BYTES:
        return
    begin = os.lseek(file, _HEAD_BYTES, os.SEEK_DATA)  # memory has holes of whole pages only
    if begin < until:
        with mmap.mmap(file, until - begin, offset=begin) as old:
            old.madvise(mmap.MADV_REMOVE)
