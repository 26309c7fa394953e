"""Simulated robot: body, wheels, sensors, bumpers, and its electronics at one end of a link; and KURT2's."""

import hashlib
import struct
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple, Protocol

from hal.kurt2_settings import Kurt2Settings
from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings
from simbridge.contracts.simulation import Pose, WallSide
from simbridge.controller.controller import Controller
from simbridge.controller.microcontroller import MicroController
from simbridge.controller.telemetry import ControllerBus
from simbridge.robot.body import Body
from simbridge.robot.bumpers import Bumpers, CollisionCounter
from simbridge.robot.infrared import InfraredSensors
from simbridge.robot.instruments import Instruments
from simbridge.robot.noise import Noise
from simbridge.robot.wheels import Wheels
from simbridge.robot.world import World
from simbridge.survey.laps import WallProgress
from simbridge.worlds.world_settings import WorldSettings

_LAPS_EVERY_CYCLES = 10
_KURT2_WIDTH_M = 0.330
"""Width of the robot for which the survey of walls is made."""

MakeController = Callable[[Body, Wheels], Controller]
"""Make the controller of a robot with this body and these wheels."""


class RangeSensors(Protocol):
    """Simulated range sensors of a robot, in the order of the sensor table."""

    @property
    def counts(self) -> Sequence[int]:
        """Newest reading of each sensor, in counts."""
        ...

    @property
    def due_s(self) -> Sequence[float]:
        """Simulated times that the next measurements depend on, in s, for the state hash."""
        ...

    def measure(self, pose: Pose) -> Sequence[int]:
        """Simulate one cycle at a pose and return the indexes of the sensors with new readings."""
        ...

    def measure_all(self, pose: Pose) -> None:
        """Measure with all sensors at once, for a repositioned robot."""
        ...


MakeSensors = Callable[[RobotSettings, World, Noise, Noise], RangeSensors]
"""Make the range sensors of a robot in a world; the first noise selects the run, the second one the robot."""


def infrared_sensors(robot: RobotSettings, world: World, noise: Noise, build: Noise) -> InfraredSensors:
    """Return the simulated infra-red sensors of a robot, the default of robots without sensors of their own.

    `noise` selects phases and readings, `build` gains and periods.
    """
    return InfraredSensors(robot.infrared, world, robot.cycle_s, noise, build)


class _Put(NamedTuple):
    """Pose at which the robot was put."""

    pose: Pose


class SimulatedRobot:
    """Robot whose time advances only by `step`; equal seeds and commands give equal runs."""

    def __init__(
        self,
        robot: RobotSettings,
        world: WorldSettings,
        make_controller: MakeController,
        seed: int,
        *,
        robot_seed: int | None = None,
        wheels: Wheels | None = None,
        make_sensors: MakeSensors = infrared_sensors,
    ) -> None:
        """Place the robot at the world's first start pose; the caller closes the controller's link.

        Args: `seed` selects the run: noise, phases, slip. `robot_seed` (default: `seed`) selects the robot: gains and
        periods of its sensors, so that an exam can use the robot that was taught. `wheels` replaces the sound ones.
        """
        cycle_s = robot.cycle_s
        self.world = World(world)
        self._cycle_s = cycle_s
        self._wall_side: WallSide = "left"
        self._width_scale = robot.geometry.outline_width_m / _KURT2_WIDTH_M
        self._cycles = 0
        self.infrared_noise = Noise(seed, "infrared")
        self.slip_noise = Noise(seed, "slip")
        self.wheels = wheels or Wheels(robot)
        self.body = Body(self.world, robot.geometry, cycle_s, self.slip_noise)
        build = Noise(seed if robot_seed is None else robot_seed, "robot")
        self.infrared = make_sensors(robot, self.world, self.infrared_noise, build)
        self.bumpers = Bumpers(robot.bumpers, robot.geometry)
        self._collisions = CollisionCounter(cycle_s)
        self._placed: Pose = world.start_poses[0].pose
        """Pose of the last placement, from which the progress along walls counts."""
        self._followed: Pose | None = None
        """Pose in a batch; None for a robot that drives itself."""
        self._passed: list[Pose | _Put] = []
        """Poses that were followed, and whose progress was not asked for yet."""
        self._pressed = 0
        self.lifted = False
        """Whether the robot stands on a block: its wheels turn in the air and the body rests."""
        self.controller = make_controller(self.body, self.wheels)
        self.place(world.start_poses[0].pose)

    def step(self) -> None:
        """Simulate one cycle: set points in, motors, physics, sensors, reports out. Raises hal.bus.BusError."""
        self._cycles += 1
        controller, wheels, body = self.controller, self.wheels, self.body
        controller.receive()
        wheels.turn(*controller.commands)
        if self.lifted:
            body.rest()
        else:
            body.move(wheels.left_m_s, wheels.right_m_s)
        pose = body.pose
        self._collisions.update(body.touching)
        self._pressed = self.bumpers.pressed(body.contacts()) if body.touching else 0
        controller.update_readings(self.infrared.measure(pose), self.infrared.counts)
        if self._cycles % _LAPS_EVERY_CYCLES == 0:
            self._progress.update(*pose)
        controller.send(*wheels.take_ticks(), self._pressed)

    def follow(self, poses: Sequence[Pose]) -> None:
        """Be at the last of these poses, one for each cycle that was simulated in a batch.

        The robot drives no more itself: its place and its progress along walls go on; its sensors, wheels and bus do
        not.
        """
        self._passed += poses[-(self._cycles + 1) % _LAPS_EVERY_CYCLES :: _LAPS_EVERY_CYCLES]
        self._cycles += len(poses)
        self._followed = poses[-1]

    def follow_wall(self, side: WallSide) -> None:
        """Count laps with the wall on this side of the robot, from its present place on."""
        if side != self._wall_side:
            self._wall_side = side
            self._placed = self.pose
            self.__dict__.pop("_progress", None)

    @cached_property
    def _progress(self) -> WallProgress:
        # Made when it is asked for: its survey takes as long as all else of a robot in a batch, which needs none.
        progress = WallProgress(self.world, self._width_scale, self._wall_side)
        progress.reset(self._placed)
        return progress

    def carry(self, pose: Pose) -> None:
        """Set the robot to the pose in m and rad at which the batch put it; the way there counts no lap."""
        self._passed.append(_Put(pose))
        self._followed = pose

    def place(self, pose: Pose) -> None:
        """Move the robot to a pose: wheels still, sensors settled, no lap or collision counted."""
        self.wheels.halt()
        self.body.place(pose)
        self._collisions.end_episode()
        self._pressed = 0
        self._placed = pose
        if "_progress" in self.__dict__:
            self._progress.reset(pose)
        self.infrared.measure_all(pose)
        self.controller.update_readings(range(len(self.infrared.counts)), self.infrared.counts)

    @property
    def time_s(self) -> float:
        """Simulated time in s since power-on."""
        return self._cycles * self._cycle_s

    @property
    def pose(self) -> Pose:
        """True pose of the robot, in m and rad."""
        return self.body.pose if self._followed is None else self._followed

    @property
    def wheel_speeds(self) -> WheelSpeeds:
        """True rim speeds of the two sides, in m/s."""
        return WheelSpeeds(self.wheels.left_m_s, self.wheels.right_m_s)

    @property
    def collisions(self) -> int:
        """Number of collisions; touches at most 0.5 s apart count as one."""
        return self._collisions.count

    @property
    def touching(self) -> bool:
        """Return whether the robot touches a wall or obstacle."""
        return self.body.touching

    @property
    def bumped(self) -> bool:
        """Return whether a bumper is pressed."""
        return self._pressed != 0

    @property
    def laps(self) -> float:
        """Progress along walls in laps, positive with the wall on the followed side (`WallProgress`)."""
        for passed in self._passed:
            if isinstance(passed, _Put):
                self._progress.reset(passed.pose)
            else:
                self._progress.update(*passed)
        self._passed.clear()
        return self._progress.laps

    @property
    def lap_m(self) -> float:
        """Length in m of a lap along the outer wall of the room."""
        return self._progress.lap_m

    @property
    def infrared_counts(self) -> tuple[int, ...]:
        """Newest readings of all sensors in counts, in the order of the sensor table."""
        return tuple(self.infrared.counts)

    def state_hash(self) -> str:
        """Return a SHA-256 over all state that motion and readings depend on, except the walls."""
        numbers = (
            *self.body.pose,
            *self.body.velocity,
            *self.body.slip,
            *self.wheels.state,
            *self.controller.commands,
            *self.infrared.due_s,
            self.laps,
        )
        counters = (
            *self.infrared.counts,
            self._cycles,
            self._pressed,
            self._collisions.count,
            self.infrared_noise.drawn,
            self.slip_noise.drawn,
            *self.controller.state,
        )
        return hash_state(numbers, counters)


def hash_state(numbers: Sequence[float], counters: Sequence[int]) -> str:
    """Return the SHA-256 of a simulated robot's state, by which two engines or runs are compared.

    `numbers`: in m, rad and s. `counters`: whole numbers.
    """
    layout = f"<{len(numbers)}d{len(counters)}q"
    return hashlib.sha256(struct.pack(layout, *numbers, *counters)).hexdigest()


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
