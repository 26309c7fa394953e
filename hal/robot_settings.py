"""Settings of a robot: geometry, limits, and the law and places of its range sensors."""

import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from config.robot_plugins import find_robot_kind, robot_of_task
from config.settings import Settings, SettingsError, content_of, settings_of
from config.settings_files import find_config
from hal.infrared_law import InfraredLawNumbers, counts_at

Metres = Annotated[float, Field(gt=0, le=5)]
MetresPerSecond = Annotated[float, Field(gt=0, le=3)]
MetresPerSecondSquared = Annotated[float, Field(gt=0, le=20)]
Seconds = Annotated[float, Field(gt=0, le=10)]
Counts = Annotated[int, Field(ge=0, le=1023)]
Coordinate = Annotated[float, Field(ge=-1, le=1)]


class GeometrySettings(Settings):
    """Outline, wheels and mass of the robot, for odometry, plans and the simulated body."""

    outline_length_m: Metres
    outline_width_m: Metres
    wheel_radius_m: Metres
    effective_track_m: Metres
    metres_per_tick: Annotated[float, Field(gt=0, lt=0.01)]
    mass_kg: Annotated[float, Field(gt=0, le=500)]
    yaw_inertia_kg_m2: Annotated[float, Field(gt=0, le=100)]

    @property
    def outline_m(self) -> tuple[float, float]:
        """Length and width of the body."""
        return self.outline_length_m, self.outline_width_m


class MotorSettings(Settings):
    """Abilities of the motors and their speed loop, for the simulator and the watch over the wheels."""

    maximum_speed_m_s: MetresPerSecond
    acceleration_m_s2: MetresPerSecondSquared
    braking_m_s2: MetresPerSecondSquared
    speed_loop_time_s: Seconds
    controller_watchdog_s: Seconds
    """Time without a command after which the robot itself brakes."""


class GuardSettings(Settings):
    """Limits that the guard lays on every decision: speeds, ages of readings, and errors of the wheels."""

    maximum_speed_m_s: MetresPerSecond
    acceleration_m_s2: MetresPerSecondSquared
    braking_m_s2: MetresPerSecondSquared
    stale_infrared_s: Seconds
    stale_encoder_s: Seconds
    stale_bumper_s: Seconds
    command_age_s: Seconds
    ticks_ceased_s: Seconds
    wheel_error_m_s: MetresPerSecond
    wheel_error_share: Annotated[float, Field(ge=0, lt=1)]
    wheel_error_s: Seconds
    frozen_infrared_s: Annotated[float, Field(gt=0, le=3600)]


class SensorSettings(Settings):
    """One row of the sensor table: a distance sensor, or one sector of a scanner.

    `x_m` and `y_m` are its place from the robot's centre, forward and left; `heading_deg` is 0 ahead, 90 to the left.
    Readings come in the order of this table.
    """

    name: str
    label: str
    x_m: Coordinate
    y_m: Coordinate
    heading_deg: Annotated[float, Field(ge=-180, le=180)]


class InfraredSettings(Settings):
    """Range sensors: law from distance to counts, and their table.

    A reading is a whole number of counts from 0 to 1023, the higher the nearer.
    """

    numerator_counts_m: Annotated[float, Field(gt=0)]
    offset_m: Metres
    bias_counts: Annotated[float, Field(ge=0)]
    near_m: Metres
    far_m: Metres
    floor_counts: Counts
    plateau_counts: Counts
    fold_back_from_m: Metres
    fold_back_counts_per_m: Annotated[float, Field(gt=0)]
    fold_back_to_m: Metres
    noise_share: Annotated[float, Field(ge=0, le=0.5)]
    noise_least_counts: Annotated[float, Field(ge=0, le=50)]
    gain_spread_share: Annotated[float, Field(ge=0, le=0.5)]
    period_s: Seconds
    period_spread_s: Annotated[float, Field(ge=0, le=1)]
    beam_width_rad: Annotated[float, Field(ge=0, le=1)]
    sensors: Annotated[tuple[SensorSettings, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _table_is_consistent(self) -> Self:
        self.require_different("name")
        if not self.fold_back_to_m < self.fold_back_from_m <= self.near_m < self.far_m:
            raise ValueError("must hold: fold_back_to_m < fold_back_from_m <= near_m < far_m")
        return self

    def require_different(self, what: str) -> None:
        """Check that no two sensors share a value, such as the name. Raises ValueError."""
        values = [getattr(sensor, what) for sensor in self.sensors]
        twice = sorted({value for value in values if values.count(value) > 1})
        if twice:
            raise ValueError(f"two sensors share the {what} {', '.join(twice)}")

    @property
    def names(self) -> tuple[str, ...]:
        """Sensor names in the order of SensorReadings.infrared_counts."""
        return tuple(sensor.name for sensor in self.sensors)

    @property
    def law(self) -> InfraredLawNumbers:
        """Law of the sensors as plain numbers, for loops that use it often."""
        return InfraredLawNumbers(
            numerator_counts_m=self.numerator_counts_m,
            offset_m=self.offset_m,
            bias_counts=self.bias_counts,
            near_m=self.near_m,
            far_m=self.far_m,
            floor_counts=float(self.floor_counts),
            plateau_counts=float(self.plateau_counts),
            fold_back_from_m=self.fold_back_from_m,
            fold_back_counts_per_m=self.fold_back_counts_per_m,
            fold_back_to_m=self.fold_back_to_m,
        )

    def counts_at(self, distance_m: float) -> float:
        """Return the mean reading, fold-back and floor included, in counts (docs/the-robot.md#infra-red-law)."""
        return counts_at(distance_m, self.law)

    def distance_m(self, counts: float) -> float:
        """Return the distance of a reading in counts, between near_m and far_m; far_m at the floor or below."""
        if counts <= self.floor_counts:
            return self.far_m
        return min(self.far_m, max(self.near_m, self.numerator_counts_m / (counts + self.bias_counts) - self.offset_m))


class BumperEnd(StrEnum):
    """End of the robot at which a bumper sits; a pressed bumper forbids to drive on in its direction."""

    FRONT = "front"
    REAR = "rear"


class BumperSettings(Settings):
    """One bumper; its place in the list is its bit in BUMPERC."""

    name: str
    end: BumperEnd


class RobotSettings(Settings):
    """Settings that every robot has; a kind of robot may add its own (simbridge.contracts.robot_kind)."""

    kind: str
    """Name of the kind of robot."""
    name: str
    cycle_s: Seconds
    """Period of the runtime's tick; a simulated robot advances by it."""
    geometry: GeometrySettings
    motors: MotorSettings
    guard: GuardSettings
    infrared: InfraredSettings
    bumpers: Annotated[tuple[BumperSettings, ...], Field(max_length=8)]

    @model_validator(mode="after")
    def _guard_within_motors(self) -> Self:
        if self.guard.maximum_speed_m_s > self.motors.maximum_speed_m_s:
            raise ValueError(
                f"guard.maximum_speed_m_s is {self.guard.maximum_speed_m_s}, "
                f"allowed is at most motors.maximum_speed_m_s ({self.motors.maximum_speed_m_s})"
            )
        return self


DEFAULT_ROBOT = "kurt2"
"""Robot where neither the user nor the task names one."""


def load_robot(name_or_path: str = "kurt2") -> RobotSettings:
    """Load the settings of a robot: shipped or of a plug-in by name, or a file by path.

    The file's `kind` names the plug-in that knows its schema. Raises config.settings.SettingsError.
    """
    path = find_config("robots", name_or_path)
    return robot_of_content(content_of(path), path)


def load_robot_of(name_or_path: str | None, task: str) -> RobotSettings:
    """Load the settings of a robot by name or path; None: the robot of the task. Raises SettingsError."""
    return load_robot(robot_named(name_or_path, task))


def robot_named(name_or_path: str | None, task: str) -> str:
    """Return a robot's name or path; None: that of the task's robot, which is KURT2 unless the task says other."""
    return name_or_path or robot_that_task_names(task) or DEFAULT_ROBOT


def robot_that_task_names(task: str) -> str | None:
    """Return the robot that a task is for, by name or path; None if it does not say.

    The task's file may name it; else a task of a robot's plug-in, such as `school/fleeing`, is for that robot.
    """
    try:
        content = content_of(find_config("tasks", task))
    except SettingsError:  # the loader of tasks tells more
        return None
    named = content.get("robot") if isinstance(content, dict) else None
    return named if isinstance(named, str) else robot_of_task(task)


def robot_of_json(text: str | bytes, where: Path | str) -> RobotSettings:
    """Return the settings of a robot from JSON, as recordings and packages keep it.

    Raises config.settings.SettingsError that names `where`, also for a kind that is not installed.
    """
    try:
        content = json.loads(text)
    except ValueError as error:
        raise SettingsError(f"not valid JSON: {error}", where=where) from error
    return robot_of_content(content, where)


def robot_of_content(content: Any, where: Path | str) -> RobotSettings:
    """Return the settings of a robot from the content of its file, in the types of JSON.

    Raises config.settings.SettingsError that names `where` and the key, also for a kind that is not installed.
    """
    kind = content.get("kind") if isinstance(content, dict) else None
    if not isinstance(kind, str):
        raise SettingsError(f"kind: should be a valid string (found {kind!r})", where=where)
    try:
        schema: type[RobotSettings] = find_robot_kind(kind).settings
    except SettingsError as error:
        raise SettingsError(f"kind: {error.what} (found {kind!r})", where=where, do=error.do) from error
    return settings_of(content, schema, where)
