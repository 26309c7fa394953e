"""Replay of a run: the recorded inputs through the same tick."""

from collections.abc import Iterator
from typing import NamedTuple

from config.settings import SettingsError
from hal.guard_reason import GuardReason
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.decision.decision import ActiveBehaviour, UnknownActionError, UnknownBehaviourError
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.outcome import CommandRefusedError
from kurt2rt.core.outcome_text import event_error_text, text_of
from kurt2rt.core.rla.events import InvalidEventError, TeachingEvent
from kurt2rt.core.rla.statistics import StatisticsCounter
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.run import Run
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime


class ReplayedTick(NamedTuple):
    """Tick as it was recorded (`entry`), and as the replay decided it again (`record`)."""

    entry: TickEntry
    record: TickRecord


class Replay:
    """The same run again: recorded readings and commands through the same tick, bit for bit.

    for entry, record in Replay(run): compare(entry, record). Nothing moves, and no file is written; `kurt2rt why` and
    the preview of an undo read it as well.
    """

    def __init__(self, run: Run) -> None:
        """Build the runtime.

        Raises RecordingError if the initial state is missing or this program cannot build it.
        """
        run.require_beginning()
        self.run = run
        self._replayed = ReplayEnvironment()
        self.runtime = self._build()

    def step(self, entry: TickEntry) -> TickRecord:
        """Replay the next tick with its recorded inputs and return its record; call it for each tick in order."""
        runtime = self.runtime
        self._replayed.entry = entry
        runtime.inbox.replace_pending(entry.commands)
        runtime.timer.begin(0.0)
        record = runtime.tick.run(entry.tick, entry.now_s)
        runtime.timer.end()
        if entry.saved:
            runtime.snapshot()  # drops the counts of RLAs that are no more, and plans are made of counts
        return record

    def __iter__(self) -> Iterator[ReplayedTick]:
        """Replay all ticks, once. Raises RecordingError."""
        for entry in self.run.entries():
            yield ReplayedTick(entry, self.step(entry))

    def _build(self) -> Runtime:
        run, head = self.run, self.run.head
        try:
            stop = ActiveStop(StopReason(head.stopped)) if head.stopped else None
            wanted = ActiveBehaviour(run.task.behaviours)
            if head.behaviour:
                wanted.select(head.behaviour)
            with run.settings():
                runtime = build_runtime(
                    self._replayed,
                    run.robot,
                    run.task,
                    [lesson.event for lesson in run.lessons],
                    self._replayed,
                    self._replayed,
                    RuntimeOptions(
                        statistics=StatisticsCounter(dict(run.saved.uses), dict(run.saved.transitions)),
                        attended=head.attended,
                        active_behaviour=wanted,
                        checkpoint=run.saved,
                        teacher_available=head.asked,
                        tolerates_stalls=head.tolerates_stalls,
                    ),
                )
        except (SettingsError, KnowledgeError, UnknownActionError, UnknownBehaviourError) as error:
            raise RecordingError(f"cannot be replayed by this kurt2rt: {error}", where=run.name) from error
        except (InvalidEventError, CommandRefusedError, ValueError) as error:
            told = text_of(error.outcome) if isinstance(error, CommandRefusedError) else str(error)
            cause = event_error_text(error) if isinstance(error, InvalidEventError) else told
            raise RecordingError(f"cannot be replayed: {cause}", where=run.name) from error
        if stop is not None:
            runtime.handler.control.stop(stop)
        return runtime


def empty_run_error(run: Run) -> RecordingError:
    """Return the error for a run without ticks, after they were searched."""
    return RecordingError(
        "holds no tick", where=run.name, do=f"{run.trouble or 'the program ended before the first one'}"
    )


class ReplayEnvironment:
    """Environment of a replayed tick, which gives it what was recorded: robot, clock and event store in one.

    They are one object, because they share the current tick.
    """

    def __init__(self) -> None:
        self.entry: TickEntry | None = None
        """Current tick."""

    @property
    def saving_error(self) -> str | None:
        """Recorded error of the journal (LessonKeeper); None without one."""
        return self._entry.saving_error

    def submit(self, event: TeachingEvent) -> None:
        """Discard the event: the record has it (LessonKeeper)."""

    def now_s(self) -> float:
        """Return the recorded time in s (Clock)."""
        return self._entry.now_s

    async def wait_until(self, deadline_s: float) -> None:
        """Return at once: the recorded ticks tell the time (Clock)."""

    def sense(self, now_s: float) -> SensorReadings:  # noqa: ARG002 - what was sensed then
        """Return the recorded readings (Robot)."""
        return self._entry.readings

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:  # noqa: ARG002 - as applied then
        """Return the recorded result of the guard for any wanted speeds (Robot)."""
        return self._entry.grant

    def emergency_stop(self, reason: GuardReason) -> None:
        """Do nothing: the recorded guard results contain the stop (Robot)."""

    def release(self) -> None:
        """Do nothing: the recorded guard results contain the release (Robot)."""

    def close(self) -> None:
        """Do nothing: a replay holds no bus (Robot)."""

    @property
    def _entry(self) -> TickEntry:
        assert self.entry is not None, "no tick is on"
        return self.entry
