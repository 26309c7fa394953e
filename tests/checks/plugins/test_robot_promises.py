"""Promises of a robot: KURT2 keeps all, and a robot that is careless in one respect breaks the one about it."""

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from config import CONFIG_DIR
from hal.guard_reason import GuardReason
from hal.guarded_robot import GuardedRobot
from hal.robot import STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from hal.robot_kind import RobotKind
from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from hal.simulation import Simulation, SimulationFactory
from hal.tap import Tap
from kurt2rt.checks.plugins.robot_promises import broken_of_robot
from kurt2rt.robots.kurt2 import KURT2


class Wrapped:
    """Driver of KURT2 that a subclass makes careless."""

    def __init__(self, robot: Any) -> None:
        self.robot = robot

    def sense(self, now_s: float) -> SensorReadings:
        readings: SensorReadings = self.robot.sense(now_s)
        return readings

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        result: GuardResult = self.robot.drive(wanted, decided_at_s, now_s)
        return result

    def emergency_stop(self, reason: GuardReason) -> None:
        self.robot.emergency_stop(reason)

    def release(self) -> None:
        self.robot.release()

    def close(self) -> None:
        self.robot.close()


class LosesASensor(Wrapped):
    def sense(self, now_s: float) -> SensorReadings:
        readings = super().sense(now_s)
        return readings._replace(infrared_counts=readings.infrared_counts[1:])


class CountsTwice(Wrapped):
    def sense(self, now_s: float) -> SensorReadings:
        readings = super().sense(now_s)
        return readings._replace(encoder_left_ticks=2 * readings.encoder_left_ticks)._replace(
            encoder_right_ticks=2 * readings.encoder_right_ticks
        )


class SwapsSides(Wrapped):
    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        return super().drive(WheelSpeeds(*wanted[::-1]), decided_at_s, now_s)


class AppliesAnything(Wrapped):
    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        return super().drive(wanted, decided_at_s, now_s)._replace(wheel_speeds=wanted)


class TakesNanForSlow(Wrapped):
    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        known = WheelSpeeds(*(0.1 if math.isnan(each) else each for each in wanted))
        return super().drive(known, decided_at_s, now_s)


class TakesOldForNew(Wrapped):
    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:  # noqa: ARG002
        return super().drive(wanted, now_s, now_s)


class CreepsWithoutCommand(Wrapped):
    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        creeping = WheelSpeeds(-0.1, 0.1) if wanted == STANDSTILL else wanted
        return super().drive(creeping, decided_at_s, now_s)


class IgnoresSilence(Wrapped):
    """Says that the newest readings are fresh."""

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        result = super().drive(wanted, decided_at_s, now_s)
        return GuardResult(wanted, (), latched=False) if GuardReason.INFRARED_STALE in result.reasons else result


class ReversesItsTable(Wrapped):
    def sense(self, now_s: float) -> SensorReadings:
        readings = super().sense(now_s)
        return readings._replace(infrared_counts=readings.infrared_counts[::-1])


class SendsNoBrake(Wrapped):
    def emergency_stop(self, reason: GuardReason) -> None:
        pass


class FeelsTheOtherEnd(Wrapped):
    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        result = super().drive(wanted, decided_at_s, now_s)
        other = {
            GuardReason.FRONT_BUMPER: GuardReason.REAR_BUMPER,
            GuardReason.REAR_BUMPER: GuardReason.FRONT_BUMPER,
        }
        return result._replace(reasons=tuple(other.get(each, each) for each in result.reasons))


class ReleasesItself(Wrapped):
    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        self.robot.release()
        return super().drive(wanted, decided_at_s, now_s)


class CannotBeClosedTwice(Wrapped):
    closed = False

    def close(self) -> None:
        if self.closed:
            raise RuntimeError("closed already")
        self.closed = True
        super().close()


@dataclasses.dataclass
class CarelessFactory:
    """Factory of simulations whose driver is careless."""

    factory: SimulationFactory
    careless: Callable[[Any], Wrapped]

    def open(self, world: str, seed: int, purpose: str) -> Simulation:
        simulation: Any = self.factory.open(world, seed, purpose)
        simulation.robot = self.careless(simulation.robot)
        opened: Simulation = simulation
        return opened

    def __getattr__(self, name: str) -> Any:
        return getattr(self.factory, name)


@dataclasses.dataclass
class CarelessKind:
    """Kind of robot with a careless driver."""

    careless: Callable[[Any], Wrapped]
    settings: type[RobotSettings] = KURT2.settings
    folder: Path = CONFIG_DIR

    def open(self, settings: RobotSettings, address: str, tap: Tap | None = None) -> GuardedRobot:
        return KURT2.open(settings, address, tap)

    def simulations(self, settings: RobotSettings) -> SimulationFactory:
        factory: Any = CarelessFactory(KURT2.simulations(settings), self.careless)
        made: SimulationFactory = factory
        return made

    def serve(self, settings: RobotSettings, address: str) -> object:
        return KURT2.serve(settings, address)


def test_kurt2_keeps_all_promises() -> None:
    assert broken_of_robot(KURT2, "kurt2") == []


@pytest.mark.parametrize(
    ("careless", "promise"),
    [
        (LosesASensor, "senses with each sensor"),
        (CreepsWithoutCommand, "stands unless it is told"),
        (CountsTwice, "encoders count the way"),
        (SwapsSides, "turns it to the left"),
        (AppliesAnything, "passes the guard's limits"),
        (TakesNanForSlow, "not a number"),
        (TakesOldForNew, "too old"),
        (IgnoresSilence, "senses are silent"),
        (ReleasesItself, "lasts until it is released"),
        (ReversesItsTable, "in the order of the table"),
        (SendsNoBrake, "a stop sends the brake"),
        (FeelsTheOtherEnd, "a front bumper that touches"),
        (FeelsTheOtherEnd, "a rear bumper that touches"),
        (CannotBeClosedTwice, "closed, which may be twice"),
    ],
)
def test_careless_robot_breaks_the_promise(careless: type[Wrapped], promise: str) -> None:
    kind: RobotKind = CarelessKind(careless)
    (broken,) = broken_of_robot(kind, "careless", only=promise)
    assert promise in broken


def test_robot_without_settings_is_refused(tmp_path: Path) -> None:
    kind: RobotKind = CarelessKind(Wrapped, folder=tmp_path)
    with pytest.raises(SettingsError, match="has no settings"):
        broken_of_robot(kind, "empty")
