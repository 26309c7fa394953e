"""The run recorder: all that a run sees, decides and is taught, written beside the loop and never at its cost."""

import queue
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

from foxglove import Context

from hal.robot_settings import RobotSettings
from kurt2rt.channel.ground import Ground, WorldView
from kurt2rt.channel.state import SimulatedPlace
from kurt2rt.health.report import HealthReport
from kurt2rt.knowledge.politely import politely
from kurt2rt.knowledge.writer import Acknowledgement
from kurt2rt.recording.disk import Disk
from kurt2rt.recording.error import RecordingError
from kurt2rt.recording.live_view import LiveView
from kurt2rt.recording.run_files import Budget, RunFiles
from kurt2rt.recording.run_head import RUN_METADATA, RunHead, encode_head
from kurt2rt.recording.topics import Topics
from kurt2rt.tick import TickRecord

CAPACITY = 3000
"""Notes that wait for the disk: half a minute of ticks, some 20 MB."""
SEGMENT_METADATA = "segment"
"""Name of what tells each segment's number, beside the head of the run."""
_PERIOD_S = 0.1
_ROUNDS_PER_SECOND = 10
_PLACE_EVERY_TICKS = 5
_WORLD_EVERY_TICKS = 100
_NS_PER_S = 1_000_000_000


class _Ticked(NamedTuple):
    record: TickRecord
    saved: bool
    truth: SimulatedPlace | None
    world: WorldView | None


class _Asked(NamedTuple):
    question: object


_Noted = _Ticked | _Asked | HealthReport | Acknowledgement


class RunRecorder:
    """Takes notes between two ticks, and writes them in a thread of its own, ten times a second.

    A note takes some microseconds, never waits and never raises. Notes that find no room, and those that a disk loses
    that fails for long, are counted; a replay can go up to the first of them. Everything that is once told to be there
    survives a power cut: once a second the disk is made to keep it.
    """

    def __init__(
        self,
        topics: Topics,
        files: RunFiles | None,
        live: LiveView | None = None,
        *,
        ground: Ground | None = None,
        began_at_ns: int | None = None,
        capacity: int = CAPACITY,
    ) -> None:
        """`files`: None: nothing is kept. `began_at_ns`: time since 1970 of the runtime's clock at 0; else measured."""
        self._topics = topics
        self._files = files
        self._live = live
        self._ground = ground
        self._capacity = capacity
        # A SimpleQueue's put never waits for the thread at its other end, and a signal handler may interrupt it.
        self._waiting: queue.SimpleQueue[_Noted] = queue.SimpleQueue()
        self._began_at_ns = began_at_ns
        self._time_ns = began_at_ns or 0
        # Counted apart, for two threads count.
        self._without_room = self._not_written = 0
        self._failure = ""
        self._unsaved = self._notes = 0
        self._world: WorldView | None = None
        self.written = 0
        """Ticks that the disk has."""
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="run recorder", daemon=True)
        self._started = False

    @property
    def run(self) -> Path | None:
        """The folder that is written; None where there is none, or not yet."""
        return None if self._files is None else self._files.run

    @property
    def dropped(self) -> int:
        """Notes that are not in the files: the disk was too slow, or failed."""
        return self._without_room + self._not_written

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

    def note(self, record: TickRecord, *, saved: bool = False) -> None:
        """A tick has been. `saved`: statistics were saved after it."""
        if self._began_at_ns is None:
            # The wall clock may be set meanwhile; the stamps go on evenly.
            self._began_at_ns = time.time_ns() - round(record.now_s * _NS_PER_S)
        truth = world = None
        if self._ground is not None and self._notes % _PLACE_EVERY_TICKS == 0:
            truth = self._ground.place()
            if self._notes % _WORLD_EVERY_TICKS == 0:
                world = self._ground.world()
        self._notes += 1
        self._note(_Ticked(record, saved, truth, world))

    def acknowledged(self, acknowledgement: Acknowledgement) -> None:
        """A lesson is durable, or never will be."""
        self._note(acknowledgement)

    def asked(self, question: object) -> None:
        """The robot begins to ask; `str` of it is the question."""
        self._note(_Asked(question))

    def healthy(self, report: HealthReport) -> None:
        """How the program is."""
        self._note(report)

    def take(self, budget: Budget) -> None:
        """Keep to this budget from now on."""
        if self._files is not None:
            self._files.take(budget)

    def start(self) -> None:
        """Begin to write; once only. Without, whoever records calls `write_waiting` and `tend`."""
        self._started = True
        self._thread.start()

    def write_waiting(self) -> None:
        """Log all that waits; while there is no file to log it to, it goes on waiting."""
        if not self._is_taken and self._files is not None:
            return
        waiting = (self._waiting.get_nowait() for _ in range(self._waiting.qsize()))
        for noted in politely(waiting):
            try:
                self._log(noted)
            except RecordingError as error:
                self._failure = str(error)
                self._not_written += 1

    def tend(self) -> None:
        """Once a second: have the disk keep what was logged, and go on in another file where that is due."""
        if self._live is not None:
            self._live.tend()
        if self._files is None:
            return
        took, given_up = self._files.takes, self._files.given_up
        kept = self._files.tend()
        if self._files.given_up > given_up:
            self._not_written += self._unsaved
            self._unsaved = 0
        elif kept:
            self.written += self._unsaved
            self._unsaved = 0
        if self._files.takes and (not took or self._files.given_up > given_up):
            self._topics.begin_anew()

    def close(self, patience_s: float = 2.0) -> None:
        """Write the rest and end the files; gives a disk that hangs up after a while. `trouble` tells what came."""
        self._ending.set()
        if not self._started:
            self._end()
            return
        self._thread.join(patience_s)
        if self._thread.is_alive():
            self._failure = "the disk does not answer; the end is missing"

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def _is_taken(self) -> bool:
        kept = self._files is not None and self._files.takes
        return kept or (self._live is not None and self._live.is_open)

    def _note(self, noted: _Noted) -> None:
        if self._waiting.qsize() < self._capacity:
            self._waiting.put(noted)
        else:
            self._without_room += 1

    def _log(self, noted: _Noted) -> None:
        topics = self._topics
        match noted:
            case _Ticked(record, saved, truth, world):
                self._time_ns = (self._began_at_ns or 0) + round(record.now_s * _NS_PER_S)
                topics.tick(record, saved=saved, truth=truth, time_ns=self._time_ns)
                self._world = world or self._world
                if self._world is not None:
                    topics.ground(self._world, record.tick, self._time_ns)
                self._count()
            case _Asked(question):
                topics.asked(str(question), self._time_ns)
            case HealthReport():
                topics.healthy(noted, self._time_ns)
            case Acknowledgement():
                topics.acknowledged(noted, self._time_ns)

    def _count(self) -> None:
        if self._files is None:
            return
        if self._files.takes:
            self._unsaved += 1
        else:
            self._not_written += 1

    def _run(self) -> None:
        rounds, ended = 0, False
        try:
            while not ended:
                if rounds % _ROUNDS_PER_SECOND == 0:
                    self.tend()
                ended = self._ending.wait(_PERIOD_S)
                self.write_waiting()
                rounds += 1
            self._end()
        except Exception as error:  # noqa: BLE001  # of whatever kind: it is told, and the robot goes on
            self._failure = f"its thread ended by {error!r}; please report this"

    def _end(self) -> None:
        self.write_waiting()
        if self._files is not None:
            self.tend()
            self._files.close()
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
    ground: Ground | None = None,
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
    context = Context()
    # Before the files, so that each of them knows all topics.
    topics = Topics(context, settings, features)
    files = None
    if recordings is not None:

        def describe(number: int) -> dict[str, dict[str, str]]:
            return {RUN_METADATA: encode_head(head), SEGMENT_METADATA: {"number": str(number), "run": name}}

        now_ns = time.time_ns if began_at_ns is None else lambda: began_at_ns
        files = RunFiles(
            context, recordings, name, budget, describe=describe, attachments=attachments, now_ns=now_ns, disk=disk
        )
    view = None if live is None else LiveView(context, *live, name=name, opened=opened)
    return RunRecorder(topics, files, view, ground=ground, began_at_ns=began_at_ns, capacity=capacity)
