"""The robot's body in the physics engine: pushed by its wheels, stopped by walls."""

import math
from typing import NamedTuple

import pymunk

from hal.robot_settings import GeometrySettings
from hal.simulation import Pose
from simbridge.geometry import rectangle
from simbridge.noise import Noise
from simbridge.world import ROBOT_KIND, WALL_FRICTION, WALL_KIND, World

SLIP_FRACTION = 0.03
"""Standard deviation of each side's slip."""
SLIP_TIME_S = 0.3
"""Slip comes and goes over patches of floor; our choice."""
_TRACTION_M_S2 = 6.0
"""Rubber on an office floor holds about 0.6 of the weight: harder than the motors brake, so only walls use it up."""


class Contact(NamedTuple):
    """One point where a wall touches the body, in the body's frame, and the direction in which the wall lies."""

    x_m: float
    y_m: float
    toward_x: float
    toward_y: float


class Body:
    """A box of mass, inertia and outline. It moves as its wheels roll unless a wall stands in the way.

    Wheels pull by a force that is as large as needed for the rolling speed and never larger than the tyres hold. The
    engine adds it before it resolves contacts, so a wall stops the body and the speed after a step is the real one.
    """

    def __init__(self, world: World, geometry: GeometrySettings, cycle_s: float, noise: Noise) -> None:
        self._space = world.space
        self._cycle_s = cycle_s
        self._noise = noise
        self._track_m = geometry.effective_track_m
        self._mass_kg = geometry.mass_kg
        self._inertia_kg_m2 = geometry.yaw_inertia_kg_m2
        self._force_limit_n = geometry.mass_kg * _TRACTION_M_S2
        self._torque_limit_n_m = self._force_limit_n * geometry.outline_length_m / 2
        self._slip_keep = math.exp(-cycle_s / SLIP_TIME_S)
        self._slip_gain = SLIP_FRACTION * math.sqrt(1.0 - self._slip_keep**2)
        self._left_slip = 0.0
        self._right_slip = 0.0
        self._points: list[pymunk.ContactPointSet] = []
        self.pose = Pose(0.0, 0.0, 0.0)
        """Where it is after the last cycle."""
        self._body = pymunk.Body(geometry.mass_kg, geometry.yaw_inertia_kg_m2)
        corners = rectangle((0.0, 0.0), geometry.outline_length_m, geometry.outline_width_m, 0.0)
        self._shape = pymunk.Poly(self._body, corners)
        self._shape.friction = WALL_FRICTION
        self._shape.collision_type = ROBOT_KIND
        self._space.add(self._body, self._shape)
        self._space.on_collision(ROBOT_KIND, WALL_KIND, post_solve=self._note_contact)

    def move(self, left_m_s: float, right_m_s: float) -> None:
        """One cycle with the wheels' rims at these speeds."""
        keep, gain, normal = self._slip_keep, self._slip_gain, self._noise.normal
        self._left_slip = left_slip = keep * self._left_slip + gain * normal()
        self._right_slip = right_slip = keep * self._right_slip + gain * normal()
        left_m_s *= 1.0 + left_slip
        right_m_s *= 1.0 + right_slip
        forward_m_s = (left_m_s + right_m_s) / 2
        yaw_rad_s = (right_m_s - left_m_s) / self._track_m
        body, cycle_s = self._body, self._cycle_s
        turning_rad_s = body.angular_velocity
        # The force acts on the way of the next cycle: aim along the heading of its middle.
        heading_rad = self.pose.heading_rad + (turning_rad_s + yaw_rad_s / 2) * cycle_s
        velocity_x, velocity_y = body.velocity
        force_x = (forward_m_s * math.cos(heading_rad) - velocity_x) * self._mass_kg / cycle_s
        force_y = (forward_m_s * math.sin(heading_rad) - velocity_y) * self._mass_kg / cycle_s
        force_n = math.hypot(force_x, force_y)
        if force_n > self._force_limit_n:
            force_x *= self._force_limit_n / force_n
            force_y *= self._force_limit_n / force_n
        torque_n_m = (yaw_rad_s - turning_rad_s) * self._inertia_kg_m2 / cycle_s
        if abs(torque_n_m) > self._torque_limit_n_m:
            torque_n_m = math.copysign(self._torque_limit_n_m, torque_n_m)
        body.force = (force_x, force_y)
        body.torque = torque_n_m
        if self._points:
            self._points.clear()
        self._space.step(cycle_s)
        x_m, y_m = body.position
        self.pose = Pose(x_m, y_m, body.angle)

    def place(self, pose: Pose) -> None:
        """Put it down somewhere else, standing."""
        body = self._body
        body.position = (pose.x_m, pose.y_m)
        body.angle = pose.heading_rad
        self.pose = pose
        self.rest()
        self._space.reindex_shapes_for_body(body)

    def rest(self) -> None:
        """One cycle without touching anything, wherever the wheels turn."""
        self._body.velocity = (0.0, 0.0)
        self._body.angular_velocity = 0.0
        self._points.clear()

    @property
    def velocity(self) -> tuple[float, float, float]:
        """Speed over ground in x and y of the world (m/s), and yaw rate (rad/s)."""
        x_m_s, y_m_s = self._body.velocity
        return x_m_s, y_m_s, self._body.angular_velocity

    @property
    def slip(self) -> tuple[float, float]:
        """Share by which each side's wheels slip now."""
        return self._left_slip, self._right_slip

    @property
    def touching(self) -> bool:
        """True while a wall touches it."""
        return bool(self._points)

    def contacts(self) -> list[Contact]:
        """Where walls touch it in this cycle."""
        x_m, y_m, heading_rad = self.pose
        cos, sin = math.cos(heading_rad), math.sin(heading_rad)
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

    def _note_contact(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:  # noqa: ARG002
        # The engine's callback cannot raise: only note, think later.
        self._points.append(arbiter.contact_point_set)
