"""The place that lasts: faults come and go, drivers follow one another, and the bus is what it is each time."""

import random
from collections.abc import Iterator

import pytest

from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from kurt2rt.checks.faults.envelope import Envelope
from kurt2rt.checks.faults.failing_clock import SoakClock
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.long_run_rig import LongRunRig
from simbridge.faults.timed_fault import TimedFault
from tests.checks.soak.helpers import CYCLE_S, ROBOT, TABLE

AHEAD = WheelSpeeds(0.2, 0.2)


@pytest.fixture
def place() -> Iterator[LongRunRig]:
    place = LongRunRig(ROBOT, "a", seed=2)
    yield place
    place.close()


def drive(place: LongRunRig, until_s: float, envelope: Envelope | None = None) -> GuardResult:
    """Ahead, tick by tick; the envelope sees what is put on the bus, and what arrives."""
    robot, time = place.robot, place.time
    assert robot is not None
    if envelope is not None:
        place.on_sent = lambda number, payload: envelope.on_sent(
            number, time.now_s(), payload, 0.0, latched=robot.health.latched is not None
        )
        place.on_control = lambda number, payload, at_s: envelope.on_arrived(number, at_s, payload) and None
    while True:
        time.run_until(time.now_s() + CYCLE_S)
        robot.sense(time.now_s())
        grant = robot.drive(AHEAD, time.now_s(), time.now_s())
        if time.now_s() >= until_s:
            return grant


@pytest.mark.parametrize("wire", ["none", "one_megabit", "lossy"])
def test_a_driver_drives_over_any_wire_and_so_does_the_next_one(place: LongRunRig, wire: str) -> None:
    for until_s in (1.0, 2.0):
        place.start_driver(wire)
        assert drive(place, until_s).wheel_speeds == AHEAD
        assert not place.standing
        place.end_driver()
        place.time.run_until(until_s + 0.5)
        assert place.standing


def test_long_run_rig_each_fault_ends_at_its_end(place: LongRunRig) -> None:
    place.start_driver("none")
    drive(place, 1.0)
    for target, begin_s in (("sensor_board_1", 1.1), ("encoders", 2.1), ("bus_in", 3.1)):
        place.begin(target, "off", begin_s=begin_s, end_s=begin_s + 0.3, period_s=1.0, delay_s=1.0)
        assert drive(place, begin_s + 0.2).wheel_speeds == STANDSTILL
        drive(place, begin_s + 0.3)
        place.end()
        assert drive(place, begin_s + 0.8).wheel_speeds == AHEAD


def test_long_run_rig_resume_on_a_slow_bus_sends_two_old_frames(place: LongRunRig) -> None:
    robot = place.start_driver("none")
    envelope = Envelope(TABLE.envelope)
    drive(place, 1.0, envelope)
    place.begin("bus_out", "delayed", begin_s=1.0, end_s=9.0, period_s=1.0, delay_s=0.06)
    for goes, until_s in enumerate((2.0, 3.0, 4.0), 1):
        assert drive(place, until_s, envelope).latched
        assert robot.health.latched == GuardReason.BUS_BLOCKED
        assert envelope.old_frames <= 2 * goes
        robot.release()


def test_long_run_rig_drives_on_after_frame_loss_and_one_resume(place: LongRunRig) -> None:
    robot = place.start_driver("none")
    drive(place, 1.0)
    place.begin("bus_out", "intermittent", begin_s=1.0, end_s=1.1, period_s=0.2, delay_s=1.0)
    assert drive(place, 1.5).latched
    place.end()
    robot.release()
    assert drive(place, 2.5).wheel_speeds == AHEAD


def test_long_run_rig_wheel_distance_matches_encoders(place: LongRunRig) -> None:
    robot = place.start_driver("none")
    ticks = 0
    while place.time.now_s() < 2.0:
        place.time.run_until(place.time.now_s() + CYCLE_S)
        ticks += robot.sense(place.time.now_s()).encoder_left_ticks
        robot.drive(AHEAD, place.time.now_s(), place.time.now_s())
    assert ticks * ROBOT.geometry.metres_per_tick == pytest.approx(place.turned_m[0], abs=0.001)
    assert place.turned_m[0] > 0.3


async def test_a_clock_that_went_slow_does_not_get_back_what_it_lost() -> None:
    time = EventScheduler()
    clock = SoakClock(time)
    await clock.wait_until(1.0)
    clock.disturb(TimedFault("slow", 1.0, 2.0, 1.0, 1.0))
    await clock.wait_until(1.5)
    assert time.now_s() == pytest.approx(2.0, abs=0.001)
    clock.clear()
    assert clock.now_s() == pytest.approx(1.5, abs=0.001)
    await clock.wait_until(2.5)
    assert time.now_s() == pytest.approx(3.0, abs=0.001)


def test_the_same_seed_stands_at_the_same_place() -> None:
    poses = []
    for seed in (1, 1, 2):
        place = LongRunRig(ROBOT, "a", seed)
        place.start_driver("lossy")
        drive(place, random.Random(7).uniform(0.5, 1.0))
        poses.append((place.simulation.pose, place.simulation.state_hash()))
        place.close()
    assert poses[0] == poses[1] != poses[2]
