"""A copy of a file that a power cut tore, or that is still being written, with the index that viewers ask for."""

from pathlib import Path
from typing import BinaryIO

from mcap.records import Attachment, Channel, Header, Message, Metadata, Schema
from mcap.writer import Writer

from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.segment_reader import SegmentReader

TRUNCATED_METADATA = "kurt2rt.torn"
"""Metadata of a copy that does not hold all that was meant to be in the file: why, in a sentence."""


class NothingRecoverableError(RecordingError):
    """A file is none of a run, or nothing of it was written: one that was begun when the power went."""


def recover_segment(source: Path, target: Path) -> str:
    """Copy all that is whole of a run's file to a new one with an index; returns why that is not all, or nothing.

    Every message keeps its bytes and times. Raises RecordingError where `source` cannot be read or `target` is there,
    NothingRecoverableError where there is nothing to copy, OSError where it cannot be written; then no file is left.
    """
    reader = SegmentReader(source)
    try:
        file = target.open("xb")
    except FileExistsError as error:
        raise RecordingError("is there already", where=target, do="give another folder") from error
    try:
        with file:
            _copy(reader, file)
    except BaseException:
        target.unlink()
        raise
    return reader.truncated


def _copy(reader: SegmentReader, file: BinaryIO) -> None:
    writer = Writer(file)
    started = False
    schemas = {0: 0}
    channels: dict[int, int] = {}
    for record in reader.records():
        match record:
            case Header():
                writer.start(record.profile, record.library)
                started = True
            case Schema() if record.id not in schemas:
                schemas[record.id] = writer.register_schema(record.name, record.encoding, record.data)
            case Channel() if record.id not in channels:
                channels[record.id] = writer.register_channel(
                    record.topic, record.message_encoding, schemas[record.schema_id], record.metadata
                )
            case Message():
                writer.add_message(
                    channels[record.channel_id], record.log_time, record.data, record.publish_time, record.sequence
                )
            case Attachment():
                writer.add_attachment(record.create_time, record.log_time, record.name, record.media_type, record.data)
            case Metadata():
                writer.add_metadata(record.name, record.metadata)
    if not started:
        raise NothingRecoverableError("is no file of a run, or nothing of it was written", where=reader.path)
    if reader.truncated:
        writer.add_metadata(TRUNCATED_METADATA, {"why": reader.truncated})
    writer.finish()  # type: ignore[no-untyped-call]
