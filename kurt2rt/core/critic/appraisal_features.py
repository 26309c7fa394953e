"""Appraisal features of one tick: the critic's view of the last seconds of sensor readings."""

import math
from collections.abc import Callable
from operator import itemgetter

from behaviors.judges.judge import AppraisalFeatures
from config.settings import SettingsError
from hal.numerics import round_portable
from hal.odometry import WheelMotion, WheelOdometry
from hal.robot import HIGHEST_COUNTS, SensorReadings
from hal.robot_settings import InfraredSettings, RobotSettings
from kurt2rt.core.critic.settings import CriticSettings, critic_of


class TurnMemory:
    """Signed turn since the last reversal, from the wheels' motion, in constant time and memory.

    A circling robot's turn grows round after round. In an eight left and right turns alternate, so it stays below a
    round.
    """

    def __init__(self, reversal_rad: float, fades_in_m: float = math.inf) -> None:
        """Start without a turn.

        Args:
            reversal_rad: turn the other way in rad that counts as a reversal; smaller ones are subtracted.
            fades_in_m: way in m over which an earlier turn fades to 37 %; infinite: only a reversal ends it.
        """
        self._reversal_rad = reversal_rad
        self._fades_in_m = fades_in_m
        self.restart()

    def restart(self) -> None:
        """Forget the past: the robot may have been carried elsewhere."""
        self._turned_rad = self._farthest_rad = 0.0

    def update(self, turn_rad: float, way_m: float = 0.0) -> float:
        """Add the motion of one tick; return the turn since the last reversal in rad, counter-clockwise positive.

        Args:
            turn_rad: turn in rad, counter-clockwise positive.
            way_m: way in m, forward or backward.

        The reversal begins at the farthest turn before it, so the turn of the reversal counts whole.
        """
        kept = max(0.0, 1.0 - abs(way_m) / self._fades_in_m)
        turned_rad, farthest_rad = kept * self._turned_rad + turn_rad, kept * self._farthest_rad
        back_rad = farthest_rad - turned_rad
        if farthest_rad * turned_rad <= 0.0 or abs(turned_rad) > abs(farthest_rad):
            farthest_rad = turned_rad
        elif abs(back_rad) >= self._reversal_rad:
            turned_rad = farthest_rad = -back_rad
        self._turned_rad, self._farthest_rad = turned_rad, farthest_rad
        return turned_rad


class AppraisalPerception:
    """Converter from SensorReadings to AppraisalFeatures, once per tick, in constant memory."""

    def __init__(self, critic: CriticSettings, robot: RobotSettings) -> None:
        """Prepare tables for a robot. Raises SettingsError for an unknown sensor, or a sector without one."""
        critic = critic_of(critic, robot)
        want, period_s = critic.perception, robot.cycle_s
        sensors, infrared = want.sensors, robot.infrared
        assert sensors is not None  # critic_of names them
        missing = sorted(sensors.used - set(infrared.names))
        if missing:
            raise SettingsError(
                f"critic {critic.name}: perception.sensors: the robot has no sensor {', '.join(missing)}",
                do=f"allowed: {', '.join(infrared.names)}",
            )
        # Distance by count, looked up for the highest count of a side in each tick: nearer objects have higher counts.
        self._distance_m = tuple(infrared.distance_m(counts) for counts in range(HIGHEST_COUNTS + 1))
        sides = (sensors.left, sensors.front, sensors.right, sensors.rear, sensors.ahead_left, sensors.ahead_right)
        self._left, self._front, self._right, self._rear, self._ahead_left, self._ahead_right = (
            _counts_of(infrared, side) for side in sides
        )
        self._wall = _counts_of(infrared, sensors.wall)
        self._left_ends, self._right_ends = (
            _counts_of(infrared, (side[0], side[-1])) for side in (sensors.left, sensors.right)
        )
        self._left_baseline_m = _baseline_m(infrared, sensors.left, critic.name)
        self._right_baseline_m = _baseline_m(infrared, sensors.right, critic.name)
        self._wall_m = want.wall_m
        self._no_progress_m2 = want.no_progress_m * want.no_progress_m
        self._odometry = WheelOdometry(robot.geometry)
        self._period_s = period_s
        self._share_of_new = 1.0 - round_portable(math.exp(-period_s / want.smoothing_s))
        self._bump_held_ticks = round(want.bump_held_s / period_s)
        self._no_wall_ticks = round(want.no_wall_s / period_s)
        self._stale_infrared_s = robot.guard.stale_infrared_s
        circling = want.circling
        self._turn_memory = (
            None if circling is None else TurnMemory(circling.reversal_rad, circling.fades_in_m or math.inf)
        )
        self._round_rad = math.inf if circling is None else circling.round_rad
        grazing = want.grazing
        self._graze_m = 0.0 if grazing is None else grazing.near_m
        self._spun_settings = want.spun
        self._spun_held_ticks = 0 if want.spun is None else 1 + round(want.spun.held_s / period_s)
        self._graze_held_ticks = 0 if grazing is None else 1 + round(grazing.held_s / period_s)
        steps = max(1, round(want.no_progress_s / period_s))
        self._x_m, self._y_m = [0.0] * steps, [0.0] * steps
        self._here_x_m = self._here_y_m = self._heading_rad = 0.0
        self.restart()

    def restart(self) -> None:
        """Reset after power-on or missing sensor data."""
        self._speed_m_s = self._turn_rad_s = 0.0
        self.forget_turns()
        self._since_bump = self._bump_held_ticks
        self._since_graze = self._graze_held_ticks
        self._since_spin = self._spun_held_ticks
        self._without_wall = 0
        self._driven = 0  # ticks without a pause, so many places of the ring are of this drive
        self._next = 0

    def forget_turns(self) -> None:
        """Begin the turn since the last reversal at 0, because the robot was carried elsewhere."""
        self._turned_rad = 0.0
        if self._turn_memory is not None:
            self._turn_memory.restart()

    def perceive(self, readings: SensorReadings, *, driving: bool) -> AppraisalFeatures:
        """Return the features of this tick; `driving`: whether an action drove the wheels until now.

        A waiting robot does not add to the time without a wall, and a wait is not a lack of progress.
        """
        if not readings.infrared_age_s <= self._stale_infrared_s:
            self.restart()
        counts, distance_m = readings.infrared_counts, self._distance_m
        self._move(self._odometry.motion(readings.encoder_left_ticks, readings.encoder_right_ticks))
        self._since_bump = 0 if readings.bumpers else self._since_bump + 1
        if distance_m[max(self._wall(counts))] < self._wall_m:
            self._without_wall = 0
        elif driving:
            self._without_wall += 1
        left_m, right_m = distance_m[max(self._left(counts))], distance_m[max(self._right(counts))]
        self._since_graze = 0 if left_m < self._graze_m or right_m < self._graze_m else self._since_graze + 1
        return AppraisalFeatures(
            left_m=left_m,
            front_m=distance_m[max(self._front(counts))],
            right_m=right_m,
            rear_m=distance_m[max(self._rear(counts))],
            ahead_left_m=distance_m[max(self._ahead_left(counts))],
            ahead_right_m=distance_m[max(self._ahead_right(counts))],
            left_angle_rad=self._angle_rad(self._left_ends(counts), self._left_baseline_m),
            right_angle_rad=self._angle_rad(self._right_ends(counts), self._right_baseline_m),
            speed_m_s=self._speed_m_s,
            turn_rad_s=self._turn_rad_s,
            bumped=1.0 if self._since_bump < self._bump_held_ticks else 0.0,
            no_progress=1.0 if self._no_progress(driving=driving) else 0.0,
            no_wall=1.0 if self._without_wall >= self._no_wall_ticks else 0.0,
            circling=1.0 if abs(self._turned_rad) >= self._round_rad else 0.0,
            grazing=1.0 if self._since_graze < self._graze_held_ticks else 0.0,
            spun=1.0 if self._since_spin < self._spun_held_ticks else 0.0,
        )

    def _angle_rad(self, counts: tuple[int, ...], baseline_m: float) -> float:
        """Return the angle in rad to a wall, from the counts of a side's first and last sensor."""
        front_m, back_m = self._distance_m[counts[0]], self._distance_m[counts[1]]
        if front_m >= self._wall_m and back_m >= self._wall_m:
            return 0.0
        return round_portable(math.atan2(front_m - back_m, baseline_m))

    def _move(self, motion: WheelMotion) -> None:
        """Add the wheels' motion of one tick to speed, turn rate and position."""
        way_m, turn_rad = motion.forward_m, motion.turn_rad
        self._speed_m_s += self._share_of_new * (way_m / self._period_s - self._speed_m_s)
        self._turn_rad_s += self._share_of_new * (turn_rad / self._period_s - self._turn_rad_s)
        self._heading_rad += turn_rad
        if self._turn_memory is not None:
            self._turned_rad = self._turn_memory.update(turn_rad, way_m)
        spin = self._spun_settings
        if spin is not None:
            spins = abs(self._turn_rad_s) > spin.turn_rad_s and abs(self._speed_m_s) < spin.speed_m_s
            self._since_spin = 0 if spins else self._since_spin + 1
        self._here_x_m += way_m * round_portable(math.cos(self._heading_rad))
        self._here_y_m += way_m * round_portable(math.sin(self._heading_rad))

    def _no_progress(self, *, driving: bool) -> bool:
        """Return whether the robot has driven for the whole time and is near its old position."""
        if not driving:
            self._driven = 0
            return False
        place, steps = self._next, len(self._x_m)
        off_x_m, off_y_m = self._here_x_m - self._x_m[place], self._here_y_m - self._y_m[place]
        self._x_m[place], self._y_m[place] = self._here_x_m, self._here_y_m
        self._next = place + 1 if place + 1 < steps else 0
        self._driven += 1
        return self._driven > steps and off_x_m * off_x_m + off_y_m * off_y_m < self._no_progress_m2


def _counts_of(infrared: InfraredSettings, names: tuple[str, ...]) -> Callable[[tuple[int, ...]], tuple[int, ...]]:
    """Return a function that selects the counts of some sensors."""
    places = [infrared.names.index(name) for name in names]
    if len(places) == 1:  # itemgetter of one index returns no tuple
        places *= 2
    return itemgetter(*places)


def _baseline_m(infrared: InfraredSettings, side: tuple[str, ...], critic: str) -> float:
    """Return the distance in m from a side's last sensor forward to its first; infinite if they tell no angle.

    Only two sensors that look the same way tell the angle of a wall by their difference. Raises SettingsError if the
    first is not ahead of the last.
    """
    of = {sensor.name: sensor for sensor in infrared.sensors}
    first, last = of[side[0]], of[side[-1]]
    if first is last or first.heading_deg != last.heading_deg:
        return math.inf
    baseline_m = first.x_m - last.x_m
    if baseline_m <= 0:
        raise SettingsError(
            f"critic {critic}: perception.sensors: {side[0]} does not sit ahead of {side[-1]}",
            do="give the sensors of a side from front to back",
        )
    return baseline_m
