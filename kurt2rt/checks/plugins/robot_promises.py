"""Promises of a robot, tried on its driver and its simulation: what keeps it safe holds for every kind."""

import math
from collections.abc import Callable, Sequence
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from hal.guard_reason import GuardReason
from hal.robot import HIGHEST_COUNTS, STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from hal.robot_kind import RobotKind
from hal.robot_settings import BumperEnd, RobotSettings
from hal.settings import SettingsError, content_of, settings_of
from hal.settings_files import shipped_names
from hal.simulation import Pose, Simulation
from kurt2rt.core.learner.conformance import broken_among

_SEED, _PURPOSE = 1, "plug-in check"
_WARM_UP_TICKS, _TICKS = 100, 60
_STANDS_M = 0.002
_STALE = {GuardReason.INFRARED_STALE, GuardReason.ENCODER_STALE, GuardReason.BUMPER_STALE}
_COUNT_SHARE = 0.3
"""Share of the way by which encoders may count wrongly: tyres and slip vary, a wrong scale is farther off."""
_SLOW = 0.4
"""Fraction of the guard's highest speed at which it is tried."""


Promise = tuple[str, Callable[[], bool | str]]
"""Sentence, and a function that returns whether it holds, or else a text that says what happened."""


class _Tick(NamedTuple):
    readings: SensorReadings
    result: GuardResult


class _Drive:
    """Drive of a simulated robot, tick by tick, after it stood for a second."""

    newest: _Tick
    """Newest tick."""

    def __init__(self, simulation: Simulation, settings: RobotSettings) -> None:
        self.simulation, self.robot = simulation, simulation.robot
        self._cycle_s = settings.cycle_s
        self.now_s = 100.0
        self.tick(STANDSTILL, _WARM_UP_TICKS)

    def tick(
        self, wanted: WheelSpeeds, ticks: int = _TICKS, *, steps: bool = True, decided_ago_s: float = 0.0
    ) -> _Tick:
        """Drive for some ticks and return the last; without `steps` the robot says nothing more."""
        for _ in range(ticks):
            self.now_s += self._cycle_s
            if steps:
                self.simulation.step()
            readings = self.robot.sense(self.now_s)
            result = self.robot.drive(wanted, self.now_s - decided_ago_s, self.now_s)
            self.newest = _Tick(readings, result)
        return self.newest

    def told(self) -> str:
        """Return what the guard made of the newest tick."""
        applied, reasons, _ = self.newest.result
        why = f" ({', '.join(reasons)})" if reasons else ""
        return f"the guard applied {applied.left_m_s:+.2f} and {applied.right_m_s:+.2f} m/s in the newest tick{why}"

    def left_alone(self, seconds: float) -> None:
        """Let the robot go on without a runtime."""
        for _ in range(round(seconds / self._cycle_s)):
            self.now_s += self._cycle_s
            self.simulation.step()

    @property
    def pose(self) -> Pose:
        return self.simulation.pose


def broken_of_robot(kind: RobotKind, where: str, *, only: str = "") -> list[str]:
    """Return the promises that a kind of robot breaks, each in a sentence.

    Args:
        kind: of robot, tried with each of its settings.
        where: its name, for errors.
        only: text within the promises to try; empty: all.

    Raises hal.settings.SettingsError for settings that cannot be read.
    """
    broken: list[str] = []
    for path in _settings_files(kind, where):
        settings: RobotSettings = settings_of(content_of(path), kind.settings, path)
        promises = [each for each in _promises_of(kind, settings, _world_of(kind)) if only in each[0]]
        broken += [f"{path.stem}: {line}" for line in broken_among(promises)]
    return broken


def _settings_files(kind: RobotKind, where: str) -> Sequence[Path]:
    files = sorted((kind.folder / "robots").glob("*.yaml"))
    if not files:
        raise SettingsError(f"has no settings in {kind.folder / 'robots'}", where=where, do="add the YAML of a robot")
    return files


def _world_of(kind: RobotKind) -> str:
    """Return a world to drive in: the first one of the plug-in, or else a shipped one."""
    own = [str(each) for each in sorted((kind.folder / "worlds").glob("*.yaml"))]
    return (own or shipped_names("worlds"))[0]


def _promises_of(kind: RobotKind, settings: RobotSettings, world: str) -> list[Promise]:
    factory = kind.simulations(settings)
    fastest_m_s = settings.guard.maximum_speed_m_s
    slow_m_s = _SLOW * fastest_m_s
    ahead, to_left = WheelSpeeds(slow_m_s, slow_m_s), WheelSpeeds(-slow_m_s / 2, slow_m_s / 2)

    def tried(promise: Callable[[_Drive], bool]) -> Callable[[], bool | str]:
        def keeps() -> bool | str:
            with closing(factory.open(world, _SEED, _PURPOSE)) as simulation:
                drive = _Drive(simulation, settings)
                return promise(drive) or drive.told()

        return keeps

    def is_near(before: Pose, after: Pose) -> bool:
        return math.dist(before, after) < _STANDS_M

    def stands(drive: _Drive) -> bool:
        before = drive.pose
        drive.left_alone(0.3)
        return is_near(before, drive.pose)

    def stands_if_told_to(drive: _Drive) -> bool:
        before = drive.pose
        drive.tick(STANDSTILL)
        return is_near(before, drive.pose)

    def reads(drive: _Drive) -> bool:
        counts = drive.tick(to_left).readings.infrared_counts
        return len(counts) == len(settings.infrared.sensors) and all(0 <= each <= HIGHEST_COUNTS for each in counts)

    def goes_ahead(drive: _Drive) -> bool:
        start, turned = drive.pose, 0
        # It stands at the end, so that a turn that is told late is counted, too.
        for wanted in (ahead,) * _TICKS + (STANDSTILL,) * _TICKS:
            readings = drive.tick(wanted, 1).readings
            turned += readings.encoder_left_ticks + readings.encoder_right_ticks
        way_m = math.dist(start[:2], drive.pose[:2])
        counted_m = turned / 2 * settings.geometry.metres_per_tick
        return way_m > _STANDS_M and abs(counted_m / way_m - 1) < _COUNT_SHARE

    def turns_left(drive: _Drive) -> bool:
        start = drive.pose.heading_rad
        drive.tick(to_left)
        return drive.pose.heading_rad > start

    def stays_within_limits(drive: _Drive) -> bool:
        applied = [drive.tick(WheelSpeeds(-10.0, 10.0), 1).result.wheel_speeds for _ in range(_TICKS)]
        most_m_s = settings.guard.acceleration_m_s2 * 2 * settings.cycle_s
        steps = [abs(after.right_m_s - before.right_m_s) for before, after in pairwise(applied)]
        return max(max(map(abs, each)) for each in applied) <= fastest_m_s and max(steps) <= most_m_s + 0.011

    def takes_no_old_command(drive: _Drive) -> bool:
        drive.tick(to_left)
        return drive.tick(to_left, 1, decided_ago_s=1.0).result.wheel_speeds == STANDSTILL

    def takes_no_nan(drive: _Drive) -> bool:
        drive.tick(to_left)
        return drive.tick(WheelSpeeds(math.nan, slow_m_s), 1).result.wheel_speeds == STANDSTILL

    def notices_silence(drive: _Drive) -> bool:
        limits = settings.guard
        longest_s = max(limits.stale_infrared_s, limits.stale_encoder_s) + settings.infrared.period_s
        drive.tick(to_left)
        result = drive.tick(to_left, 2 + round(longest_s / settings.cycle_s), steps=False).result
        return result.wheel_speeds == STANDSTILL and (result.latched or bool(_STALE.intersection(result.reasons)))

    def stays_stopped(drive: _Drive) -> bool:
        drive.tick(to_left)
        drive.robot.emergency_stop(GuardReason.OTHER)
        result = drive.tick(to_left).result
        stopped = result.latched and result.wheel_speeds == STANDSTILL and stands(drive)
        drive.tick(STANDSTILL)
        drive.robot.release()
        return stopped and drive.tick(to_left).result.wheel_speeds != STANDSTILL

    def sends_the_brake(drive: _Drive) -> bool:
        drive.tick(to_left)
        drive.robot.emergency_stop(GuardReason.OTHER)
        watchdog_s = settings.motors.controller_watchdog_s
        drive.left_alone(0.5 * watchdog_s)
        half_way = drive.pose
        drive.left_alone(0.25 * watchdog_s)
        turned_rad = abs(drive.pose.heading_rad - half_way.heading_rad)
        return turned_rad < 0.25 * watchdog_s * slow_m_s / settings.geometry.effective_track_m / 2

    def reads_what_is_there(drive: _Drive) -> bool:
        """Compare readings with those of the simulated sensors, which may be a measurement newer."""
        drive.tick(to_left, 3 * _TICKS)
        counts = drive.tick(STANDSTILL, 2 * _TICKS).readings.infrared_counts
        there = drive.simulation.sensed_counts
        return all(abs(told - true) <= 30 + 0.15 * true for told, true in zip(counts, there, strict=True))

    def feels(end: BumperEnd) -> Callable[[_Drive], bool]:
        against, reason = (1, GuardReason.FRONT_BUMPER) if end is BumperEnd.FRONT else (-1, GuardReason.REAR_BUMPER)
        wanted = WheelSpeeds(against * slow_m_s, against * slow_m_s)

        def keeps(drive: _Drive) -> bool:
            for _ in range(_TICKS):
                drive.tick(wanted, _TICKS)
                if drive.simulation.touching:
                    return reason in drive.tick(wanted, 5).result.reasons
            return False

        return keeps

    def brakes_by_itself(drive: _Drive) -> bool:
        drive.tick(to_left)
        drive.left_alone(settings.motors.controller_watchdog_s + 1.0)
        return stands(drive)

    def brakes_when_closed(drive: _Drive) -> bool:
        drive.tick(to_left)
        drive.robot.close()
        drive.robot.close()
        drive.left_alone(settings.motors.controller_watchdog_s + 1.0)
        return stands(drive)

    def drives_the_same_again() -> bool:
        drives: list[object] = []
        for _ in range(2):
            with closing(factory.open(world, _SEED, _PURPOSE)) as simulation:
                drive = _Drive(simulation, settings)
                drives.append((drive.tick(to_left), drive.pose))
        return drives[0] == drives[1]

    ends = [end for end in BumperEnd if any(bumper.end is end for bumper in settings.bumpers)]
    return [
        ("it senses with each sensor of its table, in counts", tried(reads)),
        ("it stands unless it is told to drive", tried(stands_if_told_to)),
        ("equal set points drive it ahead, and its encoders count the way", tried(goes_ahead)),
        ("a quicker right side turns it to the left", tried(turns_left)),
        ("no set point passes the guard's limits", tried(stays_within_limits)),
        ("it stands for a set point that is not a number", tried(takes_no_nan)),
        ("it stands for a command that is too old", tried(takes_no_old_command)),
        ("it stands when its senses are silent", tried(notices_silence)),
        ("a stop lasts until it is released", tried(stays_stopped)),
        ("it brakes by itself when no command comes", tried(brakes_by_itself)),
        ("it stands after it was closed, which may be twice", tried(brakes_when_closed)),
        ("its readings are those of its sensors, in the order of the table", tried(reads_what_is_there)),
        ("a stop sends the brake", tried(sends_the_brake)),
        *((f"a {end} bumper that touches blocks that way", tried(feels(end))) for end in ends),
        ("equal seeds give equal drives", drives_the_same_again),
    ]
