"""Exact match of a batch: the condition nearest to a situation, with the bits of numpy's sum over all conditions."""

import math

from simbridge.batch.compiled import compiled, compiled_in_any_order
from simbridge.batch.laws import Conditions, Floats
from simbridge.batch.record import CANDIDATES, Robot

LANES = 8
"""Partial sums of numpy's pairwise sum: the value at place i belongs to sum i % 8."""

_SLACK = 1.000001
"""Factor beyond which a sum of some squares is larger than another sum of all, whatever was rounded."""
_MARGIN = 100.0
"""Distance in counts by which a search looks farther than the nearest row, so that it serves for some ticks."""


@compiled
def exact_square(row: int, conditions: Floats, situation: Floats) -> float:
    """Return the sum of squared differences in counts squared, added as numpy's pairwise sum of up to 128 values.

    `row`: of the condition in `conditions`, (rows, values); values are a multiple of eight. `situation`: (128,).
    """
    a = b = c = d = e = f = g = h = 0.0
    for i in range(0, conditions.shape[1], LANES):
        a += (conditions[row, i] - situation[i]) * (conditions[row, i] - situation[i])
        b += (conditions[row, i + 1] - situation[i + 1]) * (conditions[row, i + 1] - situation[i + 1])
        c += (conditions[row, i + 2] - situation[i + 2]) * (conditions[row, i + 2] - situation[i + 2])
        d += (conditions[row, i + 3] - situation[i + 3]) * (conditions[row, i + 3] - situation[i + 3])
        e += (conditions[row, i + 4] - situation[i + 4]) * (conditions[row, i + 4] - situation[i + 4])
        f += (conditions[row, i + 5] - situation[i + 5]) * (conditions[row, i + 5] - situation[i + 5])
        g += (conditions[row, i + 6] - situation[i + 6]) * (conditions[row, i + 6] - situation[i + 6])
        h += (conditions[row, i + 7] - situation[i + 7]) * (conditions[row, i + 7] - situation[i + 7])
    return ((a + b) + (c + d)) + ((e + f) + (g + h))


@compiled_in_any_order
def sum_of_squares(row: int, values: int, conditions: Floats, situation: Floats) -> float:
    """Return the sum of squared differences of the first `values` values in counts squared, rounded in any way.

    `row`: of the condition in `conditions`, (rows, values). `situation`: (128,).
    """
    square = 0.0
    for i in range(values):
        square += (conditions[row, i] - situation[i]) * (conditions[row, i] - situation[i])
    return square


@compiled
def _away(row: int, conditions: Conditions, situation: Floats) -> float:
    """Return the distance of a condition from a situation, (128,), in counts, to the last bit of the match."""
    if conditions.is_whole:  # nothing is rounded, so the order of the sum does not matter
        return math.sqrt(sum_of_squares(row, conditions.values.shape[1], conditions.values, situation))
    return math.sqrt(exact_square(row, conditions.values, situation))


@compiled
def _least_square(row: int, conditions: Floats, situation: Floats) -> float:
    """Return a lower bound of `exact_square`, but for rounding: of the first eight values."""
    a = (conditions[row, 0] - situation[0]) * (conditions[row, 0] - situation[0])
    b = (conditions[row, 1] - situation[1]) * (conditions[row, 1] - situation[1])
    c = (conditions[row, 2] - situation[2]) * (conditions[row, 2] - situation[2])
    d = (conditions[row, 3] - situation[3]) * (conditions[row, 3] - situation[3])
    e = (conditions[row, 4] - situation[4]) * (conditions[row, 4] - situation[4])
    f = (conditions[row, 5] - situation[5]) * (conditions[row, 5] - situation[5])
    g = (conditions[row, 6] - situation[6]) * (conditions[row, 6] - situation[6])
    h = (conditions[row, 7] - situation[7]) * (conditions[row, 7] - situation[7])
    return float(((a + b) + (c + d)) + ((e + f) + (g + h)))


@compiled
def nearest_rla(robot: Robot, first: int, end: int, conditions: Conditions) -> tuple[int, float]:
    """Return row and distance of the RLA nearest to a robot's situation among rows `first` to `end`; -1 without rows.

    Of equally near RLAs the older one wins. A search keeps the RLAs that were near. While the situation moves little,
    the nearest one is among them, by the triangle inequality, and few of them are nearer than the others may be.
    """
    if first == end:
        return -1, math.inf
    if first <= robot.nearest < end and robot.candidates > 0:
        row, distance = _nearest_candidate(robot, conditions)
        if row >= 0:
            robot.nearest = row
            return row, distance
    _search(robot, first, end, conditions)
    row, distance = _nearest_candidate(robot, conditions)
    if row < 0:  # more RLAs than a search keeps are equally near
        bound = _SLACK * robot.candidate_away[0] * robot.candidate_away[0]
        row, distance = _nearest_of_all(first, end, bound, conditions.values, robot.situation)
    robot.nearest = row
    return row, distance


@compiled
def _nearest_candidate(robot: Robot, conditions: Conditions) -> tuple[int, float]:
    """Return row and distance of the nearest candidate of the newest search; -1 if another row may be nearer."""
    situation = robot.situation
    moved = math.sqrt(sum_of_squares(0, conditions.values.shape[1], robot.searched, situation))
    best, least = -1, math.inf
    for k in range(robot.candidates):
        if robot.candidate_away[k] > _SLACK * (least + moved):
            break
        row = robot.candidate_row[k]
        distance = _away(row, conditions, situation)
        if distance < least or (distance == least and row < best):
            best, least = row, distance
    return (best, least) if robot.others_away >= _SLACK * (least + moved) else (-1, math.inf)


@compiled
def _search(robot: Robot, first: int, end: int, conditions: Conditions) -> None:
    """Keep the rows from `first` to `end` that are nearest to a robot's situation as candidates, the nearest first."""
    situation = robot.situation
    for i in range(robot.situation.shape[0]):
        robot.searched[0, i] = situation[i]
    guess = robot.nearest if first <= robot.nearest < end else first
    guess_away = _away(guess, conditions, situation)
    robot.candidates, robot.others_away = 0, math.inf
    _keep_candidate(robot, guess, guess_away)
    for k in range(1, min(conditions.neighbours.shape[1], end - first)):
        reach = robot.candidate_away[0] + _MARGIN
        # By the triangle inequality this row and all further ones are farther away than that.
        if conditions.apart[guess, k] > _SLACK * (guess_away + reach):
            robot.others_away = min(robot.others_away, conditions.apart[guess, k] - guess_away)
            return
        _consider(robot, conditions.neighbours[guess, k], reach, conditions)
    if conditions.neighbours.shape[1] < end - first:
        reach = robot.candidate_away[0] + _MARGIN
        robot.candidates, robot.others_away = 0, math.inf
        for row in range(first, end):
            _consider(robot, row, reach, conditions)


@compiled
def _consider(robot: Robot, row: int, reach: float, conditions: Conditions) -> None:
    """Keep a row as a candidate if it may be within `reach`, in counts."""
    part = _least_square(row, conditions.values, robot.situation)
    if part > reach * reach:
        robot.others_away = min(robot.others_away, math.sqrt(part))
    else:
        _keep_candidate(robot, row, _away(row, conditions, robot.situation))


@compiled
def _keep_candidate(robot: Robot, row: int, away: float) -> None:
    """Insert a row by its distance `away` in counts; the farthest one is left out if they are too many."""
    place = robot.candidates
    if place == CANDIDATES:
        place -= 1
        robot.others_away = min(robot.others_away, max(away, robot.candidate_away[place]))
        if away >= robot.candidate_away[place]:
            return
    else:
        robot.candidates += 1
    while place > 0 and robot.candidate_away[place - 1] > away:
        robot.candidate_row[place] = robot.candidate_row[place - 1]
        robot.candidate_away[place] = robot.candidate_away[place - 1]
        place -= 1
    robot.candidate_row[place], robot.candidate_away[place] = row, away


@compiled
def scan_nearest(end: int, guess: int, values: Floats, situation: Floats) -> tuple[int, float]:
    """Return row and distance of the nearest condition among the rows up to `end`; -1 and infinity without rows.

    For conditions that change too often for a table of neighbours. Else as `nearest_rla`; `values`: (rows, values).
    """
    bound = _SLACK * exact_square(guess, values, situation) if 0 <= guess < end else math.inf
    return _nearest_of_all(0, end, bound, values, situation)


@compiled
def _nearest_of_all(first: int, end: int, bound: float, values: Floats, situation: Floats) -> tuple[int, float]:
    """Return row and distance of the nearest condition by comparing all rows, (rows, values), in counts.

    `bound`: square of a distance in counts squared, within which there is a condition. `situation`: (128,).
    """
    best, least = -1, math.inf
    for row in range(first, end):
        if _least_square(row, values, situation) > bound:
            continue
        distance = math.sqrt(exact_square(row, values, situation))
        if distance < least:
            best, least = row, distance
    return best, least
