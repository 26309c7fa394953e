"""The run recorder: all that a run sees, decides and is taught, written beside the loop and never at its cost."""

import time
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from foxglove import Context

from hal.robot_settings import RobotSettings
from hal.simulation import SimulatedWorld
from kurt2rt.core.tick import TickRecord
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.platform.yield_gil import yield_gil
from kurt2rt.runs.recording.disk import Disk
from kurt2rt.runs.recording.live_view import LiveView
from kurt2rt.runs.recording.notes import HealthNote, Note, NoteLog, QuestionNote, TickNote
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_files import Budget, RunFiles
from kurt2rt.runs.recording.run_head import RUN_METADATA, RunHead, encode_head
from kurt2rt.runs.recording.topics import Topics
from kurt2rt.runs.recording.writer_thread import WriterThread

CAPACITY = 3000
"""Notes that wait for the disk: half a minute of ticks, some 20 MB."""
SEGMENT_METADATA = "segment"
"""Name of what tells each segment's number, beside the head of the run."""
_ROUNDS_PER_SECOND = 10
_PLACE_EVERY_TICKS = 5
_WORLD_EVERY_TICKS = 100
_NS_PER_S = 1_000_000_000


class RunRecorder:
    """Takes notes between two ticks, and writes them in a thread of its own, ten times a second.

    A note takes some microseconds, never waits and never raises. Notes that find no room, and those that a disk loses
    that fails for long, are counted; a replay can go up to the first of them. Everything that is once told to be there
    survives a power cut: once a second the disk is made to keep it.
    """

    def __init__(
        self,
        files: RunFiles | None,
        kept: NoteLog | None,
        live: LiveView | None,
        shown: NoteLog | None,
        *,
        ground: SimulatedWorld | None = None,
        began_at_ns: int | None = None,
        capacity: int = CAPACITY,
    ) -> None:
        """`kept` goes to `files`, `shown` to those who look on: each None where there is none.

        `began_at_ns`: time since 1970 of the runtime's clock at 0; None: measured at the first tick.
        """
        self._files, self._kept = files, kept
        self._live, self._shown = live, shown
        self._ground = ground
        self._thread = WriterThread[Note]("run recorder", capacity, self._run)
        self._held: deque[Note] = deque()
        """Was shown already, and waits for a file."""
        self._began_at_ns = began_at_ns
        # Of the thread, and of who closes when it hangs: counted apart from what found no room, for two threads count.
        self._not_written = self._left_behind = 0
        self._failure = ""
        self._unsaved = self._ticks = 0
        self.written = 0
        """Ticks that the disk has."""

    @property
    def run(self) -> Path | None:
        """The folder that is written; None where there is none, or not yet."""
        return None if self._files is None else self._files.run

    @property
    def dropped(self) -> int:
        """Notes that are not in the files: the disk was too slow, or failed."""
        return self._thread.overruns + self._left_behind + self._not_written

    @property
    def trouble(self) -> str:
        """What is wrong, in a line for the user; empty while everything is kept."""
        wrong = [self._failure] if self._failure else []
        if self._files is not None and self._files.trouble:
            wrong.append(self._files.trouble)
        if self._live is not None and self._live.trouble:
            wrong.append(self._live.trouble)
        if self.dropped:
            wrong.append(f"{self.dropped} of its ticks and notes lost")
        return f"recording: {', '.join(wrong)}" if wrong else ""

    def on_tick(self, record: TickRecord, *, saved: bool = False) -> None:
        """A tick has been. `saved`: statistics were saved after it."""
        if self._began_at_ns is None:
            # The wall clock may be set meanwhile; the stamps go on evenly.
            self._began_at_ns = time.time_ns() - round(record.now_s * _NS_PER_S)
        truth = world = None
        if self._ground is not None and self._ticks % _PLACE_EVERY_TICKS == 0:
            truth = self._ground.place()
            if self._ticks % _WORLD_EVERY_TICKS == 0:
                world = self._ground.world()
        self._ticks += 1
        time_ns = self._began_at_ns + round(record.now_s * _NS_PER_S)
        self._note(TickNote(record, time_ns, saved, truth, world))

    def on_acknowledged(self, acknowledgement: Acknowledgement) -> None:
        """A lesson is durable, or never will be."""
        self._note(acknowledgement)

    def on_question(self, question: object) -> None:
        """The robot begins to ask; `str` of it is the question."""
        self._note(QuestionNote(question))

    def on_health(self, report: Mapping[str, Any]) -> None:
        """Take a health report in plain values; it must not change any more."""
        self._note(HealthNote(report))

    def take(self, budget: Budget) -> None:
        """Keep to this budget from now on."""
        if self._files is not None:
            self._files.take(budget)

    def start(self) -> None:
        """Begin to write; once only. Without, whoever records calls `write_waiting` and `poll`."""
        self._thread.start()

    def write_waiting(self) -> None:
        """Show all that waits, and log it to a file; while there is none, it goes on waiting."""
        for note in yield_gil(self._thread.pop_all()):
            if self._shown is not None and self._live is not None and self._live.is_open:
                self._log(self._shown, note)
            if self._files is not None:
                self._held.append(note)
        if self._kept is None or self._files is None or not self._files.is_open:
            return
        for note in yield_gil(self._held.popleft() for _ in range(len(self._held))):
            if not self._log(self._kept, note):
                self._not_written += 1
            elif isinstance(note, TickNote):
                self._unsaved += 1

    def poll(self) -> None:
        """Once a second: have the disk keep what was logged, and go on in another file where that is due."""
        self._poll_live()
        self._poll_files()

    def close(self, patience_s: float = 2.0) -> None:
        """Write the rest and end the files; gives a disk that hangs up after a while. `trouble` tells what came."""
        if not self._thread.started:
            self._end()
        elif not self._thread.stop(patience_s):
            self._failure = "the disk does not answer; the end is missing"
            self._left_behind += len(self._thread) + len(self._held) + self._unsaved

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _note(self, note: Note) -> None:
        self._thread.submit(note, held=len(self._held))

    def _log(self, log: NoteLog, note: Note) -> bool:
        """Whether it could be logged."""
        try:
            log.log(note)
        except Exception as error:  # noqa: BLE001  # of whatever kind: it is told, and all other notes are kept
            reason = str(error) if isinstance(error, RecordingError) else f"{error!r}; please report this"
            self._failure = f"a note cannot be written: {reason}"
            return False
        return True

    def _poll_live(self) -> None:
        if self._live is not None:
            self._live.poll()

    def _poll_files(self) -> None:
        files = self._files
        if files is None or self._kept is None:
            return
        took, given_up, folders = files.is_open, files.given_up, files.folders
        kept = files.poll()
        if files.given_up > given_up:
            self._not_written += self._unsaved
            self._unsaved = 0
        elif kept:
            self._mark_saved()
        if files.folders > max(folders, 1):  # somebody has deleted all that was written
            self._not_written += self.written
            self.written = 0
        if files.is_open and (not took or files.given_up > given_up):
            self._kept.topics.repeat_periodic()

    def _mark_saved(self) -> None:
        self.written += self._unsaved
        self._unsaved = 0

    def _run(self) -> None:
        rounds = rounds_of_files = 0
        ended = False
        try:
            while not ended:
                if rounds % _ROUNDS_PER_SECOND == 0:
                    self._safely(self._poll_live)
                # Not before the first tick: a start that fails leaves no run.
                if self._ticks:
                    if rounds_of_files % _ROUNDS_PER_SECOND == 0:
                        self._safely(self._poll_files)
                    rounds_of_files += 1
                ended = self._thread.wait_period()
                self._safely(self.write_waiting)
                rounds += 1
        finally:
            self._safely(self._end)

    def _safely(self, part: Callable[[], None]) -> None:
        try:
            part()
        except Exception as error:  # noqa: BLE001  # of whatever kind: it is told, tried again, and the robot goes on
            self._failure = f"its thread failed with {error!r}; please report this"

    def _end(self) -> None:
        self.write_waiting()
        try:
            if self._files is not None and (self._ticks or self._files.run is not None):
                self._poll_files()
                self.write_waiting()
                if self._files.close():
                    self._mark_saved()
        finally:
            if self._ticks:
                self._not_written += len(self._thread) + len(self._held) + self._unsaved
            self._held.clear()
            self._unsaved = 0
            if self._live is not None:
                self._live.close()


def open_run_recorder(
    recordings: Path | None,
    head: RunHead,
    attachments: Mapping[str, bytes],
    budget: Budget,
    settings: RobotSettings,
    features: tuple[str, ...],
    *,
    name: str,
    live: tuple[str, int] | None = None,
    opened: Callable[[LiveView], None] = lambda _: None,
    ground: SimulatedWorld | None = None,
    began_at_ns: int | None = None,
    disk: Disk | None = None,
    capacity: int = CAPACITY,
) -> RunRecorder:
    """A recorder of one run, not started yet. It touches neither disk nor network before its thread does.

    `recordings`: folder of all runs; None: nothing is kept. `name`: of the run's own folder. `attachments` by name: for
    the first segment. `features`: names of the situation's values. `live`: host and port of a live view;
    `opened` hears, in the recorder's thread, when it is open. `ground`: of a simulated robot.
    `began_at_ns`: where the run has a clock of its own: time since 1970 of its 0.
    """
    began_ns = time.time_ns() if began_at_ns is None else began_at_ns
    files = kept = view = shown = None
    if recordings is not None:
        context = Context()
        # Before the files, so that each of them knows all topics.
        kept = NoteLog(Topics(context, settings, features), began_ns)

        def describe(number: int) -> dict[str, dict[str, str]]:
            return {RUN_METADATA: encode_head(head), SEGMENT_METADATA: {"number": str(number), "run": name}}

        now_ns = time.time_ns if began_at_ns is None else lambda: began_at_ns
        files = RunFiles(
            context, recordings, name, budget, describe=describe, attachments=attachments, now_ns=now_ns, disk=disk
        )
    if live is not None:
        # A context of its own: what waits for the disk is shown now, and logged to the file later.
        context = Context()
        shown = NoteLog(Topics(context, settings, features), began_ns)
        view = LiveView(context, *live, name=name, opened=opened)
    return RunRecorder(files, kept, view, shown, ground=ground, began_at_ns=began_at_ns, capacity=capacity)
