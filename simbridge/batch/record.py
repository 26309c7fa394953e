"""State of one robot of a batch as a record.

A function gets the record of its robot, so compiled code passes one pointer, and plain Python reads the same names.
"""

import math
from typing import Annotated, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np

from hal.sensor_signs import SIGNS
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import Floats, Integers, StuckLaw
from simbridge.contracts.batch import MOST_KEPT, TRACED_TICKS
from simbridge.contracts.shared_rules import question_ticks
from simbridge.robot.body import BodyState

STAYS, FROZEN, BROKEN, CROWDED, UNDECIDED = range(5)
"""Reasons that a robot leaves the batch; 0: it stays."""
STRETCH = 500
"""Most ticks in one call of the loop."""
NEAR_FACES, NEAR_POSTS = 64, 16
"""Most faces and posts near a robot."""
MOST_RAYS = 3
MOST_VALUES = 128
"""Most values of a situation, recent and averaged: numpy adds the squares of more values in another order."""
MOST_AREAS = 64
"""Most areas of a world whose borders end a stretch."""
SEEN = 15
"""Sensors that policies look at."""
CANDIDATES = 16
"""RLAs that a search for the nearest one keeps."""
BOX_STATE = len(BodyState._fields)
SLIP_AHEAD, NOISE_AHEAD = 2 * STRETCH, 8 * STRETCH
"""Random numbers that lie ahead of a robot at the begin of a stretch: of slip, of its sensors."""


class Robot:
    """Record of one robot; arrays have the shape that is annotated, in `Sizes` or in numbers."""

    number: int
    """Its index among the robots."""
    tick: int
    at: int
    """Place of the present tick in the stretch."""
    waits: int
    """1 while the physics engine has to move the body in this tick."""
    left: int
    """Reason that the robot must drive on the bus ; 0: none."""
    world: int
    knowledge: int
    """Its first table of RLAs, that of the first behaviour; -1 for a policy."""

    # Body
    x_m: float
    y_m: float
    heading_rad: float
    vx_m_s: float
    vy_m_s: float
    yaw_rad_s: float
    left_slip: float
    right_slip: float
    slip_noise: Annotated[Floats, (SLIP_AHEAD,)]
    """Standard normal numbers ahead."""
    slip_used: int

    last_x_m: float
    """Pose before the present tick, which the engine must agree with."""
    last_y_m: float
    last_heading_rad: float
    last_vx_m_s: float
    """Velocity before the present tick, by which the engine keeps a box around the body."""
    last_vy_m_s: float

    # Box that the engine keeps around the body (simbridge.batch.contacts)
    box: Annotated[Floats, (4,)]
    """Left, lower, right and upper edge in m."""
    box_is_new: int
    """1 if the engine has not met this box yet."""
    box_tick: int
    """Tick in which the engine made the box."""
    box_state: Annotated[Floats, (BOX_STATE,)]
    """State of the body at the end of that tick, in the order of simbridge.robot.body.BodyState."""

    # Contacts, which the engine finds
    moved: Annotated[Floats, (10,)]
    """Pose, velocity, slip, pressed bumpers and touch of the body after a tick for which the robot waited."""
    engine_ticks: int
    """Ticks for which the engine has to move the body still, because it may remember a contact."""
    bumpers: int
    """Bit n set: bumper n is pressed."""
    touching: int
    """1 while the body touches something."""
    free_cycles: int
    """Cycles without a touch, as in simbridge.robot.bumpers.CollisionCounter."""
    collisions: int

    # Wheels
    left_m_s: float
    right_m_s: float
    left_carry: float
    right_carry: float
    left_ticks: int
    """Encoder ticks of the newest cycle."""
    right_ticks: int
    left_told_m_s: float
    """Set point that the motor followed in the newest cycle."""
    right_told_m_s: float
    left_cm_s: int
    """Set point in the last CONTROL frame."""
    right_cm_s: int

    # What is near, and from where the robot is known to be free for `free_m`
    near: Annotated[Floats, (NEAR_FACES, 4)]
    near_count: int
    posts: Annotated[Floats, (NEAR_POSTS, 4)]
    post_count: int
    gathered_x_m: float
    gathered_y_m: float
    free_x_m: float
    free_y_m: float
    free_m: float

    # Infra-red sensors
    counts: Annotated[Integers, ("sensors",)]
    gains: Annotated[Floats, ("sensors",)]
    periods_s: Annotated[Floats, ("sensors",)]
    due_s: Annotated[Floats, ("sensors",)]
    rays: Annotated[Floats, ("sensors", MOST_RAYS, 4)]
    """Start ahead, left and direction ahead, left of each ray of a sensor."""
    ray_count: int
    calendar: Annotated[Integers, ("slots", "sensors")]
    """Sensors that are due in each slot of a ring of cycles."""
    calendar_count: Annotated[Integers, ("slots",)]
    slots: int
    """Slots of the ring that this robot uses."""
    noise: Annotated[Floats, (NOISE_AHEAD,)]
    noise_used: int

    # Watches of sensors
    signs: Annotated[Integers, ("sensors", SIGNS)]
    board: Annotated[Integers, ("sensors",)]
    before: Annotated[Integers, ("sensors",)]
    after: Annotated[Integers, ("sensors",)]
    """Neighbours of each sensor."""
    second_before: Annotated[Integers, ("sensors",)]
    second_after: Annotated[Integers, ("sensors",)]
    """Sensors next to the neighbours."""
    ways_m: Annotated[Floats, ("sensors", 2)]
    """Way past the obstacle of each sensor, across its beam and along it."""
    watch_left_ticks: int
    """Encoder ticks since the last look."""
    watch_right_ticks: int
    driven: int
    """Ticks that the robot has driven."""
    board_still_s: Annotated[Floats, ("boards",)]
    """Time that the sensors of a board repeat themselves."""
    looked_at_s: float

    # Guard
    guarded_left_m_s: float
    guarded_right_m_s: float
    driven_at_s: float
    turned: int
    """1 if the last CONTROL frame let a wheel turn."""
    way_counts: int
    """1 if the last tick counts on the clock of the way; a slow lesson leaves out some."""
    limits: int
    """Limits of the guard that were met in the newest tick, as bits (simbridge.batch.safety)."""

    # Borders (simbridge.batch.borders)
    areas: Annotated[Floats, (MOST_AREAS, 4)]
    """Centre and half extents of each area in m."""
    area_count: int
    area_every: int
    """Ticks between two looks at the robot's position."""
    area_margin_m: float
    area: int
    """Area that the robot is in; -1: none."""
    crossed: int
    """1 if the robot crossed a border in the newest tick, which ends its stretch."""

    # Mind
    kind: int
    """Kind of mind (simbridge.batch.decisions)."""
    behaviour: int
    """Taught behaviour that is wanted, by its index."""
    command: int
    """Action that was commanded last; -1: none."""
    action: int
    """Action that drives; -1: none."""
    action_ticks: int
    """Ticks that the action has driven."""
    turned_m: float
    """Way of each side since a turn began."""
    rla: int
    """RLA whose action drives, by its row in the table; -1: none."""
    sure: int
    """1 if the situation is inside R with a margin (simbridge.contracts.shared_rules)."""
    nearest: int
    """Row of the RLA that was nearest last."""
    seen: Annotated[Floats, (SEEN,)]
    """Distances in m that a policy looks at."""
    situation: Annotated[Floats, (MOST_VALUES,)]
    """Weighted situation."""
    searched: Annotated[Floats, (1, MOST_VALUES)]
    """Weighted situation of the newest search for the nearest RLA (simbridge.batch.matching)."""
    candidates: int
    """RLAs that the search kept; 0: there was none."""
    candidate_row: Annotated[Integers, (CANDIDATES,)]
    candidate_away: Annotated[Floats, (CANDIDATES,)]
    """Their distances from it in counts, ascending."""
    others_away: float
    """Distance from it in counts that no other RLA is nearer than."""

    # Orders of the teacher of a lesson, which hold until its next command (simbridge.batch.teach)
    until: int
    """Tick whose end ends the stretch."""
    stopped: int
    held: int
    """Action that the teacher holds; -1: none."""
    speed_share: float

    # Counts of the whole drive (simbridge.contracts.batch.Tally)
    unknown_ticks: int
    questions: int
    question_left: int
    """Ticks for which the last question stays open; 0: none is (simbridge.contracts.shared_rules)."""
    first_question: int
    first_collision: int
    travelled_m: float
    stuck: int
    """1 if the robot is stuck, which ends its drive."""
    kept: int
    """Positions that were kept for the rule of being stuck."""
    kept_since: int
    """Tick of the first of them."""
    kept_x_m: Annotated[Floats, (MOST_KEPT,)]
    """Ring of the newest ones."""
    kept_y_m: Annotated[Floats, (MOST_KEPT,)]

    # Course of the newest stretch
    track_x_m: Annotated[Floats, (STRETCH,)]
    track_y_m: Annotated[Floats, (STRETCH,)]
    track_heading_rad: Annotated[Floats, (STRETCH,)]
    track_action: Annotated[Integers, (STRETCH,)]
    """-1 where the robot stands and asks."""
    track_begins: Annotated[Integers, (STRETCH,)]
    """1 in the first tick of a question."""
    track_rla: Annotated[Integers, (STRETCH,)]
    track_distance: Annotated[Floats, (STRETCH,)]
    track_collisions: Annotated[Integers, (STRETCH,)]
    track_told_cm_s: Annotated[Integers, (STRETCH, 2)]
    """Set points that the motors followed, left and right."""

    # Readings of a commanded robot in that stretch
    track_counts: Annotated[Integers, (TRACED_TICKS, "sensors")]
    track_left_ticks: Annotated[Integers, (TRACED_TICKS,)]
    track_right_ticks: Annotated[Integers, (TRACED_TICKS,)]
    track_bumpers: Annotated[Integers, (TRACED_TICKS,)]
    track_limits: Annotated[Integers, (TRACED_TICKS,)]


class Sizes(NamedTuple):
    """Lengths of the arrays in a robot's record; slots are the cycles of the sensors' calendar."""

    sensors: int
    slots: int
    boards: int


Robots = np.ndarray[tuple[int], np.dtype[np.record]]
"""Records of all robots, (n,)."""


def empty_robots(count: int, sizes: Sizes) -> Robots:
    """Return the records of so many robots, filled with zeros."""
    fields: list[tuple[str, type, tuple[int, ...]]] = []
    for name, hint in get_type_hints(Robot, include_extras=True).items():
        if get_origin(hint) is Annotated:
            array, shape = get_args(hint)
            number = float if array == Floats else int
            fields.append((name, number, tuple(getattr(sizes, n) if isinstance(n, str) else n for n in shape)))
        else:
            fields.append((name, hint, ()))
    return np.zeros(count, dtype=fields).view(np.recarray)


_question_ticks = compiled(question_ticks)


@compiled
def count_tick(robot: Robot, law: StuckLaw) -> None:
    """Count the present tick of a robot: its question, first collision, way, and whether it is stuck."""
    asks = robot.action < 0
    begins = asks and robot.question_left == 0
    robot.question_left = _question_ticks(robot.question_left, asks, robot.sure != 0, robot.turned != 0)
    robot.track_begins[robot.at] = 1 if begins else 0
    robot.unknown_ticks += 1 if asks else 0
    if begins:
        robot.questions += 1
        if robot.first_question == 0:
            robot.first_question = robot.tick
    if robot.collisions > 0 and robot.first_collision == 0:
        robot.first_collision = robot.tick
    dx, dy = robot.x_m - robot.last_x_m, robot.y_m - robot.last_y_m
    robot.travelled_m += math.sqrt(dx * dx + dy * dy)
    if law.positions > 0 and (robot.tick - robot.kept_since) % law.every_ticks == 0:
        robot.stuck = _stays(robot, law)


@compiled
def restart_window(robot: Robot, law: StuckLaw) -> None:
    """End the question and begin a new window of the rule of being stuck: the robot was put elsewhere in this tick."""
    robot.kept, robot.kept_since, robot.stuck, robot.question_left = 0, robot.tick, 0, 0
    if law.positions > 0:
        _stays(robot, law)


@compiled
def _stays(robot: Robot, law: StuckLaw) -> bool:
    """Keep the position of a robot, and return whether it stayed near it for a whole window."""
    place = robot.kept % law.positions
    robot.kept_x_m[place], robot.kept_y_m[place] = robot.x_m, robot.y_m
    robot.kept += 1
    if robot.kept < law.positions:
        return False
    for i in range(law.positions):
        dx, dy = robot.x_m - robot.kept_x_m[i], robot.y_m - robot.kept_y_m[i]
        if not dx * dx + dy * dy < law.least_m * law.least_m:
            return False
    return True
