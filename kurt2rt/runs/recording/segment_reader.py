"""Reads one file of a recorded run, also one that a power cut tore: up to its last whole chunk."""

import struct
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import zstandard
from mcap.exceptions import McapError
from mcap.records import Attachment, Channel, Chunk, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from kurt2rt.runs.recording.recording_error import RecordingError

TICK_TOPIC = "/tick"
"""Topic of the ticks, of which a run is made."""

# What mcap raises over bytes that are none of its own, beside its own errors; a wrong checksum is a ValueError.
_TRUNCATION_ERRORS = (McapError, struct.error, ValueError, zstandard.ZstdError, OverflowError, MemoryError)


LARGEST_CHUNK_BYTES = 16_000_000
"""Largest chunk that is unpacked. kurt2rt ends a chunk each second; the largest stored run has 4 MB in one."""
_ALWAYS_UNPACKED_BYTES, _MOST_TIMES = 1_000_000, 1000
"""A larger chunk than the first unpacks to at most so many times its size; runs of a robot reach 15."""
_COMPRESSIONS = ("", "zstd")


class LoggedMessage(NamedTuple):
    """One message of a recording."""

    topic: str
    time_ns: int
    """Since 1970, by the recording's own even clock."""
    data: bytes
    schema: str
    """Name of its schema."""


@dataclass(frozen=True, slots=True)
class SegmentHead:
    """What stands before the first message of a file."""

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)


class SegmentReader:
    """Reads one file; each call reads it anew from its beginning."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.truncated = ""
        """Where and how the file ends too early, in a sentence; empty while nobody has come to a torn place."""

    def head(self) -> SegmentHead:
        """Metadata and attachments before the first chunk, as far as they are there. Raises RecordingError."""
        head = SegmentHead()
        for record in self.records():
            match record:
                case Metadata():
                    head.metadata[record.name] = dict(record.metadata)
                case Attachment():
                    head.attachments[record.name] = record.data
                case Message():
                    break
        return head

    def messages(self, topics: Collection[str] | None = None) -> Iterator[LoggedMessage]:
        """Messages of these topics, of all where None, in the order of writing. Raises RecordingError.

        Of a chunk all messages are read, or none. Afterwards `truncated` tells whether the file ended as it should.
        """
        schemas: dict[int, str] = {0: ""}
        channels: dict[int, Channel] = {}
        for record in self.records():
            match record:
                case Schema():
                    schemas[record.id] = record.name
                case Channel():
                    channels[record.id] = record
                case Message():
                    channel = channels[record.channel_id]
                    if topics is None or channel.topic in topics:
                        yield LoggedMessage(channel.topic, record.log_time, record.data, schemas[channel.schema_id])

    def records(self) -> Iterator[McapRecord]:
        """All that is whole, from the header on, chunks taken apart; raises and sets `truncated` as `messages` does."""
        self.truncated = ""
        try:
            size = self.path.stat().st_size
            file = self.path.open("rb")
        except OSError as error:
            raise RecordingError(f"cannot be read ({error})", where=self.path, do="give a recorded run") from error
        with file:
            records = _whole_records(StreamReader(file, emit_chunks=True, record_size_limit=size), self.path)
            whole_until = 0
            while True:
                try:
                    several = next(records)
                except StopIteration:  # after the footer
                    return
                except _TRUNCATION_ERRORS:
                    self.truncated = (
                        f"{self.path}: ends without its index; what came after its first {whole_until} bytes was not "
                        "written, or is still to come"
                    )
                    return
                whole_until = file.tell()
                yield from several


def _whole_records(reader: StreamReader, path: Path) -> Iterator[list[McapRecord]]:
    """Yield one record after the other; those of a chunk together, once it has been found whole.

    Raises RecordingError for a chunk that would fill the memory.
    """
    for record in reader.records:
        if isinstance(record, Chunk):
            _require_small(record, path)
            yield breakup_chunk(record, validate_crc=True)
        else:
            yield [record]


def _require_small(chunk: Chunk, path: Path) -> None:
    if chunk.compression not in _COMPRESSIONS:
        raise RecordingError(
            f"a chunk is packed with {chunk.compression[:20]!r}, allowed is zstd", where=path, do="record it again"
        )
    size = chunk.uncompressed_size
    if chunk.compression:  # zstd takes as much memory as its own header says, whatever the chunk's header says
        packed = zstandard.get_frame_parameters(chunk.data).content_size
        size = size if packed == zstandard.CONTENTSIZE_UNKNOWN else max(size, packed)
    allowed = max(_ALWAYS_UNPACKED_BYTES, min(LARGEST_CHUNK_BYTES, _MOST_TIMES * len(chunk.data)))
    if size > allowed:
        raise RecordingError(
            f"a chunk of {len(chunk.data)} bytes unpacks to {size}, allowed are {allowed}",
            where=path,
            do="nothing of it was read: get the recording again, from a source that you trust",
        )
