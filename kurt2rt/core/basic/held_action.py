"""Held action: it drives for a minimum time, so that the robot does not alternate between neighbouring RLAs."""

from behaviors.behaviour import Behaviour
from behaviors.repertoire import Repertoire
from hal.robot import SensorReadings, WheelSpeeds


class HeldAction:
    """Action that drives for a level; no other one replaces it before its minimum time is over."""

    def __init__(self, repertoire: Repertoire, minimum_ticks: int) -> None:
        self._repertoire = repertoire
        self._minimum_ticks = minimum_ticks
        self._active: Behaviour | None = None
        self._ticks = 0
        self.name = ""
        """Name of the action that drives or drove last."""

    def select(self, action: str) -> bool:
        """Let `action` drive; return False if another action is held because its minimum time is not over.

        A finished or lost action is not held. Raises KeyError for an action outside the repertoire.
        """
        if self._active is not None:
            if action == self.name:
                return True
            if self.held:
                return False
        self._active = self._repertoire[action]
        self._active.start()
        self.name = action
        self._ticks = 0
        return True

    @property
    def held(self) -> str:
        """Action that no other can replace now; empty if any can."""
        active = self._active
        if active is None or self._ticks >= self._minimum_ticks or active.finished or active.lost:
            return ""
        return self.name

    @property
    def lost(self) -> bool:
        """Return whether the driving action does not know its situation; read it after `step`."""
        return self._active is not None and self._active.lost

    def step(self, readings: SensorReadings, *, counts: bool = True) -> WheelSpeeds:
        """Return the wheel speeds in m/s of the driving action in this tick; call it only after `select`.

        `counts`: whether the tick counts for the minimum time.
        """
        assert self._active is not None
        self._ticks += counts
        return self._active.step(readings)

    def allow_switch(self) -> None:
        """Let the next `select` replace the action at once."""
        self._ticks = self._minimum_ticks

    def stop(self) -> None:
        """Stop the action; the next one starts from its beginning."""
        self._active = None
