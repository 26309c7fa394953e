"""Guards that are not careful enough, each in one respect; the envelope has to notice every one of them."""

import math
from collections.abc import Callable
from typing import Any

from hal.bus import CanBus
from hal.can_wheel_port import CanWheelPort
from hal.guard import Guard
from hal.guard_reason import GuardReason
from hal.kurt2_settings import Kurt2Settings, SpeedMode
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from hal.robot_settings import BumperEnd, BumperSettings
from tests.hal.helpers import guard_on

MakeGuard = Callable[[Kurt2Settings, CanBus], Guard]


def with_limits(**factors: float) -> MakeGuard:
    """Believes its limits to be wider by these factors."""

    def make(robot: Kurt2Settings, bus: CanBus) -> Guard:
        wider = {name: getattr(robot.guard, name) * factor for name, factor in factors.items()}
        return guard_on(robot.model_copy(update={"guard": robot.guard.model_copy(update=wider)}), bus)

    return make


def with_settings(**settings: Any) -> MakeGuard:
    """Believes other settings."""

    def make(robot: Kurt2Settings, bus: CanBus) -> Guard:
        return guard_on(robot.model_copy(update=settings), bus)

    return make


def with_mode(mode: SpeedMode) -> MakeGuard:
    """Believes its controller to be in another mode."""

    def make(robot: Kurt2Settings, bus: CanBus) -> Guard:
        return guard_on(robot.model_copy(update={"can": robot.can.model_copy(update={"speed_mode": mode})}), bus)

    return make


def of_kind(kind: type[Guard]) -> MakeGuard:
    """Return the maker of a careless guard on a bus."""
    return lambda robot, bus: kind(robot, CanWheelPort(robot, bus))


def with_bumpers(believed: Callable[[BumperSettings], BumperSettings]) -> MakeGuard:
    """Believes its bumpers to be elsewhere."""

    def make(robot: Kurt2Settings, bus: CanBus) -> Guard:
        return guard_on(robot.model_copy(update={"bumpers": tuple(map(believed, robot.bumpers))}), bus)

    return make


def at_the(end: BumperEnd) -> Callable[[BumperSettings], BumperSettings]:
    return lambda bumper: bumper.model_copy(update={"end": end})


class TakesNoneForZero(Guard):
    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        number = WheelSpeeds(*(speed if math.isfinite(speed) else 0.1 for speed in wanted))
        return super().drive(number, readings, decided_at_s, now_s)


class TakesNoTimeForFresh(Guard):
    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        ages = [0.0 if math.isnan(age) else age for age in (readings.infrared_age_s, readings.encoder_age_s)]
        known = readings._replace(infrared_age_s=ages[0], encoder_age_s=ages[1])
        return super().drive(wanted, known, decided_at_s, now_s)


class TakesAnyAgeBelowForFresh(Guard):
    """Takes frames for fresh that came, by their times, after the readings."""

    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        ages = readings.infrared_age_s, readings.encoder_age_s, readings.bumper_age_s
        infrared, encoder, bumper = (0.0 if age < 0.0 else age for age in ages)
        aged = readings._replace(infrared_age_s=infrared, encoder_age_s=encoder, bumper_age_s=bumper)
        return super().drive(wanted, aged, decided_at_s, now_s)


class TrustsTheFuture(Guard):
    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        return super().drive(
            wanted, readings._replace(time_s=min(now_s, readings.time_s)), min(now_s, decided_at_s), now_s
        )


class NeverLooksBack(Guard):
    """Overlooks that the clock ran backwards."""

    latest_s = -math.inf

    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        ahead_s = max(0.0, self.latest_s - now_s) if math.isfinite(now_s) else 0.0
        self.latest_s = max(self.latest_s, now_s) if math.isfinite(now_s) else self.latest_s
        shifted = readings._replace(time_s=readings.time_s + ahead_s)
        return super().drive(wanted, shifted, decided_at_s + ahead_s, now_s + ahead_s)


class Forgetful(Guard):
    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        self.release()
        return super().drive(wanted, readings, decided_at_s, now_s)


class BelievesTheLast(Guard):
    def emergency_stop(self, reason: GuardReason) -> None:
        self.release()
        super().emergency_stop(reason)


class StopsAtTheNextTick(Guard):
    due: GuardReason | None = None

    def emergency_stop(self, reason: GuardReason) -> None:
        self.due = self.due or reason

    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        if self.due is not None:
            super().emergency_stop(self.due)
            self.due = None
        return super().drive(wanted, readings, decided_at_s, now_s)


class IgnoresTheWatchdog(Guard):
    def emergency_stop(self, reason: GuardReason) -> None:
        if reason != GuardReason.TICKS_CEASED:
            super().emergency_stop(reason)


class ReleasesItself(Guard):
    """Gets over a stop of its own, as if nothing had been."""

    why = GuardReason.BUS_LOST

    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        grant = super().drive(wanted, readings, decided_at_s, now_s)
        if self.latched == self.why:
            self.release()
        return grant


class OverlooksABlockedBus(ReleasesItself):
    why = GuardReason.BUS_BLOCKED


class NeverReleases(Guard):
    def release(self) -> None:
        pass


class SaysTwice(Guard):
    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        super().drive(wanted, readings, decided_at_s, now_s)
        return super().drive(wanted, readings, decided_at_s, now_s)


class SaysOtherThanItDoes(Guard):
    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        grant = super().drive(wanted, readings, decided_at_s, now_s)
        return grant if grant.latched else grant._replace(wheel_speeds=wanted)


class GivesNoReasons(Guard):
    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        return super().drive(wanted, readings, decided_at_s, now_s)._replace(reasons=())


class NeverMoves(Guard):
    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        return super().drive(WheelSpeeds(*(0.0 for _ in wanted)), readings, decided_at_s, now_s)


class DrivesTheOtherWay(Guard):
    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        return super().drive(WheelSpeeds(-wanted[0], -wanted[1]), readings, decided_at_s, now_s)


class DrivesBackBeforeItRests(Guard):
    """A wheel turns the other way without having come to rest."""

    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        reverses = any(speed * was < 0.0 for speed, was in zip(wanted, self.was, strict=True))
        if reverses and self.latched is None:
            super().drive(WheelSpeeds(0.0, 0.0), readings, decided_at_s, now_s)
        grant = super().drive(wanted, readings, decided_at_s, now_s)
        self.was = grant.wheel_speeds
        return grant

    was = WheelSpeeds(0.0, 0.0)


CARELESS: dict[str, tuple[MakeGuard, str]] = {
    "too fast": (with_limits(maximum_speed_m_s=1.03), "faster than it may"),
    "too lively": (with_limits(acceleration_m_s2=1.3), "further than the slew limits let it"),
    "not slewed": (with_limits(acceleration_m_s2=1e9), "further than the slew limits let it"),
    "slows down too hard": (with_limits(braking_m_s2=1.3), "further than the slew limits let it"),
    "patient with infra-red": (with_limits(stale_infrared_s=1.0001), "drives on, but: range sensors stale"),
    "patient with encoders": (with_limits(stale_encoder_s=1.0001), "drives on, but: encoder stale"),
    "patient with bumpers": (with_limits(stale_bumper_s=1.0001), "drives on, but: bumper stale"),
    "patient with commands": (with_limits(command_age_s=1.0001), "drives on, but: command too old"),
    "far too patient with commands": (with_limits(command_age_s=3.0), "a command older than 20 ms"),
    "jumps after a late tick": (with_settings(cycle_s=0.1), "further than the slew limits let it"),
    "in another mode": (with_mode(SpeedMode.SPEED), "a frame is no set point of the robot's mode"),
    "no bumper in front": (with_bumpers(at_the(BumperEnd.REAR)), "forward against a bumper"),
    "no bumper behind": (with_bumpers(at_the(BumperEnd.FRONT)), "backward against a bumper"),
    "takes none for zero": (of_kind(TakesNoneForZero), "drives on, but: not a number"),
    "takes no time for fresh": (of_kind(TakesNoTimeForFresh), "drives on, but: encoder stale"),
    "takes any age below for fresh": (of_kind(TakesAnyAgeBelowForFresh), "drives on, but: range sensors stale"),
    "trusts the future": (of_kind(TrustsTheFuture), "drives on, but: clock ran backwards"),
    "never looks back": (of_kind(NeverLooksBack), "drives on, but: clock ran backwards"),
    "forgetful": (of_kind(Forgetful), "latched, and no brake goes out"),
    "believes the last": (of_kind(BelievesTheLast), "it is latched for another reason"),
    "stops at the next tick": (of_kind(StopsAtTheNextTick), "a stop does not send a brake at once"),
    "ignores the watchdog": (of_kind(IgnoresTheWatchdog), "a stop does not send a brake at once"),
    "gets over a lost bus": (of_kind(ReleasesItself), "it is latched for another reason"),
    "gets over a blocked bus": (of_kind(OverlooksABlockedBus), "it is latched for another reason"),
    "never releases": (of_kind(NeverReleases), "it does not say that it is latched"),
    "says it twice": (of_kind(SaysTwice), "not one frame a tick"),
    "says other than it does": (of_kind(SaysOtherThanItDoes), "it grants something else than it sends"),
    "gives no reasons": (of_kind(GivesNoReasons), "it does otherwise and says not why"),
    "never moves": (of_kind(NeverMoves), "it holds back what it may grant"),
    "drives the other way": (of_kind(DrivesTheOtherWay), "away from what is wanted"),
    "drives back before it rests": (of_kind(DrivesBackBeforeItRests), "not one frame a tick"),
}
"""Fault of each careless guard, and a rule that it breaks."""
