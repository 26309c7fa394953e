"""Tests that every robot passes: what keeps it safe, tried on its driver and its simulation."""

import math
from collections.abc import Iterator
from contextlib import closing, contextmanager
from itertools import pairwise
from typing import NamedTuple

import pytest

from config.settings import content_of, settings_of
from config.settings_files import shipped_names
from hal.guard_reason import GuardReason
from hal.robot import HIGHEST_COUNTS, STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from hal.robot_settings import BumperEnd, RobotSettings
from simbridge.contracts.robot_kind import RobotKind
from simbridge.contracts.simulation import Pose, Simulation

_SEED, _PURPOSE = 1, "plug-in test"
_WARM_UP_TICKS, _TICKS = 100, 60
_STANDS_M = 0.002
_STALE = {GuardReason.INFRARED_STALE, GuardReason.ENCODER_STALE, GuardReason.BUMPER_STALE}
_COUNT_SHARE = 0.3
"""Share of the way by which encoders may count wrongly: tyres and slip vary, a wrong scale is farther off."""
_SLOW = 0.4
"""Fraction of the guard's highest speed at which it is tried."""


class Tick(NamedTuple):
    """Readings of one tick of a tested robot, and the guard's answer in it."""

    readings: SensorReadings
    result: GuardResult


class Drive:
    """Drive of a simulated robot by its tests, tick by tick, after it stood for a second."""

    newest: Tick
    """Newest tick."""

    def __init__(self, simulation: Simulation, settings: RobotSettings) -> None:
        self.simulation, self.robot, self.settings = simulation, simulation.robot, settings
        slow_m_s = _SLOW * settings.guard.maximum_speed_m_s
        self.ahead = WheelSpeeds(slow_m_s, slow_m_s)
        self.to_left = WheelSpeeds(-slow_m_s / 2, slow_m_s / 2)
        self.now_s = 100.0
        self.tick(STANDSTILL, _WARM_UP_TICKS)

    def tick(self, wanted: WheelSpeeds, ticks: int = _TICKS, *, steps: bool = True, decided_ago_s: float = 0.0) -> Tick:
        """Drive for some ticks and return the last; without `steps` the robot says nothing more."""
        for _ in range(ticks):
            self.now_s += self.settings.cycle_s
            if steps:
                self.simulation.step()
            readings = self.robot.sense(self.now_s)
            result = self.robot.drive(wanted, self.now_s - decided_ago_s, self.now_s)
            self.newest = Tick(readings, result)
        return self.newest

    def told(self) -> str:
        """Return the guard's answer in the newest tick as a sentence, for a test that fails."""
        applied, reasons, _ = self.newest.result
        why = f" ({', '.join(reasons)})" if reasons else ""
        return f"the guard applied {applied.left_m_s:+.2f} and {applied.right_m_s:+.2f} m/s in the newest tick{why}"

    def left_alone(self, seconds: float) -> None:
        """Let the robot go on without a runtime."""
        for _ in range(round(seconds / self.settings.cycle_s)):
            self.now_s += self.settings.cycle_s
            self.simulation.step()

    @property
    def pose(self) -> Pose:
        """True pose of the robot."""
        return self.simulation.pose

    def stands(self) -> bool:
        """Return whether the robot stands while it is left alone."""
        before = self.pose
        self.left_alone(0.3)
        return self.is_near(before)

    def is_near(self, before: Pose) -> bool:
        """Return whether the robot has not moved since the pose `before`, apart from noise."""
        return math.dist(before, self.pose) < _STANDS_M


class RobotTests:
    """Tests of a kind of robot, with each of its settings files. Inherit them, and name it: `kind = ROVER`."""

    kind: RobotKind

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """Try the robot with each of its settings files. Raises SettingsError for one that cannot be read."""
        if "settings" in metafunc.fixturenames:
            schema, folder = self.kind.settings, self.kind.folder / "robots"
            found = {path.stem: settings_of(content_of(path), schema, path) for path in sorted(folder.glob("*.yaml"))}
            assert found, f"{folder}: holds no settings of a robot; add the YAML of one"
            metafunc.parametrize("settings", found.values(), ids=found)

    @contextmanager
    def opened(self, settings: RobotSettings) -> Iterator[Drive]:
        """Begin a drive in a world of the plug-in, else in a shipped one."""
        own = [str(each) for each in sorted((self.kind.folder / "worlds").glob("*.yaml"))]
        world = (own or shipped_names("worlds"))[0]
        with closing(self.kind.simulations(settings).open(world, _SEED, _PURPOSE)) as simulation:
            yield Drive(simulation, settings)

    @pytest.fixture
    def drive(self, settings: RobotSettings) -> Iterator[Drive]:
        """Return a drive that has begun."""
        with self.opened(settings) as drive:
            yield drive

    def test_it_senses_with_each_sensor_of_its_table_in_counts(self, drive: Drive) -> None:
        counts = drive.tick(drive.to_left).readings.infrared_counts
        assert len(counts) == len(drive.settings.infrared.sensors)
        assert all(0 <= each <= HIGHEST_COUNTS for each in counts)

    def test_its_readings_are_those_of_its_sensors_in_the_order_of_the_table(self, drive: Drive) -> None:
        """A reading may be a measurement older than what the simulated sensors see."""
        drive.tick(drive.to_left, 3 * _TICKS)
        counts = drive.tick(STANDSTILL, 2 * _TICKS).readings.infrared_counts
        there = drive.simulation.sensed_counts
        assert all(abs(told - true) <= 30 + 0.15 * true for told, true in zip(counts, there, strict=True))

    def test_it_stands_unless_it_is_told_to_drive(self, drive: Drive) -> None:
        before = drive.pose
        drive.tick(STANDSTILL)
        assert drive.is_near(before), drive.told()

    def test_equal_set_points_drive_it_ahead_and_its_encoders_count_the_way(self, drive: Drive) -> None:
        start, turned = drive.pose, 0
        # It stands at the end, so that a turn that is reported late is counted, too.
        for wanted in (drive.ahead,) * _TICKS + (STANDSTILL,) * _TICKS:
            readings = drive.tick(wanted, 1).readings
            turned += readings.encoder_left_ticks + readings.encoder_right_ticks
        way_m = math.dist(start[:2], drive.pose[:2])
        assert way_m > _STANDS_M, drive.told()
        assert turned / 2 * drive.settings.geometry.metres_per_tick == pytest.approx(way_m, rel=_COUNT_SHARE)

    def test_a_quicker_right_side_turns_it_to_the_left(self, drive: Drive) -> None:
        start = drive.pose.heading_rad
        drive.tick(drive.to_left)
        assert drive.pose.heading_rad > start, drive.told()

    def test_no_set_point_passes_the_limits_of_the_guard(self, drive: Drive) -> None:
        limits = drive.settings.guard
        applied = [drive.tick(WheelSpeeds(-10.0, 10.0), 1).result.wheel_speeds for _ in range(_TICKS)]
        assert max(max(map(abs, each)) for each in applied) <= limits.maximum_speed_m_s
        most_m_s = limits.acceleration_m_s2 * 2 * drive.settings.cycle_s + 0.011
        assert max(abs(after.right_m_s - before.right_m_s) for before, after in pairwise(applied)) <= most_m_s

    def test_it_stands_for_a_set_point_that_is_not_a_number(self, drive: Drive) -> None:
        drive.tick(drive.to_left)
        applied = drive.tick(WheelSpeeds(math.nan, drive.to_left.right_m_s), 1).result.wheel_speeds
        assert applied == STANDSTILL, drive.told()

    def test_it_stands_for_a_command_that_is_too_old(self, drive: Drive) -> None:
        drive.tick(drive.to_left)
        assert drive.tick(drive.to_left, 1, decided_ago_s=1.0).result.wheel_speeds == STANDSTILL, drive.told()

    def test_it_stands_when_its_senses_are_silent(self, drive: Drive) -> None:
        limits = drive.settings.guard
        longest_s = max(limits.stale_infrared_s, limits.stale_encoder_s) + drive.settings.infrared.period_s
        drive.tick(drive.to_left)
        result = drive.tick(drive.to_left, 2 + round(longest_s / drive.settings.cycle_s), steps=False).result
        assert result.wheel_speeds == STANDSTILL, drive.told()
        assert result.latched or _STALE.intersection(result.reasons), drive.told()

    def test_a_stop_lasts_until_it_is_released(self, drive: Drive) -> None:
        drive.tick(drive.to_left)
        drive.robot.emergency_stop(GuardReason.PROGRAM_WAITS)
        result = drive.tick(drive.to_left).result
        assert result.latched, drive.told()
        assert result.wheel_speeds == STANDSTILL, drive.told()
        assert drive.stands()
        drive.tick(STANDSTILL)
        drive.robot.release()
        assert drive.tick(drive.to_left).result.wheel_speeds != STANDSTILL, drive.told()

    def test_a_stop_sends_the_brake(self, drive: Drive) -> None:
        settings = drive.settings
        watchdog_s, slow_m_s = settings.motors.controller_watchdog_s, drive.ahead.left_m_s
        drive.tick(drive.to_left)
        drive.robot.emergency_stop(GuardReason.PROGRAM_WAITS)
        drive.left_alone(0.5 * watchdog_s)
        half_way = drive.pose
        drive.left_alone(0.25 * watchdog_s)
        turned_rad = abs(drive.pose.heading_rad - half_way.heading_rad)
        assert turned_rad < 0.25 * watchdog_s * slow_m_s / settings.geometry.effective_track_m / 2

    def test_it_brakes_by_itself_when_no_command_comes(self, drive: Drive) -> None:
        drive.tick(drive.to_left)
        drive.left_alone(drive.settings.motors.controller_watchdog_s + 1.0)
        assert drive.stands()

    def test_it_stands_after_it_was_closed_which_may_be_twice(self, drive: Drive) -> None:
        drive.tick(drive.to_left)
        drive.robot.close()
        drive.robot.close()
        drive.left_alone(drive.settings.motors.controller_watchdog_s + 1.0)
        assert drive.stands()

    def test_a_front_bumper_that_touches_blocks_that_way(self, drive: Drive) -> None:
        assert GuardReason.FRONT_BUMPER in _reasons_at_a_touch(drive, BumperEnd.FRONT), drive.told()

    def test_a_rear_bumper_that_touches_blocks_that_way(self, drive: Drive) -> None:
        assert GuardReason.REAR_BUMPER in _reasons_at_a_touch(drive, BumperEnd.REAR), drive.told()

    def test_equal_seeds_give_equal_drives(self, settings: RobotSettings) -> None:
        drives = list[tuple[Tick, Pose]]()
        for _ in range(2):
            with self.opened(settings) as drive:
                drives.append((drive.tick(drive.to_left), drive.pose))
        assert drives[0] == drives[1]


def _reasons_at_a_touch(drive: Drive, end: BumperEnd) -> tuple[GuardReason, ...]:
    """Return the guard's reasons once the robot has driven with an end against something; none if it touched nothing.

    Skips the test for a robot without a bumper there.
    """
    if not any(bumper.end is end for bumper in drive.settings.bumpers):
        pytest.skip(f"the robot has no {end} bumper")
    against = 1 if end is BumperEnd.FRONT else -1
    wanted = WheelSpeeds(*(against * speed_m_s for speed_m_s in drive.ahead))
    for _ in range(_TICKS):
        drive.tick(wanted, _TICKS)
        if drive.simulation.touching:
            return tuple(drive.tick(wanted, 5).result.reasons)
    return ()
