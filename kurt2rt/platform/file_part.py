"""Part of a file, as read and as sent over the channel."""

import os
from pathlib import Path
from typing import NamedTuple


class FilePart(NamedTuple):
    """Part of a file as `/file` answers with it, and the size of the whole file."""

    size_bytes: int
    """Size of the whole file."""
    content: bytes
    """Empty from the end of the file on."""


def read_part(path: Path, offset: int, most_bytes: int) -> FilePart:
    """Return up to `most_bytes` of a file from `offset` on. Raises OSError."""
    with path.open("rb") as file:
        size_bytes = os.fstat(file.fileno()).st_size
        return FilePart(size_bytes, os.pread(file.fileno(), most_bytes, min(offset, size_bytes)))
