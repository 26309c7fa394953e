"""Simulated robot in real time: in a thread, as hardware for another process, and in a world that a teacher changes."""

import random
import threading
import time
from collections import deque
from collections.abc import Callable
from types import TracebackType
from typing import Self

import shapely

from hal.robot_settings import GeometrySettings
from simbridge.contracts.simulation import Pose, SimulatedPlace, SimulatedPost, Street, Wall, WorldPlan
from simbridge.contracts.world_refusal import WorldRefusal, WorldRefusedError
from simbridge.links import RobotEnd
from simbridge.simulated_robot import SimulatedRobot
from simbridge.worlds.geometry import rectangle
from simbridge.worlds.world_settings import WorldSettings


class RealtimeSimulation:
    """Thread that steps a robot on absolute monotonic deadlines; missed cycles are skipped and counted.

    An error ends the thread, shows in `error`, and is raised by `stop` and by leaving the with block.
    """

    def __init__(self, robot: SimulatedRobot, cycle_s: float = 0.01) -> None:
        self._robot = robot
        self._cycle_ns = round(cycle_s * 1e9)
        self._stopping = threading.Event()
        self._jobs: deque[Callable[[], object]] = deque()
        self._stepping = threading.Lock()
        self._held = False
        self._thread = threading.Thread(target=self._run, name="simulated-robot", daemon=True)
        self.missed_cycles = 0
        self.error: Exception | None = None
        """Error that ended the thread, if any."""

    def start(self) -> None:
        """Start the thread; call this once."""
        self._thread.start()

    def stop(self) -> None:
        """Stop and join the thread, and raise the error that ended it before, if any."""
        self._end()
        if self.error is not None:
            raise self.error

    def submit(self, job: Callable[[], object]) -> None:
        """Run a job in the stepping thread before its next step; callable from any thread. An error ends the thread."""
        self._jobs.append(job)

    def hold(self) -> None:
        """Suspend the thread; the caller steps the simulation until `go_on`."""
        with self._stepping:
            self._held = True

    def step(self) -> None:
        """Step once in the caller's thread; call it only between `hold` and `go_on`."""
        while self._jobs:
            self._jobs.popleft()()
        self._robot.step()

    def go_on(self) -> None:
        """Resume the thread after `hold`."""
        with self._stepping:
            self._held = False

    def wait(self, timeout_s: float) -> bool:
        """Wait up to `timeout_s` for the thread's end; return whether it has ended."""
        self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()
        # The body's own error came first, so it wins.
        if error is None and self.error is not None:
            raise self.error

    def _end(self) -> None:
        self._stopping.set()
        if self._thread.ident is not None:
            self._thread.join()

    def _run(self) -> None:
        try:
            self._pace()
        except Exception as error:  # noqa: BLE001  # raised again by stop, in the caller's thread
            self.error = error

    def _pace(self) -> None:
        deadline_ns = time.monotonic_ns()
        while True:
            deadline_ns += self._cycle_ns
            late_ns = time.monotonic_ns() - deadline_ns
            if late_ns > self._cycle_ns:
                missed = late_ns // self._cycle_ns
                self.missed_cycles += missed
                deadline_ns += missed * self._cycle_ns
            if self._stopping.wait(max(0.0, (deadline_ns - time.monotonic_ns()) / 1e9)):
                return
            with self._stepping:
                if not self._held:
                    self.step()


class StandaloneRobot:
    """Simulated robot of `kurt2rt sim`, in real time at its own end of a link, whose loss it survives."""

    def __init__(
        self, world: WorldSettings, end: RobotEnd, seed: int, *, start: int | None = None, cycle_s: float = 0.01
    ) -> None:
        """Place a robot in a world, at its end of a link.

        Args: `seed` selects sensors, noise and, if `start` is None, the start pose; `start` counts from 1. `cycle_s`:
        duration of a cycle in s.
        """
        self.end = end
        chance = random.Random(f"on a bus in world {world.name}, seed {seed}")
        self.robot = end.simulate(world, chance.getrandbits(32), seed)
        starts = [each.pose for each in world.start_poses]
        self.robot.place(chance.choice(starts) if start is None else starts[start - 1])
        self.simulation = RealtimeSimulation(self.robot, cycle_s)

    def __enter__(self) -> Self:
        self.simulation.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.simulation.__exit__(kind, error, trace)
        finally:
            self.end.close()


def plan_of(world: WorldSettings, version: int = 0) -> WorldPlan:
    """Return a world from above; `version`: number of changes since the run began."""
    walls = [Wall(each.name, each.corners) for each in world.walls]
    walls += [Wall(each.name, each.corners) for each in world.polygon_obstacles]
    return WorldPlan(
        version=version,
        name=world.name,
        size_m=world.size_m,
        outline=world.outline,
        walls=tuple(walls),
        posts=tuple(SimulatedPost(each.name, each.x_m, each.y_m, each.radius_m) for each in world.round_obstacles),
        streets=tuple(Street(each.from_m, each.to_m, each.width_m) for each in world.streets),
        junctions=tuple(world.junctions),
    )


class RealtimeWorld:
    """World of a running simulation that a teacher can change; the simulation's thread makes the changes."""

    def __init__(
        self, robot: SimulatedRobot, world: WorldSettings, geometry: GeometrySettings, simulation: RealtimeSimulation
    ) -> None:
        self._robot = robot
        self._world = world
        self._geometry = geometry
        self._simulation = simulation
        self._version = 0
        self._start = robot.pose

    @property
    def held_world(self) -> RealtimeSimulation:
        """Thread of the simulation, for a clock that holds and steps it."""
        return self._simulation

    @property
    def lives(self) -> bool:
        """Return whether the simulation runs."""
        return self._simulation.error is None

    def place(self) -> SimulatedPlace:
        """Return the robot's pose and counters."""
        pose = self._robot.pose
        return SimulatedPlace(
            pose.x_m, pose.y_m, pose.heading_rad, self._robot.laps, self._robot.collisions, self._version
        )

    def world(self) -> WorldPlan:
        """Return the plan of the world, with all moves of walls so far, also those that the next step applies."""
        return plan_of(self._world, self._version)

    def move_wall(self, name: str, dx_m: float, dy_m: float) -> None:
        """Shift a wall or obstacle by (dx_m, dy_m), in m.

        Raises WorldRefusedError for an unknown name, or if it would lie on the robot.
        """
        world = self._world.moved(name, dx_m, dy_m)
        if self._stands_on_robot(world, name):
            raise WorldRefusedError(WorldRefusal.WALL_ON_ROBOT, name=name)
        self._world = world
        self._version += 1
        self._simulation.submit(lambda: self._robot.world.move_wall(name, dx_m, dy_m))

    def put_robot(self, x_m: float, y_m: float, heading_rad: float) -> None:
        """Put the robot, wheels still, at a pose in m and rad. Raises WorldRefusedError if it does not fit there."""
        pose = Pose(x_m, y_m, heading_rad)
        if self._world.clearance_m(pose, self._geometry) == 0.0:
            raise WorldRefusedError(WorldRefusal.NO_ROOM)
        self._simulation.submit(lambda: self._robot.place(pose))

    def put_robot_back(self) -> None:
        """Put the robot where the run began, wheels still. Raises WorldRefusedError if it does not fit there now."""
        if self._world.clearance_m(self._start, self._geometry) == 0.0:
            raise WorldRefusedError(WorldRefusal.START_BLOCKED)
        self._simulation.submit(lambda: self._robot.place(self._start))

    def _stands_on_robot(self, world: WorldSettings, name: str) -> bool:
        # Only this one: a robot that leans against another wall must not nail down all of them.
        pose, geometry = self._robot.pose, self._geometry
        body = shapely.Polygon(
            rectangle((pose.x_m, pose.y_m), geometry.outline_length_m, geometry.outline_width_m, pose.heading_rad)
        )
        corners = [each.corners for each in world.walls if each.name == name]
        corners += [each.corners for each in world.polygon_obstacles if each.name == name]
        posts = [each for each in world.round_obstacles if each.name == name]
        return any(body.intersects(shapely.Polygon(each)) for each in corners) or any(
            body.distance(shapely.Point(each.x_m, each.y_m)) <= each.radius_m for each in posts
        )
