"""The loop of a lesson in a batch: a taught robot drives, and its course is logged, until a lesson may be given."""

from typing import NamedTuple

from simbridge.batch.borders import crosses
from simbridge.batch.compiled import compiled
from simbridge.batch.contacts import leave_engine
from simbridge.batch.decisions import ask_python, feature_of, hold_or_change, right_action, step_action
from simbridge.batch.drive import begin_tick, sense_tick
from simbridge.batch.laws import Features, Floats, Integers, Laws, World
from simbridge.batch.matching import scan_nearest
from simbridge.batch.record import STAYS, Robot, Robots
from simbridge.batch.safety import drive_guarded
from simbridge.contracts.batch_lesson import LessonCause, LessonLog
from simbridge.contracts.shared_rules import SURE_SHARE, advance_way

BY_RLA, HELD, UNKNOWN, STOPPED, TEACHER, LEARNER = (int(cause) for cause in LessonCause)
_advance_way = compiled(advance_way)


class Learner(NamedTuple):
    """State of a taught robot's mind between ticks, as arrays that are copied to take ticks back."""

    sums: Integers
    """Sums of the features over the steps of the average, (features,)."""
    numbers: Integers
    """Steps that were added to the averages; 1 if the next tick was sensed already; 1 if an action drove in the last
    tick, (3,)."""
    way: Floats
    """Way since the last counted tick of a slow lesson, (1,)."""


class Table(NamedTuple):
    """RLAs that a taught robot decides by, in arrays with free rows for later lessons; oldest first."""

    rows: Integers
    """Number of RLAs, (1,)."""
    numbers: Integers
    conditions: Floats
    """Weighted conditions, (rows, values)."""
    radius: Floats
    action: Integers
    features: Features
    added: Integers
    """Ticks whose features were added to the averages, (ticks + 1,)."""
    mind: int
    """Address of the PythonMind that decides instead of the RLAs; 0: they decide."""


STEPS, SENSED, DROVE = range(3)


@compiled
def teach(robots: Robots, world: World, laws: Laws, learner: Learner, table: Table, log: LessonLog) -> None:
    """Drive the only robot of a batch to the end of the tick `until` of its record.

    It ends sooner if the robot crosses a border, waits for the physics engine or leaves.
    """
    robot = robots[0]
    robot.crossed = 0
    if learner.numbers[SENSED]:
        _decide(robot, laws, learner, table, log)
    while robot.tick < robot.until and robot.left == STAYS and not robot.crossed:
        sense(robots, world, laws, learner, table, log)
        if robot.waits:
            return
        if robot.left == STAYS:
            _decide(robot, laws, learner, table, log)


@compiled
def sense(robots: Robots, world: World, laws: Laws, learner: Learner, table: Table, log: LessonLog) -> None:
    """Run a tick of the only robot of a batch up to its situation, unless it waits for the physics engine."""
    robot = robots[0]
    begin_tick(robot, world, laws)
    if not robot.waits and robot.left == STAYS:
        perceive(robots, world, laws, learner, table, log)


@compiled
def perceive(robots: Robots, world: World, laws: Laws, learner: Learner, table: Table, log: LessonLog) -> None:
    """Run a tick of the only robot of a batch from its new pose up to its situation, and log what it perceives."""
    robot = robots[0]
    if robot.waits:
        leave_engine(robot, laws.body)
    if not sense_tick(robot, world, laws):
        return
    tick, numbers, features = robot.tick, learner.numbers, table.features
    # As kurt2rt.core.perception: the averages stand still while the robot stands, and in ticks that do not count.
    moves = numbers[DROVE] and robot.way_counts
    steps = features.average_steps
    for i in range(features.kind.shape[0]):
        value = feature_of(robot.counts, features, i)
        log.features[tick, i] = value
        if tick == 1:
            learner.sums[i] = steps * value
        if moves:
            # Before the first step leaves the averages, the robot has been where it began.
            leaves = table.added[numbers[STEPS] - steps] if numbers[STEPS] >= steps else 1
            learner.sums[i] += value - log.features[leaves, i]
        log.sums[tick, i] = learner.sums[i]
    if moves:
        table.added[numbers[STEPS]] = tick
        numbers[STEPS] += 1
    for i in range(robot.counts.shape[0]):
        log.counts[tick, i] = robot.counts[i]
    log.poses[tick, 0], log.poses[tick, 1], log.poses[tick, 2] = robot.x_m, robot.y_m, robot.heading_rad
    log.touching[tick] = robot.touching != 0
    log.collisions[tick] = robot.collisions
    numbers[SENSED] = 1


@compiled
def _decide(robot: Robot, laws: Laws, learner: Learner, table: Table, log: LessonLog) -> None:
    """Decide the tick that was sensed, and send CONTROL."""
    learner.numbers[SENSED] = 0
    tick, cause = robot.tick, _choose(robot, laws, table, log)
    left_m_s = right_m_s = 0.0
    drives = robot.action >= 0
    if drives:
        left_m_s, right_m_s = step_action(robot, laws.mind)
    slow = drives and robot.speed_share < 1.0
    robot.way_counts = 1
    if slow:
        way, counts = _advance_way(learner.way[0], robot.speed_share)
        learner.way[0] = way
        robot.way_counts = 1 if counts else 0
        left_m_s, right_m_s = robot.speed_share * left_m_s, robot.speed_share * right_m_s
    learner.numbers[DROVE] = 1 if drives else 0
    log.causes[tick], log.actions[tick], log.slow[tick] = cause, robot.action, slow
    log.rlas[tick] = robot.rla if cause in (BY_RLA, HELD) else 0
    # Not before the commands of this tick, which may want another behaviour.
    log.behaviours[tick], log.right[tick] = robot.behaviour, right_action(robot, laws.mind)
    drive_guarded(robot, (left_m_s, right_m_s), tick * laws.body.cycle_s, laws.guard)
    log.turned[tick] = robot.turned != 0
    robot.crossed = crosses(robot)
    robot.at += 1


@compiled
def _choose(robot: Robot, laws: Laws, table: Table, log: LessonLog) -> int:
    """Let the nearest RLA, Python or the teacher choose the action; return the cause, a number of LessonCause."""
    log.sure[robot.tick] = False
    if robot.held >= 0:
        robot.action = robot.held
        return TEACHER
    if robot.stopped:
        robot.action = robot.rla = -1
        return STOPPED
    features, tick = table.features, robot.tick
    width = features.kind.shape[0]
    for i in range(width):
        robot.situation[i] = log.features[tick, i] * features.weights[i]
    for i in range(features.average_weights.shape[0]):
        robot.situation[width + i] = log.sums[tick, i] / features.average_steps * features.average_weights[i]
    if table.mind:
        ask_python(robot, laws.mind, table.mind)
        log.sure[tick] = True
        return UNKNOWN if robot.action < 0 else LEARNER
    row, distance = scan_nearest(table.rows[0], robot.nearest, table.conditions, robot.situation)
    robot.nearest = row
    if row < 0 or not distance <= table.radius[row]:
        robot.action = robot.rla = -1
        return UNKNOWN
    log.sure[tick] = distance <= SURE_SHARE * table.radius[row]
    if hold_or_change(robot, table.action[row], laws.mind):
        robot.rla = table.numbers[row]
        return BY_RLA
    return HELD
