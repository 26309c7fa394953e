"""World of a simulation for a teacher who sees and changes it from above (contracts.simulation.SimulatedWorld)."""

import shapely

from hal.robot_settings import GeometrySettings
from simbridge.contracts.simulation import Pose, SimulatedPlace, SimulatedPost, Street, Wall, WorldPlan
from simbridge.contracts.world_refusal import WorldRefusal, WorldRefusedError
from simbridge.realtime import RealtimeSimulation
from simbridge.simulated_robot import SimulatedRobot
from simbridge.worlds.geometry import rectangle
from simbridge.worlds.world_settings import WorldSettings


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
