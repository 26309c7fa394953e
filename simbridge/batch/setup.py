"""State and laws of a batch, from simulated robots on the CAN bus that have not driven yet."""

import math
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

from behaviors.policies import circle, eight, fleeing, streets, wall_following
from behaviors.policies.distances import (
    FRONT,
    FRONT_LEFT_EDGE,
    FRONT_RIGHT_EDGE,
    LEFT_FRONT_TO_BACK,
    REAR_LEFT_EDGE,
    REAR_RIGHT_EDGE,
    RIGHT_FRONT_TO_BACK,
)
from hal.guard_limits import limits_of
from hal.kurt2_settings import Kurt2Settings
from hal.robot import HIGHEST_COUNTS
from hal.sensor_ring import neighbours_of
from hal.sensor_signs import NO_SIGNS, beam_of, sensor_limits
from simbridge.batch.borders import OUTSIDE
from simbridge.batch.contacts import keep_box
from simbridge.batch.laws import BodyLaw, Floats, Laws, MindLaw, SensorLaw, StuckLaw, WatchLaw, World
from simbridge.batch.record import Robots, Sizes, empty_robots
from simbridge.batch.tables import kind_of
from simbridge.contracts.batch import STANDS, Action, DriveSettings, FixedSpeeds, Mind, PolicyMind, Turn, WallDistance
from simbridge.robot.body import Body
from simbridge.robot.bumpers import CollisionCounter
from simbridge.robot.infrared import RECESS_M, InfraredSensors
from simbridge.robot.ray_caster import faces_of
from simbridge.simulated_robot import SimulatedKurt2
from simbridge.worlds.world_settings import WorldSettings

_LOOKS = (
    *FRONT,
    *(FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE),
    *LEFT_FRONT_TO_BACK,
    *RIGHT_FRONT_TO_BACK,
    *(REAR_LEFT_EDGE, REAR_RIGHT_EDGE),
)
"""Sensors that policies look at, in the order of `simbridge.batch.decisions.policy_answer`."""

_ThresholdsT = TypeVar(
    "_ThresholdsT",
    wall_following.Thresholds,
    fleeing.Thresholds,
    circle.Thresholds,
    eight.Thresholds,
    streets.Thresholds,
)


def build_laws(robot: Kurt2Settings, one: SimulatedKurt2, minds: Sequence[Mind], settings: DriveSettings) -> Laws:
    """Return the numbers that all robots of a batch share, read from settings and `one` simulated robot."""
    cycle_s = robot.cycle_s
    return Laws(
        body=build_body_law(robot, one.body),
        side=one.wheels.law,
        ticks_per_speed=one.wheels.ticks_per_speed,
        sensor=SensorLaw(
            cycle_s=cycle_s,
            law=robot.infrared.law,
            ray_m=one.infrared.ray_m,
            recess_m=RECESS_M,
            noise_share=robot.infrared.noise_share,
            noise_least=float(robot.infrared.noise_least_counts),
        ),
        watch=build_watch_law(robot),
        guard=limits_of(robot),
        mind=_mind_law(robot, minds, settings),
        stuck=StuckLaw(1, 0, 0.0) if settings.stuck is None else StuckLaw(*settings.stuck),
    )


def build_body_law(robot: Kurt2Settings, body: Body) -> BodyLaw:
    """Return the numbers of the robot's body."""
    geometry = robot.geometry
    return BodyLaw(
        cycle_s=robot.cycle_s,
        track_m=geometry.effective_track_m,
        mass_kg=geometry.mass_kg,
        inertia_kg_m2=geometry.yaw_inertia_kg_m2,
        inverse_mass=1.0 / geometry.mass_kg,
        inverse_inertia=1.0 / geometry.yaw_inertia_kg_m2,
        force_limit_n=body.force_limit_n,
        torque_limit_n_m=body.torque_limit_n_m,
        slip_keep=body.slip_keep,
        slip_gain=body.slip_gain,
        half_length_m=geometry.outline_length_m / 2,
        half_width_m=geometry.outline_width_m / 2,
        gap_cycles=CollisionCounter(robot.cycle_s).gap_cycles,
    )


def build_watch_law(robot: Kurt2Settings) -> WatchLaw:
    """Return the limits of the watches of sensors."""
    beams = [beam_of(robot.infrared, place) for place in range(len(robot.infrared.sensors))]
    return WatchLaw(
        sensors=sensor_limits(robot),
        frozen_s=robot.guard.frozen_infrared_s,
        beams=np.array(beams),
        metres_per_tick=robot.geometry.metres_per_tick,
        track_m=robot.geometry.effective_track_m,
    )


def _mind_law(robot: Kurt2Settings, minds: Sequence[Mind], settings: DriveSettings) -> MindLaw:
    names = list(settings.actions)
    policies = [mind.policy for mind in minds if isinstance(mind, PolicyMind)]
    policy = policies[0] if policies else None
    answers = getattr(policy, "actions", ())
    infrared = robot.infrared
    return MindLaw(
        minimum_ticks=settings.minimum_ticks,
        distance_m=np.array([infrared.distance_m(counts) for counts in range(HIGHEST_COUNTS + 1)]),
        seen=np.array([infrared.names.index(name) for name in _LOOKS if name in infrared.names], dtype=np.int64),
        metres_per_tick=robot.geometry.metres_per_tick,
        **_action_tables(list(settings.actions.values())),
        actions=np.array([names.index(name) for name in answers], dtype=np.int64),
        wall_following=_thresholds(policy, wall_following.Thresholds),
        fleeing=_thresholds(policy, fleeing.Thresholds),
        circle=_thresholds(policy, circle.Thresholds),
        eight=_thresholds(policy, eight.Thresholds),
        streets=_thresholds(policy, streets.Thresholds),
        left_rays=np.array(policy.left_rays) if isinstance(policy, streets.Streets) else np.zeros((6, 4)),
        right_rays=np.array(policy.right_rays) if isinstance(policy, streets.Streets) else np.zeros((6, 4)),
        turns=np.array([streets.turn_of(name) for name in settings.behaviours], dtype=np.int64),
    )


def _action_tables(actions: Sequence[Action]) -> dict[str, Any]:
    """Return the numbers of the actions, by the names in MindLaw."""
    fixed, wanted_m = np.zeros((len(actions), 2)), np.full(len(actions), math.inf)
    wall, keep = np.full((len(actions), 2), -1, dtype=np.int64), np.zeros((len(actions), 5))
    for place, action in enumerate(actions):
        match action:
            case FixedSpeeds():
                fixed[place] = action
            case Turn():
                fixed[place] = action.left_m_s, action.right_m_s
                wanted_m[place] = action.wanted_m
            case WallDistance():
                wall[place] = action.front, action.back
                keep[place] = action[2:]
    return {"fixed": fixed, "wanted_m": wanted_m, "wall": wall, "keep": keep}


def _thresholds(policy: object, kind: type[_ThresholdsT]) -> _ThresholdsT:
    """Return the thresholds of the policy that drives; zeros for another policy."""
    found = getattr(policy, "thresholds", None)
    return found if isinstance(found, kind) else kind(*[0.0] * len(kind._fields))


def build_robots(
    robot: Kurt2Settings, simulated: Sequence[SimulatedKurt2], minds: Sequence[Mind], knowledge_of: Sequence[int]
) -> tuple[Robots, World]:
    """Return the records of all robots, copied from the simulated ones, and their worlds.

    `knowledge_of`: first table of RLAs of each robot; -1 for a policy.
    """
    sensors, cycle_s = robot.infrared.sensors, robot.cycle_s
    boards = sorted({sensor.channel[:3] for sensor in sensors})
    longest_s = max(cycle_s, robot.infrared.period_s + robot.infrared.period_spread_s)
    robots = empty_robots(len(simulated), Sizes(len(sensors), math.ceil(longest_s / cycle_s) + 2, len(boards)))
    near = neighbours_of(sensors)
    robots["board"] = [boards.index(sensor.channel[:3]) for sensor in sensors]
    robots["before"], robots["after"] = [each.before for each in near], [each.after for each in near]
    robots["second_before"] = [each.second_before for each in near]
    robots["second_after"] = [each.second_after for each in near]
    robots["signs"] = NO_SIGNS
    robots["looked_at_s"], robots["driven_at_s"] = math.inf, -math.inf
    robots["gathered_x_m"] = robots["gathered_y_m"] = math.inf
    robots["command"] = robots["action"] = robots["rla"] = STANDS
    robots["area"] = OUTSIDE
    robots["number"] = range(len(robots))
    robots["kept_since"] = 1
    robots["free_cycles"] = CollisionCounter(cycle_s).gap_cycles + 1
    robots["way_counts"] = 1
    robots["kind"] = [kind_of(mind) for mind in minds]
    robots["knowledge"] = knowledge_of
    world, robots["world"] = _world(simulated)
    law = build_body_law(robot, simulated[0].body)
    for place, each in enumerate(simulated):
        record = robots[place]
        # The engine made its box where the robot was put first, unless the second place is outside of it.
        for pose in (each.world.settings.start_poses[0].pose, each.body.pose):
            record["x_m"], record["y_m"], record["heading_rad"] = pose
            keep_box(record, law)
        record["box_is_new"] = 0
        _copy_body(record, each.body)
        _copy_sensors(record, each.infrared)
    return robots, world


def _copy_body(record: np.record, body: Body) -> None:

    record["x_m"], record["y_m"], record["heading_rad"] = body.pose
    record["vx_m_s"], record["vy_m_s"], record["yaw_rad_s"] = body.velocity
    record["left_slip"], record["right_slip"] = body.slip


def _copy_sensors(record: np.record, infrared: InfraredSensors) -> None:
    for name in ("counts", "gains", "periods_s", "due_s"):
        record[name][:] = getattr(infrared, name)
    record["slots"] = len(infrared.calendar)
    for slot, due in enumerate(infrared.calendar):
        record["calendar"][slot, : len(due)] = due
        record["calendar_count"][slot] = len(due)
    rays = np.array(infrared.rays)
    record["ray_count"] = rays.shape[1]
    record["rays"][:, : rays.shape[1]] = rays


def _world(simulated: Sequence[SimulatedKurt2]) -> tuple[World, list[int]]:
    """Return the worlds of the robots, each world once, and the world of each robot."""
    worlds: dict[str, tuple[int, WorldSettings]] = {}
    of = []
    for each in simulated:
        settings = each.world.settings
        place, _ = worlds.setdefault(settings.model_dump_json(serialize_as_any=True), (len(worlds), settings))
        of.append(place)
    faces = [faces_of(settings) for _, settings in worlds.values()]
    posts = [
        np.array(
            [(post.x_m, post.y_m, post.radius_m, post.radius_m * post.radius_m) for post in settings.round_obstacles]
        )
        for _, settings in worlds.values()
    ]
    return World(
        faces=_padded([each.reshape(-1, 4) for each in faces]),
        face_count=np.array([len(each) for each in faces], dtype=np.int64),
        posts=_padded([each.reshape(-1, 4) for each in posts]),
        post_count=np.array([len(each) for each in posts], dtype=np.int64),
        reach_m=max(each.infrared.reach_m for each in simulated),
    ), of


def _padded(tables: Sequence[Floats]) -> Floats:
    """Return tables (rows, 4) of unequal length in one array (tables, rows, 4)."""
    padded = np.zeros((len(tables), max(1, *(len(table) for table in tables)), 4))
    for place, table in enumerate(tables):
        padded[place, : len(table)] = table
    return padded
