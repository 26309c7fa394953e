"""One file of a run's recording: MCAP, written so that a power cut leaves every whole chunk readable."""

import os
from pathlib import Path

from foxglove import Context, open_mcap
from foxglove.mcap import MCAPCompression, MCAPWriteOptions

from kurt2rt.runs.recording.disk import Disk, WritableFile

PROFILE = "kurt2rt"
KEPT_BYTES = 4_000_000
"""That wait for a disk which fails, some minutes of a run; then the segment is given up."""
_MEDIA_TYPES = {".json": "application/json", ".jsonl": "application/jsonl", ".yaml": "application/yaml"}


class MemoryFile:
    """What the SDK writes to: bytes in memory, appended only. Never fails, so a failing disk cannot confuse the SDK."""

    def __init__(self) -> None:
        self._bytes = bytearray()
        self._length = 0

    def write(self, data: bytes | bytearray) -> int:
        """Append."""
        self._bytes += data
        self._length += len(data)
        return len(data)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Where the end is; the SDK is told not to go elsewhere."""
        here = offset if whence == os.SEEK_SET else self._length + offset
        if here != self._length:
            raise OSError(f"a recording is only appended to, not written at {here} of {self._length}")
        return here

    def flush(self) -> None:
        """Nothing: the segment writes when it wants to."""

    def pop_all(self) -> bytearray:
        """What came since the last call."""
        taken, self._bytes = self._bytes, bytearray()
        return taken


class Segment:
    """Records all that is logged in a context, from now on, to a new file.

    What came since the last `save` that succeeded is kept in memory and written anew by the next one: a failed write,
    or a failed fsync after which nobody knows what the disk has, costs nothing but time.
    """

    def __init__(self, path: Path, context: Context, disk: Disk) -> None:
        """Make the file. Raises OSError; FileExistsError where it is there already."""
        self.path = path
        self._file: WritableFile = disk.create(path)
        self._buffer = MemoryFile()
        self._unsaved = bytearray()
        self._saved_bytes = 0
        try:
            self._writer = open_mcap(
                self._buffer,
                context=context,
                writer_options=MCAPWriteOptions(
                    compression=MCAPCompression.Zstd,
                    # A chunk ends when it is saved; no thread pool of zstd's beside a robot.
                    chunk_size=None,
                    compression_threads=0,
                    disable_seeking=True,
                    profile=PROFILE,
                ),
            )
        except Exception:
            self._file.close()
            raise

    @property
    def size_bytes(self) -> int:
        """Of the file, with what waits to be written."""
        return self._saved_bytes + len(self._unsaved)

    @property
    def is_over_limit(self) -> bool:
        """Whether more waits for a failing disk than is kept."""
        return len(self._unsaved) > KEPT_BYTES

    def describe(self, name: str, metadata: dict[str, str]) -> None:
        """Put a metadata record in."""
        self._writer.write_metadata(name, metadata)

    def attach(self, name: str, data: bytes, time_ns: int) -> None:
        """Put a file in."""
        media_type = _MEDIA_TYPES.get(Path(name).suffix, "application/octet-stream")
        self._writer.attach(log_time=time_ns, create_time=time_ns, name=name, media_type=media_type, data=data)

    def save(self) -> None:
        """End the chunk, and have the disk keep all that came so far. Raises OSError: nothing is lost, try again."""
        self._writer.flush()
        self._write_out()

    def close(self) -> None:
        """Write the index, have the disk keep it, and close. Raises OSError; the file is readable without, too."""
        self._writer.close()
        try:
            self._write_out()
        finally:
            self._file.close()

    def give_up(self) -> None:
        """Close without another word to the disk; what it has kept stays readable. Raises OSError."""
        self._writer.close()
        self._buffer.pop_all()
        self._file.close()

    def _write_out(self) -> None:
        self._unsaved += self._buffer.pop_all()
        if not self._unsaved:
            return
        self._file.write_at(self._saved_bytes, self._unsaved)
        self._file.sync()
        self._saved_bytes += len(self._unsaved)
        self._unsaved.clear()
