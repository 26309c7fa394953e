"""Recovery of a truncated or growing segment: a copy with the index that viewers require."""

from pathlib import Path
from typing import BinaryIO

from mcap.records import Attachment, Channel, Header, Message, Metadata, Schema
from mcap.writer import Writer

from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.segment_reader import SegmentReader

TRUNCATED_METADATA = "kurt2rt.torn"
"""Metadata record of an incomplete copy, with the reason in a sentence."""


class NothingRecoverableError(RecordingError):
    """File without a run's data: another kind of file, or one begun just before a power cut."""


def recover_segment(source: Path, target: Path) -> str:
    """Copy the readable part of a segment to a new file with an index; return why it is incomplete, or "".

    Every message keeps its bytes and times. Raises RecordingError if `source` cannot be read or `target` exists,
    NothingRecoverableError if nothing can be copied, OSError if writing fails; no file is left then.
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
        raise NothingRecoverableError("is not the file of a run, or nothing of it was written", where=reader.path)
    if reader.truncated:
        writer.add_metadata(TRUNCATED_METADATA, {"why": reader.truncated})
    writer.finish()  # type: ignore[no-untyped-call]
