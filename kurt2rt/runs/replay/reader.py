"""Reads a recorded run from its files."""

import json
from collections import deque
from collections.abc import Iterator, Sequence
from pathlib import Path

from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_folder import segments_in
from kurt2rt.runs.recording.run_head import RUN_METADATA, decode_head
from kurt2rt.runs.recording.segment_reader import TICK_TOPIC, SegmentHead, SegmentReader
from kurt2rt.runs.recording.tick_json import decode_tick
from kurt2rt.runs.replay.run import Run

_LESSON_TOPIC = "/lesson"


def read_run(path: Path, *, partial: bool = False) -> Run:
    """The run in a folder, or of which `path` is a segment. Raises RecordingError in a sentence.

    `partial`: to look at what there is; a run whose beginning is gone will do, which cannot be replayed.
    """
    try:
        segments = segments_in(path) if path.is_dir() else _segments_of_run(path)
    except OSError as error:
        raise RecordingError(f"cannot be read ({error})", where=path, do="give the folder of a recorded run") from error
    if not segments:
        raise RecordingError("holds no recorded run", where=path, do="give a folder with files such as 0001.mcap")
    files = _Files([SegmentReader(each) for each in segments])
    head = files.head(partial=partial)
    if RUN_METADATA not in head.metadata:
        raise RecordingError("says of no run of kurt2rt, or is torn at its very beginning", where=segments[0])
    return Run(
        str(path),
        decode_head(head.metadata[RUN_METADATA]),
        head.attachments,
        files.ticks,
        files.truncated,
        files.ends_s,
        files.without_gap,
        partial=partial,
        stamps=files.stamps,
    )


class _Files:
    """Segments of one run, one after the other."""

    def __init__(self, readers: Sequence[SegmentReader]) -> None:
        self.readers = readers

    def head(self, *, partial: bool) -> SegmentHead:
        """That of the first segment; `partial`: of the first one that has kept it."""
        heads = (reader.head() for reader in self.readers)
        first = next(heads)
        if partial and RUN_METADATA not in first.metadata:
            return next((head for head in heads if RUN_METADATA in head.metadata), first)
        return first

    def ticks(self) -> Iterator[TickEntry]:
        for reader in self.readers:
            for message in reader.messages({TICK_TOPIC}):
                yield decode_tick(message.data)

    def stamps(self) -> Iterator[tuple[str, str]]:
        """Command ids of lessons that became durable, and when. Leaves alone what `truncated` says of the ticks."""
        for reader in self.readers:
            for message in SegmentReader(reader.path).messages({_LESSON_TOPIC}):
                try:
                    content = json.loads(message.data)
                    if "acknowledged" in content and "stamped_at" in content:
                        yield str(content["acknowledged"]), str(content["stamped_at"])
                except (ValueError, TypeError, RecursionError) as error:
                    raise RecordingError(
                        f"not a lesson of a run: {error}", where=reader.path, do="get it again"
                    ) from error

    def ends_s(self) -> float:
        """Time of the last tick that can be read; 0 where there is none."""
        for reader in reversed(self.readers):
            newest = deque(reader.messages({TICK_TOPIC}), maxlen=1)
            if newest:
                return decode_tick(newest[0].data).now_s
        return 0.0

    def without_gap(self) -> bool:
        """Whether as many ticks are there as the last of them has for a number; looks into no other."""
        messages = (message for reader in self.readers for message in reader.messages({TICK_TOPIC}))
        newest = deque(enumerate(messages, start=1), maxlen=1)
        return any(decode_tick(message.data).number == count for count, message in newest)

    def truncated(self) -> str:
        """What the last that was torn says; a tick that went missing between two is told as a gap."""
        return next((reader.truncated for reader in reversed(self.readers) if reader.truncated), "")


def _segments_of_run(segment: Path) -> list[Path]:
    """All segments of the run that this one belongs to; a file of another name stands alone."""
    siblings = segments_in(segment.parent)
    return siblings if segment in siblings else [segment]
