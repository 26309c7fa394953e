"""Segment of a recording: an MCAP file whose complete chunks survive a power cut."""

import os
from pathlib import Path

from foxglove import Context, open_mcap
from foxglove.mcap import MCAPCompression, MCAPWriteOptions

from kurt2rt.runs.recording.recording_disk import Disk, WritableFile

PROFILE = "kurt2rt"
KEPT_BYTES = 4_000_000
"""Most bytes that wait for a failing disk, some minutes of a run; then the segment is given up."""
_MEDIA_TYPES = {".json": "application/json", ".jsonl": "application/jsonl", ".yaml": "application/yaml"}


class MemoryFile:
    """Append-only buffer for the SDK of MCAP, which `Segment` writes to the disk.

    It never fails, so the SDK sees no disk errors.
    """

    def __init__(self) -> None:
        self._bytes = bytearray()
        self._length = 0

    def write(self, data: bytes | bytearray) -> int:
        """Append the data; return its length in bytes."""
        self._bytes += data
        self._length += len(data)
        return len(data)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Return the end position. Raises OSError for any other one."""
        here = offset if whence == os.SEEK_SET else self._length + offset
        if here != self._length:
            raise OSError(f"a recording is only appended to, not written at {here} of {self._length}")
        return here

    def flush(self) -> None:
        """Do nothing: the segment decides when it writes."""

    def pop_all(self) -> bytearray:
        """Return the bytes that were written since the last call, and drop them."""
        taken, self._bytes = self._bytes, bytearray()
        return taken


class Segment:
    """File of a recording that is being written: it gets all that is logged in a context from now on.

    Data since the last successful `save` stays in memory and is written again by the next one. A failed write or fsync,
    which leaves the disk's content undefined, thus loses nothing.
    """

    def __init__(self, path: Path, context: Context, disk: Disk) -> None:
        """Create the file. Raises OSError; FileExistsError if it exists."""
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
                    # `save` ends each chunk; zstd's thread pool would compete with the control loop.
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
        """Size of the file in bytes, unwritten data included."""
        return self._saved_bytes + len(self._unsaved)

    @property
    def is_over_limit(self) -> bool:
        """Return whether more than KEPT_BYTES wait for a failing disk."""
        return len(self._unsaved) > KEPT_BYTES

    def describe(self, name: str, metadata: dict[str, str]) -> None:
        """Add a metadata record to the file: texts by name."""
        self._writer.write_metadata(name, metadata)

    def attach(self, name: str, data: bytes, time_ns: int) -> None:
        """Add an attachment to the file; `time_ns` in ns since 1970."""
        media_type = _MEDIA_TYPES.get(Path(name).suffix, "application/octet-stream")
        self._writer.attach(log_time=time_ns, create_time=time_ns, name=name, media_type=media_type, data=data)

    def save(self) -> None:
        """End the present chunk and sync the file to the disk. Raises OSError; nothing is lost, so try again."""
        self._writer.flush()
        self._write_out()

    def close(self) -> None:
        """Write the index, sync and close. Raises OSError; the file is readable without the index."""
        self._writer.close()
        try:
            self._write_out()
        finally:
            self._file.close()

    def give_up(self) -> None:
        """Close without writing; synced data stays readable. Raises OSError."""
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
