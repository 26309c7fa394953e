"""Simulated robot, cable and drivers in simulated time, with faults between them."""

import random

from hal.bus import CONTROL_ID, CanBus
from hal.codec import load_codec
from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings, load_kurt2
from hal.tap import Tap
from hal.watchdog import POLL_S
from simbridge.simulated_robot import SimulatedKurt2
from simbridge.worlds.world_settings import StartPoseSettings, WorldSettings
from tests.stories.fault import FaultInjection, SimulatedTime
from tests.stories.faulty_cable import EndFaults
from tests.stories.motors import FaultyWheels

ROBOT: Kurt2Settings = load_kurt2()

_LENGTH_M, _WIDTH_M = 10.0, 4.0
_WALL_AT_M = 0.22
_HALF_WIDTH_M = 0.165
CORRIDOR = WorldSettings(
    name="hall",
    size_m=(_LENGTH_M, _WIDTH_M),
    infrared_rays=1,
    outline=((0.0, 0.0), (_LENGTH_M, 0.0), (_LENGTH_M, _WIDTH_M), (0.0, _WIDTH_M), (0.0, 0.0)),
    start_poses=(StartPoseSettings(x_m=1.5, y_m=_WIDTH_M - _HALF_WIDTH_M - _WALL_AT_M, heading_deg=0.0),),
)
"""Corridor with one constant situation, so that a standstill is due to the fault."""


class Rig:
    """Robot and cable, and one driver after the other.

    Ticks, controller cycles and watchdog polls have independent phases. Events of simulated time replace the
    watchdog's thread.
    """

    def __init__(self, settings: Kurt2Settings, world: WorldSettings, chance: random.Random) -> None:
        self.time = SimulatedTime()
        self.injection = FaultInjection(self.time)
        self.ends = EndFaults(self.injection, load_codec(settings.can.database), chance)
        self.robot: Kurt2 | None = None
        """Present driver; None between two of them."""
        self._settings, self._chance = settings, chance
        self._starts = [start.pose for start in world.start_poses]
        self._robots_bus = CanBus("cable", self.ends.open_robots_end)
        self._robots_bus.set_id_filter({CONTROL_ID})
        self._notebooks_bus = CanBus("cable", self.ends.open_notebooks_end)
        wheels = FaultyWheels(settings, self.injection, chance)
        self.simulation = SimulatedKurt2(settings, world, self._robots_bus, chance.getrandbits(32), wheels=wheels)
        self.time.every(settings.cycle_s, 0.0, self._step)
        self.time.every(POLL_S, chance.uniform(0.0, POLL_S), self._poll_watchdog)

    def start_driver(self) -> Kurt2:
        """Start a new driver on another cable, like a start of its process."""
        self.ends.replace_cable()
        self._robots_bus.reopen()
        self._notebooks_bus = CanBus("cable", self.ends.open_notebooks_end)
        self.robot = Kurt2(self._settings, self._notebooks_bus, watchdog_clock=self.time.now_s)
        return self.robot

    def end_driver(self, *, killed: bool = False) -> None:
        """End the driver; one that was `killed` sends nothing any more."""
        if self.robot is not None and killed:
            self._notebooks_bus.shutdown()
        elif self.robot is not None:
            self.robot.close()
        self.robot = None

    def attach_tap(self, tap: Tap | None) -> None:
        """Let `tap` see each frame that passes the driver's interface."""
        self._notebooks_bus.tap = tap

    def set_down(self) -> None:
        """Put the robot at one of the world's start poses."""
        self.simulation.place(self._chance.choice(self._starts))

    def power_cycle(self) -> None:
        """Switch the robot off and on."""
        self.simulation.controller.power_cycle()

    def close(self) -> None:
        self.end_driver()
        self._robots_bus.shutdown()

    def _step(self) -> None:
        self.simulation.step()
        if self.simulation.controller.crashed:
            self.power_cycle()

    def _poll_watchdog(self) -> None:
        if self.robot is not None and self.robot.watchdog.check(self.time.now_s()):
            self.robot.emergency_stop(GuardReason.TICKS_CEASED)
