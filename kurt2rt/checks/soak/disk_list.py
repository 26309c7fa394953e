"""A list on the disk: what a soak notes minute by minute must not be what its memory grows by."""

import os
import pickle
import tempfile
from collections.abc import Iterator
from typing import BinaryIO, Generic, TypeVar

_T = TypeVar("_T")


class Spool(Generic[_T]):
    """Only appended to, and read from its beginning; in a nameless file that goes with the program."""

    def __init__(self) -> None:
        """Raises OSError."""
        # At once: a file that is opened with the first note would count as one more than at the beginning.
        self._file: BinaryIO = tempfile.TemporaryFile()  # noqa: SIM115  # until `close`
        self._length = 0

    def __len__(self) -> int:
        return self._length

    def __iter__(self) -> Iterator[_T]:
        if self._length:
            self._file.seek(0)
        for _ in range(self._length):
            yield pickle.load(self._file)

    def append(self, value: _T) -> None:
        """Add one that can be pickled. Raises OSError."""
        self._file.seek(0, os.SEEK_END)
        pickle.dump(value, self._file)
        self._length += 1

    def close(self) -> None:
        """Give the file back, with all that was noted."""
        self._file.close()
        self._length = 0
