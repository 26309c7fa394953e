"""The action at the wheels, held for a minimum time against dithering between neighbours."""

from behaviors.behaviour import Behaviour
from behaviors.repertoire import Repertoire
from hal.robot import SensorReadings, WheelSpeeds


class HeldAction:
    """Which behaviour of a repertoire drives, and for how long it has."""

    def __init__(self, repertoire: Repertoire, minimum_ticks: int) -> None:
        self._repertoire = repertoire
        self._minimum_ticks = minimum_ticks
        self._active: Behaviour | None = None
        self._ticks = 0
        self.name = ""
        """Of the action that drives, or drove last."""

    def select(self, action: str) -> bool:
        """Let `action` drive; False when another one keeps the wheels, for its minimum time is not over.

        One that has finished, or does not know how to go on, keeps them from nobody.
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
        """The action that no other one can take the wheels from now; empty where one can."""
        active = self._active
        if active is None or self._ticks >= self._minimum_ticks or active.finished or active.lost:
            return ""
        return self.name

    @property
    def lost(self) -> bool:
        """Whether the action at the wheels does not know how to go on, after `step`."""
        return self._active is not None and self._active.lost

    def step(self, senses: SensorReadings) -> WheelSpeeds:
        """Wheel speeds of the action that drives, after `choose`."""
        assert self._active is not None
        self._ticks += 1
        return self._active.step(senses)

    def allow_switch(self) -> None:
        """The next choice counts at once, however short this action drove."""
        self._ticks = self._minimum_ticks

    def stop(self) -> None:
        """Nothing drives; the next action begins anew."""
        self._active = None
