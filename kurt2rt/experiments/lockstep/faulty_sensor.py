"""Faults of one infra-red sensor, laid over the readings of a robot."""

import random
from enum import StrEnum
from typing import NamedTuple

from config.errors import guess
from config.settings import SettingsError
from hal.guard_reason import GuardReason
from hal.robot import HIGHEST_COUNTS, GuardResult, Robot, SensorReadings, WheelSpeeds
from hal.robot_settings import InfraredSettings


class FaultKind(StrEnum):
    """Fault of an infra-red sensor that an exam simulates, by what its reading then is."""

    LOW = "low"
    """It repeats the floor of its law, as with nothing in view."""
    HIGH = "high"
    """It repeats the plateau of its law, as with an obstacle at 10 cm."""
    FROZEN = "frozen"
    """It repeats its last reading."""
    UNPLUGGED = "unplugged"
    """Its channel of the converter is open and reads 0 to 3 counts."""
    DARK = "dark"
    """It sees nothing, with the noise of a working sensor."""
    PHANTOM = "phantom"
    """It sees an obstacle at 10 cm that is not there, with the noise of a working sensor."""


BREAKS_AT_S = 2.0
"""Time of a drive from which on the sensor is broken."""
_OPEN_INPUT_COUNTS = 3


class SensorBreak(NamedTuple):
    """Sensor that an exam breaks BREAKS_AT_S after its start, and how."""

    place: int
    """Place in the sensor table."""
    kind: FaultKind

    def apply(self, robot: Robot, infrared: InfraredSettings) -> "FaultySensor":
        """Return the robot with this sensor breaking."""
        return FaultySensor(robot, infrared, self.place, self.kind, BREAKS_AT_S)


def parse_break(text: str, infrared: InfraredSettings) -> SensorBreak:
    """Return the break of a sensor that is given as `s15=low`. Raises SettingsError."""
    name, _, kind = text.partition("=")
    for given, what, known in ((name, "sensor", infrared.names), (kind, "fault", tuple(FaultKind))):
        if given not in known:
            raise SettingsError(
                f"there is no {what} {given!r}",
                where=f"broken sensor {text}",
                do=f"give SENSOR=FAULT, such as s15=low; the {what}s are {', '.join(known)}{guess(given, known)}",
            )
    return SensorBreak(infrared.names.index(name), FaultKind(kind))


class RobotProxy:
    """Robot that forwards all calls to another robot (hal.robot.Robot); a subclass overrides some."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def sense(self, now_s: float) -> SensorReadings:
        """Return the readings of the robot at `now_s`, in s."""
        return self._robot.sense(now_s)

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """Forward a request to the robot and return its guard's result; speeds in m/s, times in s."""
        return self._robot.drive(wanted, decided_at_s, now_s)

    def emergency_stop(self, reason: GuardReason) -> None:
        """Brake the robot now; it stays stopped until `release`."""
        self._robot.emergency_stop(reason)

    def release(self) -> None:
        """End a latched stop of the robot, unless its cause lasts."""
        self._robot.release()

    def close(self) -> None:
        """Stop the wheels of the robot and close its bus."""
        self._robot.close()


class FaultySensor(RobotProxy):
    """Proxy of a robot that replaces the readings of one range sensor from a time on (fault injection).

    `kurt2rt exam --broken-sensor s15=low` drives one; the runtime and the guard see only the false readings.
    """

    def __init__(self, robot: Robot, infrared: InfraredSettings, place: int, kind: FaultKind, from_s: float) -> None:
        """Break the sensor at `place` of the sensor table from `from_s` of the runtime's clock on, in s."""
        super().__init__(robot)
        self._infrared = infrared
        self._place = place
        self._kind = kind
        self._from_s = from_s
        self._chance = random.Random(f"{kind} sensor {place}")
        self._measured: int | None = None
        self._reading = 0

    def sense(self, now_s: float) -> SensorReadings:
        """Return the readings of the robot at `now_s`, in s, with that of the broken sensor."""
        readings = self._robot.sense(now_s)
        counts, place = readings.infrared_counts, self._place
        if now_s < self._from_s:
            return readings
        if counts[place] != self._measured:  # a new measurement
            self._reading = self._read(counts[place])
            self._measured = counts[place]
        return readings._replace(infrared_counts=(*counts[:place], self._reading, *counts[place + 1 :]))

    def _read(self, true_counts: int) -> int:
        """Return a new measurement of the broken sensor, in counts."""
        infrared = self._infrared
        match self._kind:
            case FaultKind.LOW:
                return infrared.floor_counts
            case FaultKind.HIGH:
                return infrared.plateau_counts
            case FaultKind.FROZEN:
                return true_counts if self._measured is None else self._reading
            case FaultKind.UNPLUGGED:
                return self._chance.randint(0, _OPEN_INPUT_COUNTS)
            case FaultKind.DARK:
                return self._noisy(infrared.floor_counts)
            case FaultKind.PHANTOM:
                return self._noisy(infrared.plateau_counts)

    def _noisy(self, counts: int) -> int:
        sigma = max(self._infrared.noise_share * counts, self._infrared.noise_least_counts)
        return min(max(round(self._chance.gauss(counts, sigma)), 0), HIGHEST_COUNTS)
