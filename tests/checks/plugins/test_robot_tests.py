"""The inherited tests of a robot: KURT2 passes, and one that is careless in one respect fails the test about it."""

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from config import CONFIG_DIR
from hal.guard_reason import GuardReason
from hal.guarded_robot import GuardedRobot
from hal.robot import STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from hal.robot_settings import RobotSettings, load_robot
from hal.tap import Tap
from kurt2rt.checks.plugins.robot_tests import RobotTests
from kurt2rt.robots.kurt2 import KURT2
from simbridge.contracts.simulation import Simulation, SimulationFactory


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
        other = {GuardReason.FRONT_BUMPER: GuardReason.REAR_BUMPER, GuardReason.REAR_BUMPER: GuardReason.FRONT_BUMPER}
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


class TestKurt2(RobotTests):
    kind = KURT2


@pytest.mark.parametrize(
    ("careless", "promise"),
    [
        (LosesASensor, "it_senses_with_each_sensor_of_its_table_in_counts"),
        (CreepsWithoutCommand, "it_stands_unless_it_is_told_to_drive"),
        (CountsTwice, "equal_set_points_drive_it_ahead_and_its_encoders_count_the_way"),
        (SwapsSides, "a_quicker_right_side_turns_it_to_the_left"),
        (AppliesAnything, "no_set_point_passes_the_limits_of_the_guard"),
        (TakesNanForSlow, "it_stands_for_a_set_point_that_is_not_a_number"),
        (TakesOldForNew, "it_stands_for_a_command_that_is_too_old"),
        (IgnoresSilence, "it_stands_when_its_senses_are_silent"),
        (ReleasesItself, "a_stop_lasts_until_it_is_released"),
        (ReversesItsTable, "its_readings_are_those_of_its_sensors_in_the_order_of_the_table"),
        (SendsNoBrake, "a_stop_sends_the_brake"),
        (FeelsTheOtherEnd, "a_front_bumper_that_touches_blocks_that_way"),
        (FeelsTheOtherEnd, "a_rear_bumper_that_touches_blocks_that_way"),
    ],
)
def test_careless_robot_fails_the_test_about_it(careless: type[Wrapped], promise: str) -> None:
    tests = RobotTests()
    tests.kind = CarelessKind(careless)
    with tests.opened(load_robot()) as drive, pytest.raises(AssertionError):
        getattr(tests, f"test_{promise}")(drive)


def test_robot_that_cannot_be_closed_twice_fails() -> None:
    tests = RobotTests()
    tests.kind = CarelessKind(CannotBeClosedTwice)
    with pytest.raises(RuntimeError, match="closed already"), tests.opened(load_robot()) as drive:
        tests.test_it_stands_after_it_was_closed_which_may_be_twice(drive)


def test_robot_without_settings_is_refused(tmp_path: Path) -> None:
    tests = RobotTests()
    tests.kind = CarelessKind(Wrapped, folder=tmp_path)
    wanting = SimpleNamespace(fixturenames=["settings"])
    with pytest.raises(AssertionError, match="holds no settings of a robot"):
        tests.pytest_generate_tests(cast("pytest.Metafunc", wanting))
