"""List in a file, so that a soak's notes do not grow its memory."""

import os
import pickle
import tempfile
from collections.abc import Iterator
from typing import BinaryIO, Generic, TypeVar

_T = TypeVar("_T")


class Spool(Generic[_T]):
    """Append-only list of pickled values in a temporary file without name."""

    def __init__(self) -> None:
        """Open the file. Raises OSError."""
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
        """Append a value that can be pickled. Raises OSError."""
        self._file.seek(0, os.SEEK_END)
        pickle.dump(value, self._file)
        self._length += 1

    def close(self) -> None:
        """Close the file and drop all values."""
        self._file.close()
        self._length = 0
