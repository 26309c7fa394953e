"""Environment of a replayed tick: robot, clock and event store with recorded values."""

from hal.guard_reason import GuardReason
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.runs.recording.entries import TickEntry


class ReplayEnvironment:
    """Robot, Clock and LessonKeeper in one object, because they share the current tick."""

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
