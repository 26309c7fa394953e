"""Run recorder: inputs, decisions and lessons of a run, written by its own thread."""

import time
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Self

from foxglove import Context

from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.platform.yield_gil import yield_gil
from kurt2rt.runs.recording.live_view import LiveView
from kurt2rt.runs.recording.recording_disk import Disk
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_files import RunFiles
from kurt2rt.runs.recording.run_folder import Budget
from kurt2rt.runs.recording.run_head import RecordedRun
from kurt2rt.runs.recording.topics import HealthNote, Note, QuestionNote, TickNote, Topics
from kurt2rt.runs.recording.writer_thread import WriterThread
from simbridge.contracts.simulation import WorldView

CAPACITY = 3000
"""Most notes that wait for the disk: half a minute of ticks, about 20 MB."""
_ROUNDS_PER_SECOND = 10
_PLACE_EVERY_TICKS = 5
_WORLD_EVERY_TICKS = 100
_NS_PER_S = 1_000_000_000


class RunRecorder:
    """Recorder that takes notes between two ticks and writes them ten times a second in its own thread.

    A note takes some microseconds, never waits and never raises. Notes lost to a full queue or a failing disk are
    counted; a replay ends at the first of them. Everything written is synced once a second and survives a power cut.
    """

    def __init__(
        self,
        files: RunFiles | None,
        file_log: Topics | None,
        live: LiveView | None,
        live_log: Topics | None,
        *,
        world: WorldView | None = None,
        began_at_ns: int | None = None,
        capacity: int = CAPACITY,
    ) -> None:
        """`file_log` logs to `files`, `live_log` to `live`; None without files or live view.

        `began_at_ns`: time since 1970 of the runtime clock's 0; None: measured at the first tick.
        """
        self._files, self._file_log = files, file_log
        self._live, self._live_log = live, live_log
        self._world = world
        self._thread = WriterThread[Note]("run recorder", capacity, self._run)
        self._held: deque[Note] = deque()
        """Notes that were shown and wait for a file."""
        self._began_at_ns = began_at_ns
        # Counted by the writer thread, and by close() when it hangs; overruns are counted by the loop.
        self._not_written = self._left_behind = 0
        self._failure = ""
        self._unsaved = self._ticks = 0
        self.written = 0
        """Ticks that are durable."""

    @property
    def run(self) -> Path | None:
        """Folder of the run; None without one, or before it is created."""
        return None if self._files is None else self._files.run

    @property
    def dropped(self) -> int:
        """Number of notes missing in the files: the disk was too slow or failed."""
        return self._thread.overruns + self._left_behind + self._not_written

    @property
    def trouble(self) -> str:
        """Error of the recording in one line; empty while everything is recorded."""
        wrong = [self._failure] if self._failure else []
        if self._files is not None and self._files.trouble:
            wrong.append(self._files.trouble)
        if self._live is not None and self._live.trouble:
            wrong.append(self._live.trouble)
        if self.dropped:
            wrong.append(f"{self.dropped} of its ticks and notes lost")
        return f"recording: {', '.join(wrong)}" if wrong else ""

    def on_tick(self, record: TickRecord, *, saved: bool = False) -> None:
        """Note a tick. `saved`: statistics were saved after it."""
        if self._began_at_ns is None:
            # Measured once: later changes of the wall clock do not move the stamps.
            self._began_at_ns = time.time_ns() - round(record.now_s * _NS_PER_S)
        truth = world = None
        if self._world is not None and self._ticks % _PLACE_EVERY_TICKS == 0:
            truth = self._world.place()
            if self._ticks % _WORLD_EVERY_TICKS == 0:
                world = self._world.world()
        self._ticks += 1
        time_ns = self._began_at_ns + round(record.now_s * _NS_PER_S)
        self._note(TickNote(record, time_ns, saved, truth, world))

    def on_acknowledged(self, acknowledgement: Acknowledgement) -> None:
        """Note that a lesson is durable or failed."""
        self._note(acknowledgement)

    def on_question(self, question: object) -> None:
        """Note a question of the robot; its text is `str(question)`."""
        self._note(QuestionNote(question))

    def on_health(self, report: Mapping[str, Any]) -> None:
        """Note a health report in plain values, which must not change any more."""
        self._note(HealthNote(report))

    def start(self) -> None:
        """Start the thread; call it once.

        Without the thread the caller calls `write_waiting` and `poll`.
        """
        self._thread.start()

    def write_waiting(self) -> None:
        """Show all waiting notes, and log them to a file; without a file they go on waiting."""
        for note in yield_gil(self._thread.pop_all()):
            if self._live_log is not None and self._live is not None and self._live.is_open:
                self._log(self._live_log, note)
            if self._files is not None:
                self._held.append(note)
        if self._file_log is None or self._files is None or not self._files.is_open:
            return
        for note in yield_gil(self._held.popleft() for _ in range(len(self._held))):
            if not self._log(self._file_log, note):
                self._not_written += 1
            elif isinstance(note, TickNote):
                self._unsaved += 1

    def poll(self) -> None:
        """Sync the files and start the next segment if it is due; call it once a second."""
        self._poll_live()
        self._poll_files()

    def close(self, patience_s: float = 2.0) -> None:
        """Write the rest and close the files; give up after `patience_s`. `trouble` holds the error."""
        if not self._thread.started:
            self._end()
        elif not self._thread.stop(patience_s):
            self._failure = "the disk does not answer; the end is missing"
            self._left_behind += len(self._thread) + len(self._held) + self._unsaved

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _note(self, note: Note) -> None:
        self._thread.submit(note, held=len(self._held))

    def _log(self, log: Topics, note: Note) -> bool:
        """Log a note; return whether it succeeded."""
        try:
            log.log(note)
        except Exception as error:  # noqa: BLE001  # any error: it is reported, and other notes are still logged
            reason = str(error) if isinstance(error, RecordingError) else f"{error!r}; please report this"
            self._failure = f"a note cannot be written: {reason}"
            return False
        return True

    def _poll_live(self) -> None:
        if self._live is not None:
            self._live.poll()

    def _poll_files(self) -> None:
        files = self._files
        if files is None or self._file_log is None:
            return
        took, given_up, folders = files.is_open, files.given_up, files.folders
        kept = files.poll()
        if files.given_up > given_up:
            self._not_written += self._unsaved
            self._unsaved = 0
        elif kept:
            self.written, self._unsaved = self.written + self._unsaved, 0
        if files.folders > max(folders, 1):  # a user deleted the run
            self._not_written += self.written
            self.written = 0
        if files.is_open and (not took or files.given_up > given_up):
            self._file_log.repeat_periodic()

    def _run(self) -> None:
        rounds = rounds_of_files = 0
        ended = False
        try:
            while not ended:
                if rounds % _ROUNDS_PER_SECOND == 0:
                    self._safely(self._poll_live)
                # After the first tick only: a start that fails leaves no run.
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
        except Exception as error:  # noqa: BLE001  # any error: it is reported and tried again
            self._failure = f"its thread failed with {error!r}; please report this"

    def _end(self) -> None:
        self.write_waiting()
        try:
            if self._files is not None and (self._ticks or self._files.run is not None):
                self._poll_files()
                self.write_waiting()
                if self._files.close():
                    self.written, self._unsaved = self.written + self._unsaved, 0
        finally:
            if self._ticks:
                self._not_written += len(self._thread) + len(self._held) + self._unsaved
            self._held.clear()
            self._unsaved = 0
            if self._live is not None:
                self._live.close()


def open_run_recorder(
    recordings: Path | None,
    run: RecordedRun,
    budget: Budget,
    *,
    live: tuple[str, int] | None = None,
    opened: Callable[[LiveView], None] = lambda _: None,
    disk: Disk | None = None,
    capacity: int = CAPACITY,
) -> RunRecorder:
    """Return the recorder of one run, not started yet; only its thread touches disk and network.

    `recordings`: folder of all runs; None: no files. `live`: host and port of a live view; `opened` is called in the
    recorder's thread once it listens.
    """
    files = file_log = view = live_log = None
    if recordings is not None:
        context = Context()
        # Before the files, so that each of them knows all topics.
        file_log = Topics(context, run.settings, run.features, run.now_ns())
        files = RunFiles(context, recordings, run, budget, disk)
    if live is not None:
        # A context of its own: notes that wait for the disk are shown now, and logged to the file later.
        context = Context()
        live_log = Topics(context, run.settings, run.features, run.now_ns())
        view = LiveView(context, *live, name=run.name, opened=opened)
    return RunRecorder(files, file_log, view, live_log, world=run.world, began_at_ns=run.began_at_ns, capacity=capacity)
