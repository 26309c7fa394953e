"""Bodies of a batch at walls: there the physics engine moves the body, as it does on the CAN bus."""

import math

import numpy as np
from numpy.typing import NDArray

from simbridge.batch.compiled import compiled
from simbridge.batch.laws import BodyLaw, Integers
from simbridge.batch.record import Robot
from simbridge.contracts.batch import BatchRefusedError
from simbridge.contracts.simulation import Pose
from simbridge.robot.body import BodyState
from simbridge.simulated_robot import SimulatedKurt2

REMEMBERED_TICKS = 5
"""Ticks without a touch after which the engine has forgotten a contact; it keeps one for three steps."""


class ContactBody:
    """Body of one robot in the engine, which lags behind until it may touch something.

    The engine's answer depends on the order in which it met the walls. So the body drives all ticks that it lagged
    behind with the set points of then, and agrees with the free motion of the compiled loop to the last bit.
    """

    def __init__(self, simulated: SimulatedKurt2) -> None:
        """Take the body, the wheels and the bumpers of a simulated robot that has not driven yet."""
        self._body, self._wheels, self._bumpers = simulated.body, simulated.wheels, simulated.bumpers

    def move(self, record: np.record, behind: Integers) -> tuple[float, ...]:
        """Move the body through the ticks that it lags behind and the present one; return `Robot.moved`.

        Args:
            record: of the robot, in the tick for which it waits.
            behind: set points of those ticks, left and right, in cm/s, (n, 2); the last ones are of the present tick.

        Raises:
            BatchRefusedError: engine and compiled loop do not agree on this machine.
        """
        *missed, present = self._left_out(record, behind).tolist()
        for left_cm_s, right_cm_s in missed:
            self._step(left_cm_s, right_cm_s)
        body = self._body
        if body.pose != (record["last_x_m"], record["last_y_m"], record["last_heading_rad"]):
            raise BatchRefusedError("the physics engine moves a free robot otherwise here", do="give --engine can")
        self._step(*present)
        pressed = self._bumpers.pressed(body.contacts()) if body.touching else 0
        return (*body.pose, *body.velocity, *body.slip, pressed, body.touching)

    def put(self, pose: Pose, record: np.record, behind: Integers) -> None:
        """Put the body at a pose in m and rad near the one before, wheels still; it drives what it lags behind first.

        `record`: of the robot, at its old pose. `behind`: set points of ticks that it lags behind, in cm/s, (n, 2).
        """
        for left_cm_s, right_cm_s in self._left_out(record, behind).tolist():
            self._step(left_cm_s, right_cm_s)
        self._body.place(pose)
        self._wheels.halt()

    def _left_out(self, record: np.record, behind: Integers) -> Integers:
        """Jump to the newest box around the body, and return the set points of the ticks since then."""
        if not record["box_is_new"]:
            return behind
        state = BodyState(*record["box_state"].tolist())
        cycles = len(behind) - (int(record["tick"]) - int(record["box_tick"]))
        self._body.jump(cycles, state)
        self._wheels.run_at(state.left_m_s, state.right_m_s)
        return behind[cycles:]

    def _step(self, left_cm_s: int, right_cm_s: int) -> None:
        self._wheels.turn(left_cm_s / 100.0, right_cm_s / 100.0)
        self._body.move(self._wheels.left_m_s, self._wheels.right_m_s)


class SetPoints:
    """Set points of past stretches that the lagging body of a robot has yet to drive (`ContactBody`)."""

    def __init__(self) -> None:
        self._stretches: list[tuple[dict[int, int], NDArray[np.int16], NDArray[np.int64], NDArray[np.int64]]] = []
        self._taken: dict[int, int] = {}
        """Stretches that each robot has caught up with."""

    def add(
        self,
        robots: NDArray[np.int64],
        told_cm_s: NDArray[np.int16],
        driven: NDArray[np.int64],
        ends: NDArray[np.int64],
    ) -> None:
        """Add a stretch.

        Args:
            robots: of the stretch, (n,).
            told_cm_s: their set points in cm/s, left and right, (n, ticks, 2).
            driven: ticks of the stretch that the body of each robot has driven already, (n,).
            ends: ticks of the stretch that each robot has driven, (n,).
        """
        self._stretches.append(({r: place for place, r in enumerate(robots.tolist())}, told_cm_s, driven, ends))

    def take(self, robot: int, present: Integers) -> Integers:
        """Return the set points in cm/s that the body of a robot has not driven yet; they are not returned again.

        `present`: those of the present stretch, which follow; (n, 2), as all.
        """
        begin, self._taken[robot] = self._taken.get(robot, 0), len(self._stretches)
        behind: list[NDArray[np.int16]] = []
        for places, told_cm_s, driven, ends in self._stretches[begin:]:
            place = places.get(robot)
            if place is None:  # the robot did not drive in this stretch
                continue
            behind.append(told_cm_s[place, driven[place] : ends[place]])
        return np.concatenate((*behind, present))


_WIDER = 0.1
"""Part of a box's size by which the engine's box is wider, and time in s of the velocity that it foresees."""


@compiled
def keep_box(robot: Robot, law: BodyLaw) -> bool:
    """Renew the engine's box round a body that has left it; return whether it did. Call it at the end of a tick.

    The engine lists the walls near this box, and their order decides how it resolves contacts.
    """
    cos, sin = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
    left, lower, right, upper = math.inf, math.inf, -math.inf, -math.inf
    for corner in range(4):
        ahead_m = law.half_length_m if corner < 2 else -law.half_length_m
        aside_m = law.half_width_m if corner % 2 == 0 else -law.half_width_m
        x_m = cos * ahead_m - sin * aside_m + robot.x_m
        y_m = sin * ahead_m + cos * aside_m + robot.y_m
        left, right = min(left, x_m), max(right, x_m)
        lower, upper = min(lower, y_m), max(upper, y_m)
    box = robot.box
    if box[0] <= left and box[1] <= lower and box[2] >= right and box[3] >= upper:
        return False
    wide, high = (right - left) * _WIDER, (upper - lower) * _WIDER
    foreseen_x_m, foreseen_y_m = robot.last_vx_m_s * _WIDER, robot.last_vy_m_s * _WIDER
    box[0], box[1] = left + min(-wide, foreseen_x_m), lower + min(-high, foreseen_y_m)
    box[2], box[3] = right + max(wide, foreseen_x_m), upper + max(high, foreseen_y_m)
    _keep_state(robot)
    return True


@compiled
def leave_engine(robot: Robot, law: BodyLaw) -> None:
    """Enter the state of a body that the engine has moved, for which its robot waited; the engine knows its box."""
    moved = robot.moved
    robot.waits = 0
    robot.x_m, robot.y_m, robot.heading_rad = moved[0], moved[1], moved[2]
    robot.vx_m_s, robot.vy_m_s, robot.yaw_rad_s = moved[3], moved[4], moved[5]
    robot.left_slip, robot.right_slip = moved[6], moved[7]
    robot.bumpers, robot.touching = int(moved[8]), int(moved[9])
    if robot.touching:
        robot.collisions += 1 if robot.free_cycles > law.gap_cycles else 0
        robot.free_cycles, robot.engine_ticks = 0, REMEMBERED_TICKS
    else:
        robot.free_cycles, robot.engine_ticks = robot.free_cycles + 1, max(0, robot.engine_ticks - 1)
    keep_box(robot, law)
    robot.box_is_new = 0


@compiled
def _keep_state(robot: Robot) -> None:
    """Remember the state of the body in which the engine makes its box."""
    robot.box_is_new, robot.box_tick = 1, robot.tick
    state = robot.box_state
    state[0], state[1], state[2] = robot.x_m, robot.y_m, robot.heading_rad
    state[3], state[4] = robot.last_vx_m_s, robot.last_vy_m_s
    state[5], state[6], state[7] = robot.vx_m_s, robot.vy_m_s, robot.yaw_rad_s
    state[8], state[9] = robot.left_slip, robot.right_slip
    state[10], state[11] = robot.left_m_s, robot.right_m_s
