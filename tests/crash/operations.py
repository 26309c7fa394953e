"""Operations on files of a disk, in order."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Made:
    """A new, empty file got a name."""

    file: str


@dataclass(frozen=True, slots=True)
class Written:
    """Bytes were given to the kernel."""

    file: str
    at: int
    content: bytes


@dataclass(frozen=True, slots=True)
class Truncated:
    """A file was cut or made longer."""

    file: str
    size: int


@dataclass(frozen=True, slots=True)
class Synced:
    """All that was done to a file before is on the disk."""

    file: str
    folder: bool = False
    """And all names of its folder."""


@dataclass(frozen=True, slots=True)
class SyncFailed:
    """The kernel could not, and takes what it had for done: a later sync does not write it (ext4, XFS, btrfs)."""

    file: str


@dataclass(frozen=True, slots=True)
class Unlinked:
    """A file lost its name."""

    file: str


@dataclass(frozen=True, slots=True)
class FolderSynced:
    """All names are on the disk."""


@dataclass(frozen=True, slots=True)
class Told:
    """Acknowledgement that the lessons up to this number are saved."""

    lessons: int


Operation = Made | Written | Truncated | Synced | SyncFailed | Unlinked | FolderSynced | Told
