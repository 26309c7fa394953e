"""Infra-red sensors of a batch: each measures in its own turn, with its own gain and noise."""

from hal.infrared_law import counts_at
from hal.numerics import cos_sin
from simbridge.batch.compiled import compiled
from simbridge.batch.laws import SensorLaw
from simbridge.batch.record import Robot
from simbridge.batch.sight import cast

_HIGHEST_COUNTS = 1023
_counts_at = compiled(counts_at)
_cos_sin = compiled(cos_sin)


@compiled
def measure(robot: Robot, law: SensorLaw) -> None:
    """Let the sensors whose turn it is measure in a robot's present cycle, and enter their next turns."""
    cycle = robot.tick - 1
    slot = cycle % robot.slots
    due = robot.calendar_count[slot]
    turn = _cos_sin(robot.heading_rad)
    for k in range(due):
        i = robot.calendar[slot, k]
        read = _read(robot, i, _look(robot, i, turn, law.ray_m), law)
        if read != robot.counts[i]:
            robot.counts[i] = read
            robot.board_still_s[robot.board[i]] = 0.0
    # A sensor's next turn is in another slot: its period is at least a cycle, and the ring is longer than any.
    robot.calendar_count[slot] = 0
    for k in range(due):
        i = robot.calendar[slot, k]
        due_s = robot.due_s[i] + robot.periods_s[i]
        robot.due_s[i] = due_s
        following = max(cycle + 1, int(due_s / law.cycle_s)) % robot.slots
        robot.calendar[following, robot.calendar_count[following]] = i
        robot.calendar_count[following] += 1


@compiled
def measure_all(robot: Robot, law: SensorLaw) -> None:
    """Let all sensors of a robot that was put elsewhere measure at once, out of turn."""
    turn = _cos_sin(robot.heading_rad)
    for i in range(robot.counts.shape[0]):
        read = _read(robot, i, _look(robot, i, turn, law.ray_m), law)
        if read != robot.counts[i]:
            robot.counts[i] = read
            robot.board_still_s[robot.board[i]] = 0.0


@compiled
def _look(robot: Robot, i: int, turn: tuple[float, float], free_m: float) -> float:
    """Return the distance in m to the nearest hit of the rays of sensor `i`, at most `free_m`."""
    cos, sin = turn
    for ray in range(robot.ray_count):
        ahead_m, left_m = robot.rays[i, ray, 0], robot.rays[i, ray, 1]
        along_x, along_y = robot.rays[i, ray, 2], robot.rays[i, ray, 3]
        start = (robot.x_m + ahead_m * cos - left_m * sin, robot.y_m + ahead_m * sin + left_m * cos)
        along = (along_x * cos - along_y * sin, along_x * sin + along_y * cos)
        free_m = cast(robot, start, along, free_m)
    return free_m


@compiled
def _read(robot: Robot, i: int, free_m: float, law: SensorLaw) -> int:
    """Return the counts of sensor `i` for a free distance, with its gain and the next number of its noise."""
    counts = _counts_at(free_m - law.recess_m, law.law) * robot.gains[i]
    sigma = law.noise_share * counts
    normal = robot.noise[robot.noise_used]
    robot.noise_used += 1
    reading = round(counts + (sigma if sigma > law.noise_least else law.noise_least) * normal)
    return min(_HIGHEST_COUNTS, max(0, int(reading)))
