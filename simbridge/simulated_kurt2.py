"""Simulated KURT2: a simulated robot with KURT2's micro-controller at one end of a CAN bus."""

from hal.kurt2_settings import Kurt2Settings
from simbridge.controller.microcontroller import MicroController
from simbridge.controller.telemetry import ControllerBus
from simbridge.robot.infrared import InfraredSensors
from simbridge.robot.instruments import Instruments
from simbridge.robot.wheels import Wheels
from simbridge.simulated_robot import SimulatedRobot
from simbridge.worlds.world_settings import WorldSettings


class SimulatedKurt2(SimulatedRobot):
    """KURT2 whose time advances only by `step`; equal seeds and frames give equal runs."""

    controller: MicroController
    infrared: InfraredSensors

    def __init__(
        self,
        robot: Kurt2Settings,
        world: WorldSettings,
        bus: ControllerBus,
        seed: int,
        *,
        robot_seed: int | None = None,
        wheels: Wheels | None = None,
    ) -> None:
        """Place the robot at the world's first start pose; the caller shuts `bus` down.

        Args: `seed`, `robot_seed` and `wheels` as in `SimulatedRobot`.
        """
        super().__init__(
            robot,
            world,
            lambda body, wheels: MicroController(robot, bus, Instruments(robot, body, wheels)),
            seed,
            robot_seed=robot_seed,
            wheels=wheels,
        )
