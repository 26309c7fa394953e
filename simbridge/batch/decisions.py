"""Decisions in a batch: the policies' laws, the nearest RLA, and the minimum time of a held action."""

import math

from behaviors.keep_distance import KeepDistanceNumbers, steer
from behaviors.policies import circle, eight, fleeing, streets, wall_following
from behaviors.policies.streets import KEEPS_MIDDLE
from simbridge.batch.asking import FAILED, ask
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import Averages, Features, Floats, Integers, Knowledge, MindLaw
from simbridge.batch.matching import nearest_rla
from simbridge.batch.record import UNDECIDED, Robot
from simbridge.contracts.batch import FeatureKind
from simbridge.contracts.shared_rules import SURE_SHARE

KNOWLEDGE, WALL_FOLLOWING, FLEEING, CIRCLE, EIGHT, STREETS, COMMANDED, ASKED = range(8)
"""Kinds of minds."""
READING, MAXIMUM, MINIMUM, ORIENTATION, NOTHING = (int(kind) for kind in FeatureKind)
_steer = compiled(steer)
_follow_wall = compiled(wall_following.choose_action)
_flee = compiled(fleeing.choose_action)
_circle = compiled(circle.choose_action)
_view_column = compiled(eight.view_column)
_drive_eight = compiled(eight.choose_action)
_turn_in_streets = compiled(streets.turn_at_once)
_wall_away_m = compiled(streets.wall_away_m)
_keep_middle = compiled(streets.keep_middle)


@compiled
def policy_answer(kind: int, behaviour: int, seen: Floats, law: MindLaw) -> int:
    """Return the index of a policy's answer among its actions, for a taught behaviour.

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
    left_side = (seen[3], seen[5], seen[6], seen[7], seen[8], seen[13])
    right_side = (seen[4], seen[9], seen[10], seen[11], seen[12], seen[14])
    if kind == STREETS:
        turn, want = law.turns[behaviour], law.streets
        action = _turn_in_streets((seen[0], seen[1], seen[2]), left_side, right_side, turn, want)
        if action == KEEPS_MIDDLE:
            to_left_m = _wall_away_m(left_side, _rays(law.left_rays), turn, want)
            to_right_m = _wall_away_m(right_side, _rays(law.right_rays), turn, want)
            action = _keep_middle(left_side, right_side, to_left_m, to_right_m, want)
        return action
    return _drive_eight(front_m, _view_column(left_side, law.eight), _view_column(right_side, law.eight), law.eight)


@compiled
def _rays(rays: Floats) -> streets.Rays:
    """Return the rays of one side's sensors (6, 4) as the policy takes them.

    The table keeps them as an array, because each number of a tuple takes time to be passed to compiled code.
    """
    return _ray(rays, 0), _ray(rays, 1), _ray(rays, 2), _ray(rays, 3), _ray(rays, 4), _ray(rays, 5)


@compiled
def _ray(rays: Floats, i: int) -> streets.Ray:
    return rays[i, 0], rays[i, 1], rays[i, 2], rays[i, 3]


@compiled
def perceive(robot: Robot, features: Features, averages: Averages) -> None:
    """Write the weighted situation of a robot, in counts, for the search of the nearest RLA.

    Call it once in each tick, because it adds a step to the averages.
    """
    width = features.kind.shape[0]
    for i in range(width):
        robot.situation[i] = feature_of(robot.counts, features, i) * features.weights[i]
    if features.average_weights.shape[0] > 0:
        _add_step(robot, features, averages)
        for i in range(width):
            average = averages.sums[robot.number, i] / features.average_steps
            robot.situation[width + i] = average * features.average_weights[i]


@compiled
def _add_step(robot: Robot, features: Features, averages: Averages) -> None:
    """Add a step to the averages of a robot, if it moves; its first tick stands for all earlier ones."""
    r, steps = robot.number, features.average_steps
    at, moves = averages.newest[r], robot.action >= 0
    for i in range(features.kind.shape[0]):
        value = feature_of(robot.counts, features, i)
        if robot.tick == 1:
            averages.sums[r, i] = steps * value
            for step in range(steps):
                averages.ring[r, step, i] = value
        if moves:
            averages.sums[r, i] += value - averages.ring[r, at, i]
            averages.ring[r, at, i] = value
    if moves:
        averages.newest[r] = (at + 1) % steps


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
    """Let an action drive a robot; return False if another one is held because its minimum time is not over.

    The same rule as in kurt2rt.core.basic.held_action.
    """
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
    """Return the wheel speeds in m/s of a robot's action in this tick; call it once in each tick.

    A finished turn stands.
    """
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
def decide(robot: Robot, k: int, law: MindLaw, knowledge: Knowledge, averages: Averages) -> tuple[float, float]:
    """Return the wheel speeds in m/s that a robot's mind decides in tick `k` of the stretch, before the guard.

    The action and the RLA go to the course of the stretch.
    """
    robot.track_distance[k] = math.inf
    if robot.kind == KNOWLEDGE:
        perceive(robot, knowledge.features, averages)
        _match(robot, k, law, knowledge)
    elif robot.kind == ASKED:
        perceive(robot, knowledge.features, averages)
        ask_python(robot, law, knowledge.mind)
    elif robot.kind == COMMANDED:
        if robot.command >= 0:
            hold_or_change(robot, robot.command, law)
    else:
        hold_or_change(robot, right_action(robot, law), law)
    robot.track_action[k], robot.track_rla[k] = robot.action, robot.rla
    return step_action(robot, law) if robot.action >= 0 else (0.0, 0.0)


@compiled
def right_action(robot: Robot, law: MindLaw) -> int:
    """Return the index of the action that the reference policy takes in a robot's present readings."""
    for i in range(law.seen.shape[0]):
        robot.seen[i] = law.distance_m[robot.counts[law.seen[i]]]
    return int(law.actions[policy_answer(robot.kind, robot.behaviour, robot.seen, law)])


@compiled
def _match(robot: Robot, k: int, law: MindLaw, knowledge: Knowledge) -> None:
    """Let the nearest RLA answer, or stand outside its radius."""
    table = robot.knowledge + robot.behaviour
    first, end = knowledge.first[table], knowledge.first[table + 1]
    row, distance = nearest_rla(robot, first, end, knowledge.conditions)
    robot.track_distance[k] = distance
    if row < 0 or not distance <= knowledge.radius[row]:
        robot.action = robot.rla = -1
        return
    robot.sure = 1 if distance <= SURE_SHARE * knowledge.radius[row] else 0
    answer = knowledge.answer[row]
    if hold_or_change(robot, knowledge.action[answer], law):
        robot.rla = answer


@compiled
def ask_python(robot: Robot, law: MindLaw, mind: int) -> None:
    """Let the PythonMind at an address choose the action for the robot's situation; the robot leaves if it failed."""
    robot.rla, robot.sure = -1, 1
    action = ask(mind, robot.number)
    if action == FAILED:
        robot.left = UNDECIDED
    if action < 0:
        robot.action = -1
    else:
        hold_or_change(robot, action, law)
