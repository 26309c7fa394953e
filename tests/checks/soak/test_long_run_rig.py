"""Rig for long runs: faults come and go, drivers follow one another, over any wire."""

import random

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


def drive(rig: LongRunRig, until_s: float, envelope: Envelope | None = None) -> GuardResult:
    """Ahead, tick by tick; the envelope sees what is put on the bus, and what arrives."""
    robot, time = rig.robot, rig.time
    assert robot is not None
    if envelope is not None:
        rig.on_sent = lambda number, payload: envelope.on_sent(
            number, time.now_s(), payload, 0.0, latched=robot.health.latched is not None
        )
        rig.on_control = lambda number, payload, at_s: envelope.on_arrived(number, at_s, payload) and None
    while True:
        time.run_until(time.now_s() + CYCLE_S)
        robot.sense(time.now_s())
        grant = robot.drive(AHEAD, time.now_s(), time.now_s())
        if time.now_s() >= until_s:
            return grant


@pytest.mark.parametrize("wire", ["none", "slow", "lossy"])
def test_a_driver_drives_over_any_wire_and_so_does_the_next_one(rig: LongRunRig, wire: str) -> None:
    for until_s in (1.0, 2.0):
        rig.start_driver(wire)
        assert drive(rig, until_s).wheel_speeds == AHEAD
        assert not rig.standing
        rig.end_driver()
        rig.time.run_until(until_s + 0.5)
        assert rig.standing


def test_long_run_rig_each_fault_ends_at_its_end(rig: LongRunRig) -> None:
    rig.start_driver("none")
    drive(rig, 1.0)
    for target, begin_s in (("sensor_board_1", 1.1), ("encoders", 2.1), ("bus_in", 3.1)):
        rig.begin(target, "off", begin_s=begin_s, end_s=begin_s + 0.3, period_s=1.0, delay_s=1.0)
        assert drive(rig, begin_s + 0.2).wheel_speeds == STANDSTILL
        drive(rig, begin_s + 0.3)
        rig.end()
        assert drive(rig, begin_s + 0.8).wheel_speeds == AHEAD


def test_long_run_rig_resume_on_a_slow_bus_sends_two_old_frames(rig: LongRunRig) -> None:
    robot = rig.start_driver("none")
    envelope = Envelope(TABLE.envelope)
    drive(rig, 1.0, envelope)
    rig.begin("bus_out", "delayed", begin_s=1.0, end_s=9.0, period_s=1.0, delay_s=0.06)
    for goes, until_s in enumerate((2.0, 3.0, 4.0), 1):
        assert drive(rig, until_s, envelope).latched
        assert robot.health.latched == GuardReason.BUS_BLOCKED
        assert envelope.old_frames <= 2 * goes
        robot.release()


def test_long_run_rig_drives_on_after_frame_loss_and_one_resume(rig: LongRunRig) -> None:
    robot = rig.start_driver("none")
    drive(rig, 1.0)
    rig.begin("bus_out", "intermittent", begin_s=1.0, end_s=1.1, period_s=0.2, delay_s=1.0)
    assert drive(rig, 1.5).latched
    rig.end()
    robot.release()
    assert drive(rig, 2.5).wheel_speeds == AHEAD


def test_long_run_rig_wheel_distance_matches_encoders(rig: LongRunRig) -> None:
    robot = rig.start_driver("none")
    ticks = 0
    while rig.time.now_s() < 2.0:
        rig.time.run_until(rig.time.now_s() + CYCLE_S)
        ticks += robot.sense(rig.time.now_s()).encoder_left_ticks
        robot.drive(AHEAD, rig.time.now_s(), rig.time.now_s())
    assert ticks * ROBOT.geometry.metres_per_tick == pytest.approx(rig.turned_m[0], abs=0.001)
    assert rig.turned_m[0] > 0.3


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
        rig = LongRunRig(ROBOT, "a", seed)
        rig.start_driver("lossy")
        drive(rig, random.Random(7).uniform(0.5, 1.0))
        poses.append((rig.simulation.pose, rig.simulation.state_hash()))
        rig.close()
    assert poses[0] == poses[1] != poses[2]
