"""Reader of one segment of a run; a truncated file is read up to its last complete chunk."""

import struct
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, get_chunk_data_stream

from kurt2rt.runs.recording.recording_error import RecordingError

# Errors that mcap raises on foreign bytes in addition to its own; a wrong checksum is a ValueError.
_TRUNCATION_ERRORS = (McapError, struct.error, ValueError, zstandard.ZstdError, OverflowError, MemoryError)


LARGEST_CHUNK_BYTES = 16_000_000
"""Largest chunk that is decompressed; kurt2rt ends one each second, at most 4 MB in stored runs."""
_ALWAYS_UNPACKED_BYTES, _MOST_TIMES = 1_000_000, 1000
"""A larger chunk than the first unpacks to at most so many times its size; runs of a robot reach 15."""
_COMPRESSIONS = ("", "zstd")

_RECORD_HEAD = struct.Struct("<BQ")
"""Opcode and length in bytes of the content, before each record in a chunk."""
_MESSAGE_HEAD = struct.Struct("<HIQQ")
"""Channel id, sequence number, log time and publish time in ns, at the beginning of a message's content."""


class LoggedMessage(NamedTuple):
    """Message of a segment file, not decoded, with its topic, time and schema."""

    topic: str
    time_ns: int
    """Time since 1970 by the recording's monotonic clock."""
    data: bytes
    schema: str
    """Name of its schema."""


@dataclass(frozen=True, slots=True)
class SegmentHead:
    """Head of a segment file: metadata of the run, and attached settings and knowledge."""

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)


class SegmentReader:
    """Reader of one segment file, also of a truncated one; each call starts at its beginning."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.truncated = ""
        """Place and reason of a premature end, in a sentence; empty until one was reached."""

    def head(self) -> SegmentHead:
        """Return metadata and attachments before the first chunk, as far as present. Raises RecordingError."""
        head = SegmentHead()
        for record in self._records(unpack=False):
            match record:
                case Metadata():
                    head.metadata[record.name] = dict(record.metadata)
                case Attachment():
                    head.attachments[record.name] = record.data
                case Chunk() | Message():
                    break
        return head

    def messages(self, topics: Collection[str] | None = None) -> Iterator[LoggedMessage]:
        """Yield messages of these topics, or of all, in the order of writing. Raises RecordingError.

        All messages of a chunk are read, or none. Afterwards `truncated` tells whether the end is missing.
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
        """Yield all complete records from the header on, with chunks unpacked.

        Afterwards `truncated` says where a file ends whose end is missing; empty for a whole file. Raises
        RecordingError if the file cannot be read.
        """
        return self._records(unpack=True)

    def _records(self, *, unpack: bool) -> Iterator[McapRecord]:
        """Yield all complete records, each chunk as it stands unless `unpack`."""
        self.truncated = ""
        try:
            size = self.path.stat().st_size
            file = self.path.open("rb")
        except OSError as error:
            raise RecordingError(f"cannot be read ({error})", where=self.path, do="give a recorded run") from error
        with file:
            reader = StreamReader(file, emit_chunks=True, record_size_limit=size)
            records = _whole_records(reader, self.path, unpack=unpack)
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


def _whole_records(reader: StreamReader, path: Path, *, unpack: bool) -> Iterator[list[McapRecord]]:
    """Yield one record at a time; with `unpack`, the records of a chunk together after its CRC matched.

    Raises RecordingError for a chunk that would fill the memory.
    """
    for record in reader.records:
        if isinstance(record, Chunk):
            _require_small(record, path)
            yield _records_in(record) if unpack else [record]
        else:
            yield [record]


def _records_in(chunk: Chunk) -> list[McapRecord]:
    """Return the records of a chunk; raise ValueError for a wrong checksum, EndOfFile for a record without its end.

    mcap's own breakup_chunk reads each number of a record by three calls, which took a seventh of the time of `why`.
    """
    stream, size = get_chunk_data_stream(chunk, validate_crc=True)
    data = stream.read(size)
    records: list[McapRecord] = []
    start = 0
    while start < size:
        opcode, length = _RECORD_HEAD.unpack_from(data, start)
        start += _RECORD_HEAD.size
        end = start + length
        if end > size:
            raise EndOfFile
        if opcode == Opcode.MESSAGE:
            channel_id, sequence, log_time, publish_time = _MESSAGE_HEAD.unpack_from(data, start)
            content = data[start + _MESSAGE_HEAD.size : end]
            records.append(Message(channel_id, log_time, content, publish_time, sequence))
        elif opcode == Opcode.CHANNEL:
            records.append(Channel.read(ReadDataStream(BytesIO(data[start:end]))))
        elif opcode == Opcode.SCHEMA:
            records.append(Schema.read(ReadDataStream(BytesIO(data[start:end]))))
        start = end
    return records


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
