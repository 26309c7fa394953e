"""Numbers and tables that all robots of a batch share: laws of the robot, worlds and knowledge."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from behaviors.policies import circle, eight, fleeing, streets, wall_following
from hal.guard_limits import GuardLimits
from hal.infrared_law import InfraredLawNumbers
from hal.sensor_signs import SensorLimits
from simbridge.robot.wheels import SideLaw

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class World(NamedTuple):
    """Walls and posts of all worlds of a batch as arrays, which do not move; the first index is the world."""

    faces: Floats
    """Corner x, y and vector to the next corner, in m, (worlds, faces, 4)."""
    face_count: Integers
    posts: Floats
    """Centre x, y, radius and its square, (worlds, posts, 4)."""
    post_count: Integers
    reach_m: float
    """Longest reach of a ray from the centre of a robot."""


class BodyLaw(NamedTuple):
    """Numbers of the robot's body for the compiled loop, equal for all robots of a batch."""

    cycle_s: float
    track_m: float
    mass_kg: float
    inertia_kg_m2: float
    inverse_mass: float
    inverse_inertia: float
    force_limit_n: float
    torque_limit_n_m: float
    slip_keep: float
    slip_gain: float
    half_length_m: float
    half_width_m: float
    gap_cycles: int
    """Cycles without a touch after which a touch is a new collision."""


class SensorLaw(NamedTuple):
    """Numbers of the infra-red sensors for the compiled loop, equal for all robots of a batch."""

    cycle_s: float
    law: InfraredLawNumbers
    ray_m: float
    recess_m: float
    noise_share: float
    noise_least: float


class WatchLaw(NamedTuple):
    """Numbers of SensorWatch and of the check for a frozen board, for the compiled loop."""

    sensors: SensorLimits
    frozen_s: float
    beams: Floats
    """Sine, cosine and place along and across the beam of each sensor, (sensors, 4), places in m."""
    metres_per_tick: float
    track_m: float


class MindLaw(NamedTuple):
    """Tables of actions and reference policies for the compiled loop, equal for all robots of a batch."""

    minimum_ticks: int
    distance_m: Floats
    """Distance by count, (1024,)."""
    seen: Integers
    """Sensors that a policy looks at, (15,)."""
    metres_per_tick: float
    fixed: Floats
    """Set points of each action in m/s, (actions, 2); those of a turn while it lasts."""
    wanted_m: Floats
    """Way of each side in a turn; infinite for other actions, (actions,)."""
    wall: Integers
    """Places of the front and the back sensor of actions along a wall, (actions, 2); -1 for others."""
    keep: Floats
    """Numbers of such actions (behaviors.keep_distance), (actions, 5)."""
    actions: Integers
    """Action of the repertoire for each answer of the policy."""
    wall_following: wall_following.Thresholds
    fleeing: fleeing.Thresholds
    circle: circle.Thresholds
    eight: eight.Thresholds
    streets: streets.Thresholds
    left_rays: Floats
    """Rays of the sensors at the left side of a robot in streets (behaviors.policies.streets.Rays), (6, 4)."""
    right_rays: Floats
    turns: Integers
    """Turn of each taught behaviour in streets (behaviors.policies.streets.turn_of)."""


class Features(NamedTuple):
    """Features of a situation as arrays, from a `FeatureTable`, for the compiled loop."""

    kind: Integers
    """Kind of each feature (simbridge.batch.decisions)."""
    sensors: Integers
    """Sensors of each feature, (features, sensors)."""
    sensor_count: Integers
    weights: Floats
    average_steps: int
    average_weights: Floats
    """Weights of the averages, (features,); (0,) if they count for nothing."""


class Averages(NamedTuple):
    """Steps of the averages of robots, as in kurt2rt.core.perception; the first index is the robot.

    All arrays are empty if averages count for nothing.
    """

    ring: NDArray[np.int16]
    """Features of the newest steps in counts, (robots, steps, features)."""
    sums: Integers
    """Sums of them, (robots, features)."""
    newest: Integers
    """Place of the next step in the ring, (robots,)."""


class Conditions(NamedTuple):
    """Weighted conditions of all RLAs, with the neighbours of each for the search of the nearest one."""

    values: Floats
    """Weighted conditions in counts, (rows, values); the number of values is a multiple of eight."""
    neighbours: Integers
    """Rows of the same table, the nearest first, which is the row itself; (rows, neighbours)."""
    apart: Floats
    """Their distances from the row in counts, (rows, neighbours); infinite beyond the last one."""
    is_whole: bool
    """True if no sum of squared differences is rounded, as where all values are multiples of half a count."""


class Knowledge(NamedTuple):
    """Taught RLAs of all knowledges of a batch, oldest first in each table; withdrawn ones are left out."""

    first: Integers
    """First row of each table, and the end of the last one, (tables + 1,); a knowledge has a table for each
    behaviour."""
    conditions: Conditions
    radius: Floats
    answer: Integers
    """Row of the RLA that answers for the RLAs of one condition."""
    action: Integers
    features: Features
    mind: int
    """Address of the PythonMind that decides for robots with an CallbackMind; 0: there are none."""


class StuckLaw(NamedTuple):
    """Rule of being stuck for the compiled loop (simbridge.contracts.batch.StuckRule)."""

    every_ticks: int
    positions: int
    """Positions in a window; 0: there is no rule."""
    least_m: float


class Laws(NamedTuple):
    """All numbers and tables for the compiled loop that the robots of a batch share."""

    body: BodyLaw
    side: SideLaw
    ticks_per_speed: float
    sensor: SensorLaw
    watch: WatchLaw
    guard: GuardLimits
    mind: MindLaw
    stuck: StuckLaw
