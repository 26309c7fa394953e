"""Bodies of a batch at walls: there the physics engine moves the body, as it does on the CAN bus."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simbridge.batch.compiled import compiled
from simbridge.batch.laws import BodyLaw
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

    def move(self, record: np.record, behind: Sequence[tuple[int, int]], gap_cycles: int) -> None:
        """Move the body through the ticks that it lags behind and the present one, and enter what it met.

        Args:
            record: of the robot, in the tick for which it waits.
            behind: set points of those ticks, left and right, in cm/s; the last ones are of the present tick.
            gap_cycles: cycles without a touch after which a touch is a new collision.

        Raises:
            BatchRefusedError: engine and compiled loop do not agree on this machine.
        """
        *missed, present = self._left_out(record, behind)
        for left_cm_s, right_cm_s in missed:
            self._step(left_cm_s, right_cm_s)
        if self._body.pose != (record["last_x_m"], record["last_y_m"], record["last_heading_rad"]):
            raise BatchRefusedError("the physics engine moves a free robot otherwise here", do="give --engine can")
        self._step(*present)
        body = self._body
        record["x_m"], record["y_m"], record["heading_rad"] = body.pose
        record["vx_m_s"], record["vy_m_s"], record["yaw_rad_s"] = body.velocity
        record["left_slip"], record["right_slip"] = body.slip
        record["box_is_new"] = 0
        record["bumpers"], record["touching"] = 0, body.touching
        remembers = int(record["engine_ticks"])
        if body.touching:
            record["bumpers"] = self._bumpers.pressed(body.contacts())
            record["collisions"] += record["free_cycles"] > gap_cycles
            record["free_cycles"] = 0
            record["engine_ticks"] = REMEMBERED_TICKS
        else:
            record["free_cycles"] += 1
            record["engine_ticks"] = max(0, remembers - 1)

    def put(self, pose: Pose, record: np.record, behind: Sequence[tuple[int, int]]) -> None:
        """Put the body at a pose in m and rad near the one before, wheels still; it drives what it lags behind first.

        `record`: of the robot, still at its old pose. `behind`: set points of the ticks that it lags behind, in cm/s.
        """
        for left_cm_s, right_cm_s in self._left_out(record, behind):
            self._step(left_cm_s, right_cm_s)
        self._body.place(pose)
        self._wheels.halt()

    def _left_out(self, record: np.record, behind: Sequence[tuple[int, int]]) -> Sequence[tuple[int, int]]:
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

    def take(self, robot: int) -> list[tuple[int, int]]:
        """Return the set points in cm/s that the body of a robot has not driven yet; they are not returned again."""
        begin, self._taken[robot] = self._taken.get(robot, 0), len(self._stretches)
        behind: list[tuple[int, int]] = []
        for places, told_cm_s, driven, ends in self._stretches[begin:]:
            place = places.get(robot)
            if place is None:  # the robot did not drive in this stretch
                continue
            behind += map(tuple, told_cm_s[place, driven[place] : ends[place]].tolist())
        return behind


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
def meet_box(robot: Robot, law: BodyLaw) -> None:
    """Keep the box of a body that the engine has moved, for which its robot waited; the engine knows this box."""
    robot.waits = 0
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
