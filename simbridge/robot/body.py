"""Rigid body of the robot in the physics engine."""

import math
from collections.abc import Callable
from typing import NamedTuple

import pymunk

from hal.numerics import cos_sin, round_portable
from hal.robot_settings import GeometrySettings
from simbridge.contracts.simulation import Pose
from simbridge.robot.noise import Noise
from simbridge.robot.world import ROBOT_KIND, WALL_FRICTION, WALL_KIND, World
from simbridge.worlds.geometry import rectangle

SLIP_FRACTION = 0.03
"""Standard deviation of each side's slip ratio."""
SLIP_TIME_S = 0.3
"""Correlation time of slip: patches of floor; our choice."""
_set_force: Callable[[pymunk.Body, tuple[float, float]], None] = vars(pymunk.Body)["force"].__set__
_set_torque: Callable[[pymunk.Body, float], None] = vars(pymunk.Body)["torque"].__set__
"""Setters of a body: an assignment takes three times as long, by way of a hook for type checkers."""
_FAR_M = 1e4
_TRACTION_M_S2 = 6.0
"""Traction of rubber on an office floor, 0.6 g; the motors brake less, so only walls exhaust it."""


class Contact(NamedTuple):
    """Point at which the body touches a wall, and the unit vector towards the wall, in the body's frame."""

    x_m: float
    y_m: float
    toward_x: float
    toward_y: float


class BodyState(NamedTuple):
    """State of a free body and its wheels at the end of a cycle, from which a body in the engine can go on."""

    x_m: float
    y_m: float
    heading_rad: float
    from_vx_m_s: float
    """Velocity before the cycle, by which the engine made its box around the body."""
    from_vy_m_s: float
    vx_m_s: float
    vy_m_s: float
    yaw_rad_s: float
    left_slip: float
    right_slip: float
    left_m_s: float
    """Rim speed of the left wheels."""
    right_m_s: float


class Body:
    """Box with mass and inertia that follows its rolling wheels unless a wall blocks it.

    The wheels' force makes up for the difference to the rolling speed, limited by traction. It is added before the
    engine resolves contacts, so a wall stops the body, and the speed after a step is the true one.
    """

    def __init__(self, world: World, geometry: GeometrySettings, cycle_s: float, noise: Noise) -> None:
        self._space = world.space
        self._cycle_s = cycle_s
        self._noise = noise
        self._track_m = geometry.effective_track_m
        self._mass_kg = geometry.mass_kg
        self._inertia_kg_m2 = geometry.yaw_inertia_kg_m2
        self.force_limit_n = geometry.mass_kg * _TRACTION_M_S2
        self.torque_limit_n_m = self.force_limit_n * geometry.outline_length_m / 2
        self.slip_keep = round_portable(math.exp(-cycle_s / SLIP_TIME_S))
        self.slip_gain = SLIP_FRACTION * math.sqrt(1.0 - self.slip_keep * self.slip_keep)
        self._left_slip = 0.0
        self._right_slip = 0.0
        self._points: list[pymunk.ContactPointSet] = []
        self.pose = Pose(0.0, 0.0, 0.0)
        """Pose after the last cycle."""
        self._body = pymunk.Body(geometry.mass_kg, geometry.yaw_inertia_kg_m2)
        corners = rectangle((0.0, 0.0), geometry.outline_length_m, geometry.outline_width_m, 0.0)
        self._shape = pymunk.Poly(self._body, corners)
        self._shape.friction = WALL_FRICTION
        self._shape.collision_type = ROBOT_KIND
        self._space.add(self._body, self._shape)
        self._space.on_collision(ROBOT_KIND, WALL_KIND, post_solve=self._store_contact)

    def move(self, left_m_s: float, right_m_s: float) -> None:
        """Simulate one cycle with these rim speeds in m/s."""
        keep, gain, normal = self.slip_keep, self.slip_gain, self._noise.normal
        self._left_slip = left_slip = keep * self._left_slip + gain * normal()
        self._right_slip = right_slip = keep * self._right_slip + gain * normal()
        left_m_s *= 1.0 + left_slip
        right_m_s *= 1.0 + right_slip
        forward_m_s = (left_m_s + right_m_s) / 2
        yaw_rad_s = (right_m_s - left_m_s) / self._track_m
        body, cycle_s = self._body, self._cycle_s
        turning_rad_s = body.angular_velocity
        # The force acts during the next cycle: aim along the heading at its middle.
        heading_rad = self.pose.heading_rad + (turning_rad_s + yaw_rad_s / 2) * cycle_s
        velocity_x, velocity_y = body.velocity
        cos, sin = cos_sin(heading_rad)
        force_x = (forward_m_s * cos - velocity_x) * self._mass_kg / cycle_s
        force_y = (forward_m_s * sin - velocity_y) * self._mass_kg / cycle_s
        force_n = math.hypot(force_x, force_y)
        if force_n > self.force_limit_n:
            force_x *= self.force_limit_n / force_n
            force_y *= self.force_limit_n / force_n
        torque_n_m = (yaw_rad_s - turning_rad_s) * self._inertia_kg_m2 / cycle_s
        if abs(torque_n_m) > self.torque_limit_n_m:
            torque_n_m = math.copysign(self.torque_limit_n_m, torque_n_m)
        _set_force(body, (force_x, force_y))
        _set_torque(body, torque_n_m)
        if self._points:
            self._points.clear()
        self._space.step(cycle_s)
        x_m, y_m = body.position
        self.pose = Pose(x_m, y_m, body.angle)

    def place(self, pose: Pose) -> None:
        """Move the body to a pose, at rest."""
        body = self._body
        body.position = (pose.x_m, pose.y_m)
        body.angle = pose.heading_rad
        self.pose = pose
        self.rest()
        self._space.reindex_shapes_for_body(body)

    def jump(self, cycles: int, state: BodyState) -> None:
        """Be in a state after so many cycles that were left out, in the last of which the engine made a new box.

        The engine keeps the walls near a box in a list, until the body leaves the box. So this list is the same.
        """
        body = self._body
        self._noise.normals(2 * cycles)
        self._left_slip, self._right_slip = state.left_slip, state.right_slip
        for x_m in (state.x_m + _FAR_M, state.x_m):  # far away, so that the engine makes a new box in any case
            body.position, body.angle = (x_m, state.y_m), state.heading_rad
            body.velocity = (state.from_vx_m_s, state.from_vy_m_s)
            self._space.reindex_shapes_for_body(body)
        body.velocity, body.angular_velocity = (state.vx_m_s, state.vy_m_s), state.yaw_rad_s
        self.pose = Pose(state.x_m, state.y_m, state.heading_rad)
        self._points.clear()

    def rest(self) -> None:
        """Simulate one cycle at rest without contacts."""
        self._body.velocity = (0.0, 0.0)
        self._body.angular_velocity = 0.0
        self._points.clear()

    @property
    def velocity(self) -> tuple[float, float, float]:
        """World-frame velocity: x and y in m/s, yaw rate in rad/s."""
        x_m_s, y_m_s = self._body.velocity
        return x_m_s, y_m_s, self._body.angular_velocity

    @property
    def slip(self) -> tuple[float, float]:
        """Slip ratios of the left and the right side, dimensionless."""
        return self._left_slip, self._right_slip

    @property
    def touching(self) -> bool:
        """Return whether the body touched a wall or obstacle in this cycle."""
        return bool(self._points)

    def contacts(self) -> list[Contact]:
        """Return the contact points of the body with walls and obstacles in this cycle."""
        x_m, y_m, heading_rad = self.pose
        cos, sin = cos_sin(heading_rad)
        found = []
        for touching in self._points:
            toward_x, toward_y = touching.normal
            for point in touching.points:
                dx, dy = point.point_a.x - x_m, point.point_a.y - y_m
                found.append(
                    Contact(
                        dx * cos + dy * sin,
                        dy * cos - dx * sin,
                        toward_x * cos + toward_y * sin,
                        toward_y * cos - toward_x * sin,
                    )
                )
        return found

    def _store_contact(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:  # noqa: ARG002
        # The engine's callback cannot raise, so it only stores the contact.
        self._points.append(arbiter.contact_point_set)
