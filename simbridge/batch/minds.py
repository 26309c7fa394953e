"""Decisions in a batch: the policies' laws, the nearest RLA, and the minimum time of a held action."""

import math

from behaviors.keep_distance import KeepDistanceNumbers, steer
from behaviors.policies import circle, eight, fleeing, wall_following
from hal.batch import FeatureKind
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import Features, Floats, Integers, Knowledge, MindLaw
from simbridge.batch.matching import nearest_rla
from simbridge.batch.record import Robot

KNOWLEDGE, WALL_FOLLOWING, FLEEING, CIRCLE, EIGHT, COMMANDED = range(6)
"""Kinds of minds."""
READING, MAXIMUM, MINIMUM, ORIENTATION, NOTHING = (int(kind) for kind in FeatureKind)
_steer = compiled(steer)
_follow_wall = compiled(wall_following.choose_action)
_flee = compiled(fleeing.choose_action)
_circle = compiled(circle.choose_action)
_view_column = compiled(eight.view_column)
_drive_eight = compiled(eight.choose_action)


@compiled
def policy_answer(kind: int, seen: Floats, law: MindLaw) -> int:
    """Return the index of a policy's answer among its actions.

    `seen`: distances in m, (15,), of front (3), front edges (2), left (4), right (4), rear edges (2), in the order of
    `behaviors.policies.distances`.
    """
    front_m = min(seen[0], seen[1], seen[2])
    left = (seen[5], seen[6], seen[7], seen[8])
    if kind == WALL_FOLLOWING:
        return _follow_wall(front_m, seen[3], seen[4], left, law.wall_following)
    if kind == FLEEING:
        return _flee(front_m, seen[3], seen[4], law.fleeing)
    if kind == CIRCLE:
        return _circle(left, law.circle)
    left_column = _view_column((seen[3], seen[5], seen[6], seen[7], seen[8], seen[13]), law.eight)
    right_column = _view_column((seen[4], seen[9], seen[10], seen[11], seen[12], seen[14]), law.eight)
    return _drive_eight(front_m, left_column, right_column, law.eight)


@compiled
def fill_features(counts: Integers, features: Features, situation: Floats) -> None:
    """Write the weighted recent features of a robot's counts (sensors,) to `situation`, (64,), in counts."""
    for i in range(features.kind.shape[0]):
        situation[i] = feature_of(counts, features, i) * features.weights[i]


@compiled
def feature_of(counts: Integers, features: Features, i: int) -> int:
    """Return recent feature `i` of a robot's counts (sensors,), in counts."""
    kind = features.kind[i]
    value = counts[features.sensors[i, 0]]
    if kind == NOTHING:
        value = 0
    elif kind == ORIENTATION:
        value = max(0, value - counts[features.sensors[i, 1]])
    elif kind != READING:
        for k in range(1, features.sensor_count[i]):
            other = counts[features.sensors[i, k]]
            value = max(value, other) if kind == MAXIMUM else min(value, other)
    return int(value)


@compiled
def hold_or_change(robot: Robot, action: int, law: MindLaw) -> bool:
    """Let an action drive a robot; return False if another one is held because its minimum time is not over."""
    if robot.action >= 0:
        if robot.action == action:
            return True
        if robot.action_ticks < law.minimum_ticks and robot.turned_m < law.wanted_m[robot.action]:
            return False
    robot.action = action
    robot.action_ticks = 0
    robot.turned_m = 0.0
    return True


@compiled
def step_action(robot: Robot, law: MindLaw) -> tuple[float, float]:
    """Return the wheel speeds in m/s of the action that drives a robot."""
    action = robot.action
    robot.action_ticks += robot.way_counts
    if law.wall[action, 0] >= 0:
        front_m = law.distance_m[robot.counts[law.wall[action, 0]]]
        back_m = law.distance_m[robot.counts[law.wall[action, 1]]]
        keep = law.keep
        want = KeepDistanceNumbers(keep[action, 0], keep[action, 1], keep[action, 2], keep[action, 3], keep[action, 4])
        return _steer(front_m, back_m, want)
    if law.wanted_m[action] < math.inf:
        sign = 1.0 if law.fixed[action, 1] > 0.0 else -1.0
        robot.turned_m += 0.5 * (sign * (robot.right_ticks - robot.left_ticks)) * law.metres_per_tick
        if robot.turned_m >= law.wanted_m[action]:
            return 0.0, 0.0
    return law.fixed[action, 0], law.fixed[action, 1]


@compiled
def decide(robot: Robot, k: int, law: MindLaw, knowledge: Knowledge) -> tuple[float, float]:
    """Return the wheel speeds in m/s that a robot decides in tick `k` of the stretch, and enter the decision."""
    robot.track_distance[k] = math.inf
    if robot.kind == KNOWLEDGE:
        _match(robot, k, law, knowledge)
    elif robot.kind == COMMANDED:
        if robot.command >= 0:
            hold_or_change(robot, robot.command, law)
    else:
        hold_or_change(robot, right_action(robot, law), law)
    robot.track_action[k], robot.track_rla[k] = robot.action, robot.rla
    return step_action(robot, law) if robot.action >= 0 else (0.0, 0.0)


@compiled
def right_action(robot: Robot, law: MindLaw) -> int:
    """Return the index of the action that the policy takes for right."""
    for i in range(law.seen.shape[0]):
        robot.seen[i] = law.distance_m[robot.counts[law.seen[i]]]
    return int(law.actions[policy_answer(robot.kind, robot.seen, law)])


@compiled
def _match(robot: Robot, k: int, law: MindLaw, knowledge: Knowledge) -> None:
    """Let the nearest RLA answer, or stand outside its radius."""
    fill_features(robot.counts, knowledge.features, robot.situation)
    first, end = knowledge.first[robot.knowledge], knowledge.first[robot.knowledge + 1]
    row, distance = nearest_rla(robot, first, end, knowledge.conditions)
    robot.track_distance[k] = distance
    if row < 0 or not distance <= knowledge.radius[row]:
        robot.action = robot.rla = -1
        return
    answer = knowledge.answer[row]
    if hold_or_change(robot, knowledge.action[answer], law):
        robot.rla = answer
