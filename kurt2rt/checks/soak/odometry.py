"""Comparison of encoder ticks and true wheel rotation."""

from hal.robot import SensorReadings
from kurt2rt.checks.soak.long_run_rig import SoakRig


class OdometryCheck:
    """Comparison from minute to minute, skipped after a fault or a repositioning."""

    def __init__(self, rig: SoakRig, metres_per_tick: float) -> None:
        self.worst_m = 0.0
        """Largest difference of a side in one interval."""
        self._rig = rig
        self._metres_per_tick = metres_per_tick
        self._ticks = [0, 0]
        self._turned_m = [0.0, 0.0]
        self._valid = False

    def on_tick(self, readings: SensorReadings) -> None:
        """Add a tick's encoder counts."""
        self._ticks[0] += readings.encoder_left_ticks
        self._ticks[1] += readings.encoder_right_ticks

    def invalidate(self) -> None:
        """Skip the next comparison."""
        self._valid = False

    def compare(self) -> None:
        """Compare the interval and begin the next one."""
        if self._valid:
            for ticks, turned_m, before_m in zip(self._ticks, self._rig.turned_m, self._turned_m, strict=True):
                self.worst_m = max(self.worst_m, abs(ticks * self._metres_per_tick - (turned_m - before_m)))
        self._ticks = [0, 0]
        self._turned_m = list(self._rig.turned_m)
        self._valid = True
