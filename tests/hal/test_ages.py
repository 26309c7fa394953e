"""A frame is as old as the bus says, not as young as the tick that takes it."""

import math

import pytest

from hal.bus import CanBus
from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from hal.robot import WheelSpeeds
from tests.hal.desk_bus import Ride
from tests.hal.helpers import ROBOT, TICK_S, cycle, send

LIMITS = ROBOT.guard
INFRARED, ENCODER, BUMPERS = slice(0, 5), slice(5, 6), slice(6, 7)


def test_frames_of_this_moment_are_young(ride: Ride) -> None:
    assert ride.tick().reasons == ()
    ride.desk.arrive(*ride.frames())
    readings = ride.kurt2.sense(ride.now_s)
    assert (readings.infrared_age_s, readings.encoder_age_s, readings.bumper_age_s) == (0.0, 0.0, 0.0)


def test_frames_that_waited_are_as_old_as_their_stamps(ride: Ride) -> None:
    frames = ride.frames()
    ride.sleep(1.0)
    ride.desk.arrive(*frames[INFRARED], ago_s=0.2)
    ride.desk.arrive(*frames[ENCODER], ago_s=0.3)
    ride.desk.arrive(*frames[BUMPERS], ago_s=0.4)
    readings = ride.kurt2.sense(ride.now_s)
    ages_s = (readings.infrared_age_s, readings.encoder_age_s, readings.bumper_age_s)
    assert ages_s == pytest.approx((0.2, 0.3, 0.4))


def test_of_several_the_newest_counts(ride: Ride) -> None:
    ride.sleep(1.0)
    for ago_s in (0.9, 0.5, 0.01):
        ride.desk.arrive(*ride.frames(), ago_s=ago_s)
    readings = ride.kurt2.sense(ride.now_s)
    ages_s = (readings.infrared_age_s, readings.encoder_age_s, readings.bumper_age_s)
    assert ages_s == pytest.approx((0.01, 0.01, 0.01))


@pytest.mark.parametrize("ago_s", [-0.02, -1.0, -math.inf, math.nan])
def test_a_frame_of_the_future_proves_nothing(ride: Ride, ago_s: float) -> None:
    for _ in range(12):
        ride.sleep(TICK_S)
        ride.desk.arrive(*ride.frames(), ago_s=ago_s)
        grant = ride.decide()
    assert grant.reasons == (GuardReason.INFRARED_STALE,)
    assert ride.kurt2.health.junk == 12 * len(ride.frames())


def test_clocks_that_differ_by_a_moment_are_no_matter(ride: Ride) -> None:
    ride.sleep(TICK_S)
    ride.desk.arrive(*ride.frames(), ago_s=-0.005)
    assert ride.decide().reasons == ()
    assert ride.kurt2.sense(ride.now_s).infrared_age_s == 0.0


@pytest.mark.parametrize(
    ("old", "ago_s", "reason"),
    [
        (INFRARED, LIMITS.stale_infrared_s + 0.001, GuardReason.INFRARED_STALE),
        (ENCODER, LIMITS.stale_encoder_s + 0.001, GuardReason.ENCODER_STALE),
        (BUMPERS, LIMITS.stale_bumper_s + 0.001, GuardReason.BUMPER_STALE),
    ],
)
def test_a_robot_with_old_feelings_stands(ride: Ride, old: slice, ago_s: float, reason: str) -> None:
    ride.sleep(0.09)
    frames = ride.frames()
    ride.desk.arrive(*(frame for frame in frames if frame not in frames[old]))
    ride.desk.arrive(*frames[old], ago_s=ago_s)
    assert ride.decide().reasons == (reason,)


def test_ages_after_hang_stand_until_fresh_frames(ride: Ride) -> None:
    for _ in range(40):  # so many cycles the kernel keeps, and no more
        ride.sleep(TICK_S)
        ride.desk.arrive(*ride.frames())
    ride.sleep(0.6)
    for _ in range(3):
        assert ride.decide().reasons == (GuardReason.INFRARED_STALE,)
        ride.sleep(TICK_S)
    assert ride.tick(0.01, 0.01).reasons == ()


def test_ages_after_clock_ran_backwards_are_infinite(ends: tuple[CanBus, CanBus]) -> None:
    robot = Kurt2(ROBOT, ends[0])
    send(ends[1], cycle())
    robot.sense(1000.0)
    readings = robot.sense(10.0)
    assert readings.infrared_age_s == readings.encoder_age_s == readings.bumper_age_s == math.inf
    assert robot.drive(WheelSpeeds(0.3, 0.3), 10.0, 10.0).reasons == (GuardReason.INFRARED_STALE,)
    send(ends[1], cycle())
    assert robot.sense(10.0).infrared_age_s == 0.0
    robot.close()
