"""A second node on an identifier of the robot's readings: it stops the robot and is named, and nothing else is."""

import itertools
from collections.abc import Iterable

import can
import pytest

from hal.bus import CanBus
from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from hal.robot import WheelSpeeds
from hal.sender_watch import SenderWatch
from tests.hal.desk_bus import Ride
from tests.hal.helpers import CODEC, INFRARED_FRAMES, ROBOT, TICK_S, cycle, send

NAMES = (*INFRARED_FRAMES, "ENCODER", "BUMPERC")
FREE = CODEC.message("BUMPERC").pack(0, 0)
TOO_MANY = 43
"""Frames at once that no controller sends: 0.4 s worth of them, at 0.95 of its period."""


def ticks_to_stop(ride: Ride, foreign: Iterable[list[can.Message]]) -> int:
    """Return the number of ticks, each with its foreign frames, until the robot is latched."""
    for tick, frames in enumerate(foreign):
        ride.desk.arrive(*ride.frames(), *frames)
        ride.sleep(TICK_S)
        if ride.decide().latched:
            return tick + 1
    return 0


# The robot stops


@pytest.mark.parametrize("name", NAMES)
def test_second_sender_of_each_identifier_stops_within_1_s(ride: Ride, name: str) -> None:
    foreign = next(frame for frame in ride.frames() if frame.arbitration_id == CODEC.message(name).frame_id)
    assert ticks_to_stop(ride, [[foreign]] * 100) > 0
    health = ride.kurt2.health
    assert health.latched is GuardReason.FOREIGN_TELEMETRY
    assert health.alarm == f"bus can0: another node sends 0x{foreign.arbitration_id:02X} ({name}), too; find and end it"


def test_second_sender_at_half_the_rate_stops_within_1_s(ride: Ride) -> None:
    assert ticks_to_stop(ride, [[FREE], []] * 50) > 0


def test_free_after_each_pressed_does_not_drive(ride: Ride) -> None:
    driven = 0
    for _ in range(400):
        pressed = [*ride.frames()[:-1], CODEC.message("BUMPERC").pack(0b1, 0)]
        ride.desk.arrive(*pressed, FREE)
        ride.sleep(TICK_S)
        driven += max(ride.decide().wheel_speeds) > 0.0
    assert driven == 0
    assert ride.kurt2.health.latched is GuardReason.FOREIGN_TELEMETRY


def test_second_sender_without_stamps_stops_within_1_s(ends: tuple[CanBus, CanBus]) -> None:
    robot = Kurt2(ROBOT, ends[0])
    for tick in range(100):
        now_s = 10.0 + tick * TICK_S
        send(ends[1], [*cycle(200 + tick % 2), FREE])
        robot.sense(now_s)
        robot.drive(WheelSpeeds(0.0, 0.0), now_s, now_s)
    assert robot.health.latched is GuardReason.FOREIGN_TELEMETRY
    robot.close()


def test_go_is_refused_while_it_lasts_and_for_1_s_more(ride: Ride) -> None:
    assert ticks_to_stop(ride, itertools.repeat([FREE], 100))
    alarm = ride.kurt2.health.alarm
    for _ in range(300):
        ride.kurt2.release()
        assert ticks_to_stop(ride, [[FREE]]) == 1
        assert ride.kurt2.health.alarm == alarm
    for _ in range(100):
        ride.kurt2.release()
        assert ride.tick().reasons == (GuardReason.FOREIGN_TELEMETRY,)
    ride.tick()
    ride.kurt2.release()
    assert not ride.drive_for(20.0).latched


def test_second_sender_is_named_after_another_stop_is_released(ride: Ride) -> None:
    ride.kurt2.emergency_stop(GuardReason.SERVICE_ENDS)
    ticks_to_stop(ride, [[FREE]])
    ride.desk.arrive(*TOO_MANY * [FREE])
    assert ride.tick().reasons == (GuardReason.SERVICE_ENDS,)
    ride.kurt2.release()
    assert ride.tick().reasons == (GuardReason.FOREIGN_TELEMETRY,)


# Nothing else does


@pytest.mark.parametrize("hung_s", [0.5, 10.0])  # 7000 frames are more than one drain takes
def test_frames_of_a_hang_are_no_second_sender(ride: Ride, hung_s: float) -> None:
    for _ in range(round(hung_s / TICK_S)):
        ride.desk.arrive(*ride.frames())
        ride.sleep(TICK_S)
    ride.decide()
    assert not ride.drive_for(1.0).latched


def test_4000_frames_without_stamps_are_no_second_sender(ends: tuple[CanBus, CanBus]) -> None:
    robot = Kurt2(ROBOT, ends[0])
    robot.sense(10.0)
    for tick in range(580):
        send(ends[1], cycle(200 + tick % 2))
    for now_s in (15.8, 15.81):
        robot.sense(now_s)
    assert robot.health.latched is None
    robot.close()


def test_repeats_of_a_reading_are_no_second_sender(ride: Ride) -> None:
    for turn in range(600):
        encoder = [ride.frames()[5]]  # ticks count up, so these are not repeated
        ride.desk.arrive(*cycle(200 + turn // 5)[:5], *encoder, FREE)
        ride.sleep(TICK_S)
        assert not ride.decide().latched


def test_controller_that_restarts_is_no_second_sender(ride: Ride) -> None:
    for _ in range(5):
        ride.sleep(0.7)
        ride.desk.arrive(*ride.frames())
        ride.decide()
        ride.desk.arrive(*30 * [FREE])  # the adapter kept these
        ride.drive_for(1.0)
    assert ride.kurt2.health.latched is None


@pytest.mark.parametrize("step_s", [-3600.0, -5.0, -0.3, 0.3, 5.0, 3600.0])
def test_clock_of_the_stamps_that_is_set_is_no_second_sender(ride: Ride, step_s: float) -> None:
    for _ in range(3):
        ride.desk.time_s += step_s
        ride.drive_for(0.5, 0.0, 0.0)
    assert ride.kurt2.health.latched is None


def test_controller_that_is_4_percent_fast_is_no_second_sender(ride: Ride) -> None:
    for _ in range(3000):
        ride.desk.arrive(*ride.frames())
        ride.sleep(0.96 * TICK_S)
        ride.decide(0.0, 0.0)
    assert ride.kurt2.health.latched is None


# The small print


@pytest.fixture
def watch() -> SenderWatch:
    watch = SenderWatch({5: "five", 6: "six"}, TICK_S)
    watch.begin(50.0, 1000.0)
    return watch


def test_surplus_begins_with_the_43rd_frame_at_once(watch: SenderWatch) -> None:
    for _ in range(TOO_MANY - 1):
        watch.count(5, 1000.0)
        watch.count(6, 1000.0)
    assert watch.surplus == ""
    watch.count(6, 1000.0)
    assert watch.surplus == "six"


def test_surplus_at_the_very_limit_is_none(watch: SenderWatch) -> None:
    watch.count(5, 1000.4 - 0.95 * TICK_S)
    assert watch.surplus == ""


def test_surplus_lasts_1_s_of_the_runtimes_clock(watch: SenderWatch) -> None:
    watch.count(5, 1001.0)
    watch.begin(50.999, 1001.0)
    assert watch.surplus == "five"
    watch.begin(51.0, 1001.0)
    assert watch.surplus == ""


@pytest.mark.parametrize(("set_to_s", "surplus"), [(999.91, "five"), (999.89, "")])
def test_clock_counts_as_set_back_from_0_1_s_on(watch: SenderWatch, set_to_s: float, surplus: str) -> None:
    for _ in range(TOO_MANY - 10):
        watch.count(5, 1000.0)
    watch.begin(49.0, set_to_s)  # the runtime's clock was set back, too; that does not count
    for _ in range(10):
        watch.count(5, set_to_s)
    assert watch.surplus == surplus


def test_stamps_slower_than_the_runtime_count_as_set_back(watch: SenderWatch) -> None:
    for _ in range(TOO_MANY - 1):
        watch.count(5, 1000.0)
    watch.begin(50.2, 1000.05)
    for _ in range(TOO_MANY - 1):
        watch.count(5, 1000.05)
    assert watch.surplus == ""


def test_frames_without_stamps_came_since_the_tick_before() -> None:
    watch = SenderWatch({5: "five"}, TICK_S)
    for now_s, frames, surplus in ((1.0, 9999, ""), (2.0, 147, ""), (3.0, 148, "five")):
        since_s = watch.begin(now_s, None)
        assert since_s is not None
        for _ in range(frames):
            watch.count(5, since_s)
        assert watch.surplus == surplus


def test_clock_set_back_without_stamps_forgives_what_waited() -> None:
    watch = SenderWatch({5: "five"}, TICK_S)
    for now_s in (10.0, 9.0):
        since_s = watch.begin(now_s, None)
        assert since_s is not None
        for _ in range(TOO_MANY):
            watch.count(5, since_s)
    assert watch.surplus == ""
