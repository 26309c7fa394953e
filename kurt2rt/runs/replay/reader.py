"""Reader of a recorded run from its segments."""

import json
from collections import deque
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_folder import TICK_TOPIC, segment_reader, segments_in
from kurt2rt.runs.recording.run_head import RUN_METADATA, decode_head
from kurt2rt.runs.recording.tick_json import decode_tick
from kurt2rt.runs.replay.run import Run, RunSource

if TYPE_CHECKING:
    from kurt2rt.runs.recording.segment_reader import SegmentHead, SegmentReader

_LESSON_TOPIC = "/lesson"


def read_run(path: Path, *, partial: bool = False) -> Run:
    """Return the run in a folder, or the run of a segment.

    `partial`: accept a run whose beginning was deleted; it cannot be replayed. Raises RecordingError, and
    ModuleNotFoundError without the extra `recording`.
    """
    reader = segment_reader()
    try:
        segments = segments_in(path) if path.is_dir() else _segments_of_run(path)
    except OSError as error:
        raise RecordingError(f"cannot be read ({error})", where=path, do="give the folder of a recorded run") from error
    if not segments:
        raise RecordingError("holds no recorded run", where=path, do="give a folder with files such as 0001.mcap")
    files = _Files([reader(each) for each in segments])
    head = files.head(partial=partial)
    if RUN_METADATA not in head.metadata:
        raise RecordingError("says of no run of kurt2rt, or is torn at its very beginning", where=segments[0])
    source = RunSource(files.ticks, files.truncated, files.ends_s, files.without_gap, files.stamps)
    return Run(str(path), decode_head(head.metadata[RUN_METADATA]), head.attachments, source, partial=partial)


class _Files:
    """Segments of one run in order."""

    def __init__(self, readers: "Sequence[SegmentReader]") -> None:
        self.readers = readers

    def head(self, *, partial: bool) -> "SegmentHead":
        """Return the head of the first segment; with `partial`, the first head that was kept."""
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
        """Yield the command ids of durable lessons with their times. Leaves `truncated` unchanged."""
        for reader in self.readers:
            for message in type(reader)(reader.path).messages({_LESSON_TOPIC}):
                try:
                    content = json.loads(message.data)
                    if "acknowledged" in content and "stamped_at" in content:
                        yield str(content["acknowledged"]), str(content["stamped_at"])
                except (ValueError, TypeError, RecursionError) as error:
                    raise RecordingError(
                        f"not a lesson of a run: {error}", where=reader.path, do="get it again"
                    ) from error

    def ends_s(self) -> float:
        """Return the time of the last readable tick; 0 without one."""
        for reader in reversed(self.readers):
            newest = deque(reader.messages({TICK_TOPIC}), maxlen=1)
            if newest:
                return decode_tick(newest[0].data).now_s
        return 0.0

    def without_gap(self) -> bool:
        """Return whether the number of ticks equals the number of the last; decodes only that tick."""
        messages = (message for reader in self.readers for message in reader.messages({TICK_TOPIC}))
        newest = deque(enumerate(messages, start=1), maxlen=1)
        return any(decode_tick(message.data).number == count for count, message in newest)

    def truncated(self) -> str:
        """Return the sentence of the last truncated segment; ticks missing between two show as a gap."""
        return next((reader.truncated for reader in reversed(self.readers) if reader.truncated), "")


def _segments_of_run(segment: Path) -> list[Path]:
    """Return all segments of the run of this segment; a file of another name stands alone."""
    siblings = segments_in(segment.parent)
    return siblings if segment in siblings else [segment]
