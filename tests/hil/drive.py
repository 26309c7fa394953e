"""A robot that drives over vcan0, tick by tick, with the simulated one at the far end."""

import subprocess
import time
from types import TracebackType
from typing import Self

from hal.bus import open_bus
from hal.health import Health
from hal.kurt2 import Kurt2
from hal.kurt2_settings import load_kurt2
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from simbridge.controller.reconnecting_bus import ReconnectingBus
from simbridge.simulated_robot import SimulatedKurt2
from tests.simbridge.rig import room

FORWARD = WheelSpeeds(0.3, 0.3)
_MOST_TICKS = 500
_PAUSE_S = 0.001
_SETTLES_S = 0.2


class Drive:
    """Runtime and robot in lockstep, 10 ms a tick by their own clock; the kernel carries and stamps what they say."""

    def __init__(self, bus: str) -> None:
        settings = load_kurt2()
        self._cycle_s = settings.cycle_s
        self._far_end = open_bus(bus)
        self.kurt2 = Kurt2(settings, open_bus(bus))
        self.simulated = SimulatedKurt2(settings, room(), ReconnectingBus(self._far_end, lambda: self.now_s), seed=3)
        self.readings = SensorReadings(0.0, (), 0.0, 0, 0, 0.0, 0, 0.0)
        self.grant = GuardResult(FORWARD, (), False)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.kurt2.close()
        self._far_end.shutdown()
        # The kernel's own thread delivers its last brakes; the next robot must not hear them as another sender's.
        time.sleep(_SETTLES_S)

    @property
    def now_s(self) -> float:
        """Time of the robot and of the runtime."""
        return self.simulated.time_s

    @property
    def health(self) -> Health:
        """Health of the runtime's robot."""
        return self.kurt2.health

    def tick(self, wanted: WheelSpeeds = FORWARD) -> GuardResult:
        """Run the robot's cycle, then the runtime's; return the guard's result."""
        # Where ticks follow each other without a pause, the kernel's own thread that delivers frames waits its turn.
        time.sleep(_PAUSE_S)
        self.simulated.step()
        now_s = self.now_s
        self.readings = self.kurt2.sense(now_s)
        self.grant = self.kurt2.drive(wanted, now_s, now_s)
        return self.grant

    def ticks(self, count: int, wanted: WheelSpeeds = FORWARD) -> GuardResult:
        """So many of them; the last one's grant."""
        for _ in range(count):
            self.tick(wanted)
        return self.grant

    def until_it_drives(self) -> None:
        """Tick until the guard lets the wanted speeds pass and the wheels obey.

        A machine that was held up for a moment lets readings grow old: the robot stands, and starts again.
        """
        for _ in range(_MOST_TICKS):
            if self.tick().wheel_speeds == FORWARD and self.simulated.wheel_speeds.left_m_s > 0.25:
                return
        raise AssertionError(f"it does not drive: {self.grant}, {self.health}")

    def until_fresh(self) -> None:
        """Tick until readings of the present cycle come again."""
        for _ in range(_MOST_TICKS):
            self.tick()
            if self.readings.infrared_age_s < self._cycle_s:
                return
        raise AssertionError(f"no readings come: {self.readings}, {self.health}")

    def until_it_stands(self) -> None:
        """Tick until the wheels stand still."""
        for _ in range(_MOST_TICKS):
            self.tick()
            if self.simulated.wheel_speeds == (0.0, 0.0):
                return
        raise AssertionError(f"it does not stand: {self.simulated.wheel_speeds}, {self.health}")


def cansend(frame: str) -> None:
    """Put a frame on vcan0, as a person at a terminal would."""
    subprocess.run(["cansend", "vcan0", frame], check=True, capture_output=True, text=True)
