"""What stands round a tick that is replayed: robot, clock and journal say what the recorded ones said."""

from hal.guard_reason import GuardReason
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.rla.rla import TeachingEvent
from kurt2rt.runs.recording.entries import TickEntry


class ReplayEnvironment:
    """A Robot, a Clock and a LessonKeeper in one: they share the tick that is on. Nothing moves, nothing is kept."""

    def __init__(self) -> None:
        self.entry: TickEntry | None = None
        """The tick that is on."""

    @property
    def error(self) -> str | None:
        """As it was in this tick (LessonKeeper)."""
        return self._entry.trouble

    def submit(self, event: TeachingEvent) -> None:
        """The record has it; the journal is left alone (LessonKeeper)."""

    def now_s(self) -> float:
        """As it was in this tick (Clock)."""
        return self._entry.now_s

    async def wait_until(self, deadline_s: float) -> None:
        """A replay does not wait (Clock)."""

    def sense(self, now_s: float) -> SensorReadings:  # noqa: ARG002 - what was sensed then
        """What was sensed (Robot)."""
        return self._entry.senses

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:  # noqa: ARG002 - as applied then
        """What the guard let through then, whatever is wanted now: the robot is where it was (Robot)."""
        return self._entry.grant

    def emergency_stop(self, reason: GuardReason) -> None:
        """The recorded grants tell whether it stopped (Robot)."""

    def release(self) -> None:
        """As above (Robot)."""

    def close(self) -> None:
        """There is nothing to give back (Robot)."""

    @property
    def _entry(self) -> TickEntry:
        assert self.entry is not None, "no tick is on"
        return self.entry
