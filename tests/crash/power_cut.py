"""Possible contents of a disk after a power cut at any moment.

Synced data is there. Of other data any part may be there, in any order, and a write by whole sectors only.
Names come and go in order, as in every file system with a journal.
"""

import hashlib
import itertools
import random
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from tests.crash.operations import FolderSynced, Made, Operation, Synced, SyncFailed, Told, Truncated, Unlinked, Written

SECTOR_BYTES = 512
_ALL_SUBSETS_UP_TO = 6
_SOME_SUBSETS = 48

Change = Written | Truncated
Files = Mapping[str, bytes]


@dataclass(frozen=True, slots=True)
class PowerCut:
    """One state that a power cut may leave."""

    files: Files
    after: int
    """So many operations had been done."""
    told: int
    """Number of lessons that were acknowledged as saved."""

    def put(self, folder: Path) -> None:
        """Make the files of the folder these, and no others."""
        for path in folder.iterdir():
            if path.is_file():
                path.unlink()
        for name, content in self.files.items():
            (folder / name).write_bytes(content)


@dataclass
class _Inode:
    """A file's content: what is on the disk for sure, and what may be, in the order of doing."""

    durable: bytes = b""
    pending: list[Change] = field(default_factory=list)
    doubtful: int = 0
    """So many of the pending changes no sync makes durable any more: one failed, and the kernel forgot them."""

    def sync(self) -> None:
        """Make durable what still can be; what is in doubt stays so where nothing was written over it."""
        doubtful, fresh = self.pending[: self.doubtful], self.pending[self.doubtful :]
        # Sizes are in the file system's own journal, and no page that a kernel could take for written.
        sizes = [change for change in doubtful if isinstance(change, Truncated)]
        self.durable = _changed(self.durable, [*sizes, *fresh])
        for change in fresh:
            doubtful = [rest for each in doubtful if isinstance(each, Written) for rest in _left_of(each, change)]
        self.pending = list(doubtful)
        self.doubtful = len(doubtful)


@dataclass
class Disk:
    """Follows operations, and tells what a power cut would leave."""

    inodes: list[_Inode] = field(default_factory=list)
    names: dict[str, int] = field(default_factory=dict)
    """File names to inodes, as programs see them."""
    durable_names: dict[str, int] = field(default_factory=dict)
    pending_names: list[tuple[str, int | None]] = field(default_factory=list)
    told: int = 0
    done: int = 0

    @classmethod
    def holding(cls, files: Files) -> "Disk":
        """All of it durable."""
        disk = cls()
        for name, content in files.items():
            disk.names[name] = len(disk.inodes)
            disk.inodes.append(_Inode(content))
        disk.durable_names = dict(disk.names)
        return disk

    def do(self, operation: Operation) -> None:
        """Apply the next operation."""
        self.done += 1
        match operation:
            case Made(name):
                self.names[name] = len(self.inodes)
                self.inodes.append(_Inode())
                self.pending_names.append((name, self.names[name]))
            case Unlinked(name):
                self.names.pop(name, None)
                self.pending_names.append((name, None))
            case Written(name) | Truncated(name):
                self._inode(name).pending.append(operation)
            case Synced(name, folder):
                self._inode(name).sync()
                if folder:
                    self._sync_names()
            case SyncFailed(name):
                inode = self._inode(name)
                inode.doubtful = len(inode.pending)
            case FolderSynced():
                self._sync_names()
            case Told(lessons):
                self.told = lessons

    def now(self) -> PowerCut:
        """Return the contents that programs see, which the kernel keeps when a program is killed."""
        return self._state(self.names, {}, len(self.inodes))

    def cuts(self, chance: random.Random) -> Iterator[PowerCut]:
        """Yield the possible contents after a power cut now; some more than once."""
        for count in range(len(self.pending_names) + 1):
            names = _named(self.durable_names, self.pending_names[:count])
            for changes in self._selections(sorted(set(names.values())), chance):
                yield self._state(names, changes, 0)

    def _state(self, names: Mapping[str, int], changes: Mapping[int, list[Change]], all_below: int) -> PowerCut:
        files = {}
        for name, number in names.items():
            inode = self.inodes[number]
            kept = inode.pending if number < all_below else changes.get(number, [])
            files[name] = _changed(inode.durable, kept)
        return PowerCut(files, self.done, self.told)

    def _selections(self, numbers: list[int], chance: random.Random) -> Iterator[dict[int, list[Change]]]:
        """Which changes may have come to the disk, by inode."""
        pending = [(number, change) for number in numbers for change in self.inodes[number].pending]
        for kept in _subsets(len(pending), chance):
            yield _by_inode(pending[index] for index in kept)
        for index, (number, change) in enumerate(pending):
            for torn in _torn(change, chance):
                yield _by_inode([*pending[:index], (number, torn)])
                yield _by_inode([*pending[:index], (number, torn), *pending[index + 1 :]])

    def _inode(self, name: str) -> _Inode:
        return self.inodes[self.names[name]]

    def _sync_names(self) -> None:
        self.durable_names = dict(self.names)
        self.pending_names.clear()


def power_cuts(disk: Disk, operations: Iterable[Operation], seed: int) -> Iterator[PowerCut]:
    """Every state that a power cut may leave before, between and after the operations, each once."""
    chance = random.Random(seed)
    seen: set[bytes] = set()
    for operation in itertools.chain([None], operations):
        if operation is not None:
            disk.do(operation)
        for cut in disk.cuts(chance):
            mark = _mark(cut)
            if mark not in seen:
                seen.add(mark)
                yield cut


def _mark(cut: PowerCut) -> bytes:
    digest = hashlib.blake2b(str(cut.told).encode())
    for name in sorted(cut.files):
        digest.update(f"\0{name}\0{len(cut.files[name])}\0".encode())
        digest.update(cut.files[name])
    return digest.digest()


def _named(names: Mapping[str, int], changes: Iterable[tuple[str, int | None]]) -> dict[str, int]:
    named = dict(names)
    for name, number in changes:
        if number is None:
            named.pop(name, None)
        else:
            named[name] = number
    return named


def _changed(content: bytes, changes: Iterable[Change]) -> bytes:
    data = bytearray(content)
    for change in changes:
        match change:
            case Truncated(_, size):
                data = data[:size].ljust(size, b"\0")
            case Written(_, at, written):
                data = data.ljust(at, b"\0")
                data[at : at + len(written)] = written
    return bytes(data)


def _left_of(doubtful: Written, later: Change) -> Iterator[Written]:
    """Yield the parts of a write that a later change did not touch."""
    begin, end = doubtful.at, doubtful.at + len(doubtful.content)
    match later:
        case Truncated(_, size):
            kept = [(begin, min(end, size))]
        case Written(_, at, content):
            kept = [(begin, min(end, at)), (max(begin, at + len(content)), end)]
    for first, last in kept:
        if first < last:
            yield Written(doubtful.file, first, doubtful.content[first - begin : last - begin])


def _subsets(count: int, chance: random.Random) -> Iterator[list[int]]:
    everything = list(range(count))
    if count <= _ALL_SUBSETS_UP_TO:
        for size in range(count + 1):
            yield from map(list, itertools.combinations(everything, size))
        return
    for length in range(count + 1):
        yield everything[:length]
    for left_out in everything:
        yield [left_out]
        yield [index for index in everything if index != left_out]
    for _ in range(_SOME_SUBSETS):
        yield [index for index in everything if chance.random() < 0.5]


def _torn(change: Change, chance: random.Random) -> Iterator[Written]:
    """Yield torn versions of a write: sectors before a border, after it, or a random choice."""
    if not isinstance(change, Written):
        return
    end = change.at + len(change.content)
    borders = range((change.at // SECTOR_BYTES + 1) * SECTOR_BYTES, end, SECTOR_BYTES)
    for border in borders:
        yield Written(change.file, change.at, change.content[: border - change.at])
    if len(borders) > 1:
        border = chance.choice(borders)
        yield Written(change.file, border, change.content[border - change.at :])


def _by_inode(changes: Iterable[tuple[int, Change]]) -> dict[int, list[Change]]:
    found: dict[int, list[Change]] = {}
    for number, change in changes:
        found.setdefault(number, []).append(change)
    return found
