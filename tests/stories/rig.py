"""Simulated robot, its link and drivers in simulated time, with faults between them."""

import random
from collections.abc import Mapping

from hal.guard_reason import GuardReason
from hal.guarded_robot import GuardedRobot
from hal.kurt2_settings import Kurt2Settings, load_kurt2
from hal.robot_settings import RobotSettings, load_robot
from hal.watchdog import POLL_S
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings
from simbridge.worlds.world_settings import StartPoseSettings, WorldSettings
from tests.stories.can_ends import CanEnds
from tests.stories.ends import Ends
from tests.stories.fault import FaultInjection, SimulatedTime
from tests.stories.linked_ends import SerialEnds, TopicEnds
from tests.stories.motors import FaultyWheels
from tests.stories.table import RobotKind

ROBOT: Kurt2Settings = load_kurt2()
ROBOTS: Mapping[RobotKind, RobotSettings] = {
    "kurt2": ROBOT,
    "school": load_robot("school"),
    "turtlebot": load_robot("turtlebot"),
}

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


def _ends_of(settings: RobotSettings, injection: FaultInjection, chance: random.Random) -> Ends:
    match settings:
        case Kurt2Settings():
            return CanEnds(settings, injection, chance)
        case TurtlebotSettings():
            return TopicEnds(settings, injection, chance)
        case _:
            return SerialEnds(settings, injection, chance)


class Rig:
    """Robot and its link, and one driver after the other.

    Ticks, controller cycles and watchdog polls have independent phases. Events of simulated time replace the
    watchdog's thread.
    """

    def __init__(self, settings: RobotSettings, world: WorldSettings, chance: random.Random) -> None:
        self.time = SimulatedTime()
        self.injection = FaultInjection(self.time)
        self.settings = settings
        self.ends = _ends_of(settings, self.injection, chance)
        self.robot: GuardedRobot | None = None
        """Present driver; None between two of them."""
        self._chance = chance
        self._starts = [start.pose for start in world.start_poses]
        wheels = FaultyWheels(settings, self.injection, chance)
        self.simulation = self.ends.simulated(world, chance.getrandbits(32), wheels)
        self.time.every(settings.cycle_s, 0.0, self._step)
        self.time.every(POLL_S, chance.uniform(0.0, POLL_S), self._poll_watchdog)

    def start_driver(self) -> GuardedRobot:
        """Start a new driver, like a start of its process."""
        self.robot = self.ends.start_driver()
        return self.robot

    def end_driver(self, *, killed: bool = False) -> None:
        """End the driver; one that was `killed` sends nothing any more."""
        if self.robot is not None and not killed:
            self.robot.close()
        elif self.ends.bus is not None:
            self.ends.bus.shutdown()  # others send nothing without their program
        self.robot = None

    def set_down(self) -> None:
        """Put the robot at one of the world's start poses."""
        self.simulation.place(self._chance.choice(self._starts))

    def power_cycle(self) -> None:
        """Switch the robot off and on."""
        self.simulation.controller.power_cycle()

    def close(self) -> None:
        self.end_driver()

    def _step(self) -> None:
        self.simulation.step()
        if self.simulation.controller.crashed:
            self.power_cycle()

    def _poll_watchdog(self) -> None:
        if self.robot is not None and self.robot.watchdog.check(self.time.now_s()):
            self.robot.emergency_stop(GuardReason.TICKS_CEASED)
