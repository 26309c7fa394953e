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
        assert ride.kurt2.health.latched is GuardReason.FOREIGN_TELEMETRY  # before the drive of that tick
        assert ticks_to_stop(ride, [[FREE]]) == 1
        assert ride.kurt2.health.alarm == alarm
    for _ in range(100):
        ride.kurt2.release()
        assert ride.tick().reasons == (GuardReason.FOREIGN_TELEMETRY,)
    ride.drive_for(0.25)  # until the next look
    ride.kurt2.release()
    assert not ride.drive_for(20.0).latched


def test_second_sender_is_named_after_another_stop_is_released(ride: Ride) -> None:
    ride.kurt2.emergency_stop(GuardReason.SERVICE_ENDS)
    ride.desk.arrive(*100 * [FREE])
    assert ride.drive_for(0.5).reasons == (GuardReason.SERVICE_ENDS,)
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


class Counted:
    """Two identifiers whose frames a test counts, each of which is due every 9.5 s."""

    def __init__(self) -> None:
        self.frames = [100, 100]
        self.watch = SenderWatch(("five", "six"), self.frames, 10.0)
        self.look(50.0, 0.0, 9999, 9999)

    def look(self, now_s: float, bus_now_s: float | None, *came: int, more_wait: bool = False, ticks: int = 25) -> str:
        """Return the surplus after so many ticks, in which these frames came."""
        for place, frames in enumerate(came):
            self.frames[place] += frames
        for _ in range(ticks):
            self.watch.update(now_s, bus_now_s, more_wait=more_wait)
        return self.watch.surplus


@pytest.fixture
def counted() -> Counted:
    return Counted()


def test_surplus_of_the_first_look_is_none(counted: Counted) -> None:
    assert counted.watch.surplus == ""


@pytest.mark.parametrize(("elapsed_s", "surplus"), [(18.81, ""), (18.8, ""), (18.79, "six")])
def test_two_frames_of_19_s_come_0_2_s_early_at_most(counted: Counted, elapsed_s: float, surplus: str) -> None:
    assert counted.look(50.0, elapsed_s, 1, 2) == surplus


def test_frames_are_due_after_the_look_that_found_some(counted: Counted) -> None:
    assert counted.look(60.0, 10.0, 1) == ""
    assert counted.look(80.0, 30.0, 0) == ""
    assert counted.look(86.0, 36.0, 2) == ""  # 26 s after the last ones
    assert counted.look(94.0, 44.0, 1) == "five"  # 9.5 s later was soon enough


def test_frames_too_many_are_not_held_against_later_ones(counted: Counted) -> None:
    assert counted.look(50.0, 0.0, 1000) == "five"
    assert counted.look(51.0, 1.0) == ""
    assert counted.look(59.6, 9.6, 1) == ""


def test_surplus_lasts_1_s(counted: Counted) -> None:
    assert counted.look(50.0, 0.0, 9) == "five"
    assert counted.look(50.99, 0.99) == "five"
    assert counted.look(51.0, 1.0) == ""


@pytest.mark.parametrize(
    ("now_s", "bus_now_s"), [(69.0, 0.0), (50.0, 19.0), (69.0, -100.0), (10.0, 19.0), (69.0, None)]
)
def test_time_goes_by_the_faster_clock(counted: Counted, now_s: float, bus_now_s: float | None) -> None:
    assert counted.look(now_s, bus_now_s, 2) == ""


@pytest.mark.parametrize(("now_s", "bus_now_s"), [(50.0, 0.0), (10.0, -100.0)])
def test_time_never_goes_back(counted: Counted, now_s: float, bus_now_s: float) -> None:
    assert counted.look(now_s, bus_now_s, 0, 2) == "six"


def test_looks_are_25_ticks_apart(counted: Counted) -> None:
    assert counted.look(50.0, 0.0, 9, ticks=24) == ""
    assert counted.look(50.0, 0.0, ticks=1) == "five"


def test_look_is_put_off_4_ticks_while_more_frames_wait(counted: Counted) -> None:
    assert counted.look(50.0, 0.0, 9, more_wait=True, ticks=28) == ""
    assert counted.look(50.0, 0.0, more_wait=True, ticks=1) == "five"
