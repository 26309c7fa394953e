"""Alarms that stop the robot before a decision, until a teacher resumes."""

import can
import pytest

from hal.bus import CanBus
from hal.bus_state import ControllerState
from hal.control import Mode, RawControl, RawSide, SpeedControl, encode_brake
from hal.frame import Frame
from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from tests.hal.desk_bus import Ride
from tests.hal.helpers import CODEC, INFRARED_FRAMES, ROBOT, TICK_S, cycle, error_frame, send, ticks

BRAKE = RawControl(RawSide(0, brake=True), RawSide(0, brake=True))
OFF, RESTARTED = error_frame(0x040), error_frame(0x100)
FORWARD = Frame(0x01, bytes.fromhex("0002001E001E0001"))


def stopped(reason: GuardReason) -> GuardResult:
    return GuardResult(STANDSTILL, (reason,), latched=True)


# Another sender of CONTROL


@pytest.mark.parametrize("frame", [FORWARD, encode_brake(), Frame(0x01, b"")], ids=["drive", "stop", "junk"])
def test_foreign_control_stops_the_robot_in_the_same_tick(ride: Ride, frame: Frame) -> None:
    ride.desk.arrive(frame)
    ride.kurt2.sense(ride.now_s)
    assert ride.sent() == [BRAKE]  # before anybody has decided anything
    assert ride.tick() == stopped(GuardReason.FOREIGN_CONTROL)
    health = ride.kurt2.health
    assert (health.foreign_control, health.latched) == (1, GuardReason.FOREIGN_CONTROL)
    assert health.trouble != ""


def test_it_stops_again_after_a_resume_while_the_other_goes_on(ride: Ride) -> None:
    ride.desk.arrive(FORWARD, FORWARD)
    assert ride.tick() == stopped(GuardReason.FOREIGN_CONTROL)
    ride.kurt2.release()
    assert ride.kurt2.health.trouble == ""
    ride.desk.arrive(FORWARD)
    assert ride.tick() == stopped(GuardReason.FOREIGN_CONTROL)
    ride.kurt2.release()
    assert not ride.tick().latched
    assert ride.kurt2.health.foreign_control == 3


def test_frames_that_slip_past_the_filter_raise_no_alarm(ride: Ride) -> None:
    ride.desk.set_id_filter(frozenset({0x123}))
    ride.desk.arrive(Frame(0x123, bytes(8)))
    assert not ride.decide().latched
    assert (ride.kurt2.health.foreign_control, ride.kurt2.health.junk) == (0, 0)


def test_first_alarm_stays_the_reported_one(ride: Ride) -> None:
    ride.kurt2.emergency_stop(GuardReason.SERVICE_ENDS)
    ride.desk.arrive(FORWARD)
    assert ride.tick() == stopped(GuardReason.SERVICE_ENDS)
    assert (ride.kurt2.health.foreign_control, ride.kurt2.health.trouble) == (1, "")


# A bus that does not carry


def test_blocked_bus_gets_brakes_but_no_set_points(ride: Ride) -> None:
    ride.desk.carries = False
    assert not ride.tick().latched
    assert not ride.tick().latched
    assert ride.tick() == stopped(GuardReason.BUS_BLOCKED)
    ride.drive_for(0.1)
    health = ride.kurt2.health
    assert health.latched == GuardReason.BUS_BLOCKED
    assert health.send_failures == 0
    assert health.trouble.startswith("bus can0: ")
    ride.desk.carry()
    set_points = [SpeedControl(Mode.SPEED_CM, 30, 30)] * 2
    assert ride.sent() == set_points + [BRAKE] * 11


def test_a_bus_that_carries_again_stays_stopped_until_released(ride: Ride) -> None:
    ride.desk.carries = False
    ride.drive_for(0.05)
    ride.desk.carry()
    ride.desk.carries = True
    assert ride.drive_for(0.05) == stopped(GuardReason.BUS_BLOCKED)
    ride.kurt2.release()
    assert ride.kurt2.health.trouble == ""
    assert not ride.drive_for(0.05).latched


def test_early_release_blocks_again_after_two_set_points(ride: Ride) -> None:
    ride.desk.carries = False
    ride.drive_for(0.05)
    ride.kurt2.release()
    first, second, third = ride.tick(), ride.tick(), ride.tick()
    assert max(*first.wheel_speeds, *second.wheel_speeds) <= 0.05
    assert third == stopped(GuardReason.BUS_BLOCKED)


def test_silently_lost_frames_do_not_hinder_a_resume(ride: Ride) -> None:
    ride.desk.carries = False
    ride.drive_for(0.05)
    ride.desk.lose()
    ride.desk.carries = True
    assert ride.drive_for(0.05) == stopped(GuardReason.BUS_BLOCKED)  # not distinguishable from a late bus
    ride.kurt2.release()
    assert not ride.drive_for(0.05).latched


def test_own_frames_carried_after_a_resume_raise_no_alarm(ride: Ride) -> None:
    ride.desk.carries = False
    ride.drive_for(0.05)
    ride.kurt2.release()
    ride.tick()
    ride.desk.carry()
    ride.desk.carries = True
    assert not ride.drive_for(0.05).latched
    assert ride.kurt2.health.foreign_control == 0
    assert ride.openings == 1  # the kernel delivers frames of a closed socket as those of another program


def test_resume_after_another_stop_keeps_waiting_frames(ride: Ride) -> None:
    ride.kurt2.emergency_stop(GuardReason.SERVICE_ENDS)
    ride.desk.carries = False
    ride.drive_for(0.05)
    ride.kurt2.release()
    assert ride.tick() == stopped(GuardReason.BUS_BLOCKED)


def test_one_frame_late_is_no_alarm(ride: Ride) -> None:
    ride.desk.carries = False
    for _ in range(50):
        assert not ride.tick().latched
        ride.desk.carry()


# What the adapter says


def test_bus_off_stops_and_says_how_to_come_back(ride: Ride) -> None:
    ride.desk.arrive(OFF)
    ride.kurt2.sense(ride.now_s)
    assert ride.sent() == [BRAKE]
    assert ride.decide() == stopped(GuardReason.BUS_OFF)
    health = ride.kurt2.health
    assert (health.latched, health.controller, health.error_frames) == (GuardReason.BUS_OFF, ControllerState.OFF, 1)
    assert health.trouble == health.controller_trouble != ""


def test_resume_while_bus_is_off_stays_stopped(ride: Ride) -> None:
    ride.desk.arrive(OFF)
    ride.decide()
    ride.kurt2.release()
    assert ride.decide() == stopped(GuardReason.BUS_OFF)


@pytest.mark.parametrize("sign", [RESTARTED, *cycle()[:1]], ids=["restarted", "a frame"])
def test_bus_off_ends_by_traffic_and_its_stop_by_resume(ride: Ride, sign: Frame) -> None:
    ride.desk.arrive(OFF)
    ride.decide()
    ride.desk.arrive(sign)
    assert ride.decide() == stopped(GuardReason.BUS_OFF)
    assert (ride.kurt2.health.controller, ride.kurt2.health.trouble) == (ControllerState.ACTIVE, "")
    ride.kurt2.release()
    assert not ride.drive_for(0.05).latched


def test_frames_that_waited_from_before_do_not_hide_bus_off(ride: Ride) -> None:
    ride.desk.arrive(OFF, *ride.frames())
    ride.decide()
    assert ride.kurt2.health.controller is ControllerState.OFF


def test_off_and_back_between_two_ticks_is_a_stop_all_the_same(ride: Ride) -> None:
    ride.desk.arrive(OFF, RESTARTED, *ride.frames())
    assert ride.decide() == stopped(GuardReason.BUS_OFF)
    assert ride.kurt2.health.controller is ControllerState.ACTIVE


@pytest.mark.parametrize("status", [0x04, 0x08, 0x10, 0x20])
def test_warning_or_passive_adapter_drives_on_and_is_shown(ride: Ride, status: int) -> None:
    ride.desk.arrive(error_frame(0x204, status=status, sending=130, receiving=1))
    assert ride.drive_for(0.5) == GuardResult(WheelSpeeds(0.3, 0.3), (), latched=False)
    health = ride.kurt2.health
    assert health.trouble == health.controller_trouble != ""
    ride.desk.arrive(error_frame(0x204, status=0x40))
    ride.tick()
    assert ride.kurt2.health.trouble == ""


def test_a_flood_of_error_frames_is_counted_and_driven_through(ride: Ride) -> None:
    for _ in range(10):
        ride.desk.arrive(*[error_frame(0x288, sending=n % 96) for n in range(200)])
        assert not ride.tick().latched
    health = ride.kurt2.health
    assert (health.error_frames, health.junk, health.trouble) == (2000, 0, "")


def test_an_error_frame_is_no_reading(ride: Ride) -> None:
    before = ride.kurt2.sense(ride.now_s)
    frame = error_frame(CODEC.message("ENCODER").frame_id, status=0x10, sending=99, receiving=99)
    ride.desk.arrive(frame)
    ride.sleep(TICK_S)
    readings = ride.kurt2.sense(ride.now_s)
    assert readings.encoder_left_ticks == readings.encoder_right_ticks == 0
    assert readings.encoder_age_s == pytest.approx(before.encoder_age_s + TICK_S)


def test_a_lost_bus_is_told_before_other_troubles(ride: Ride) -> None:
    ride.desk.shutdown()
    assert ride.decide() == stopped(GuardReason.BUS_LOST)
    health = ride.kurt2.health
    assert health.trouble == health.bus_trouble != ""


def test_resume_while_bus_is_lost_stays_stopped(ride: Ride, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_: float | None) -> None:
        raise can.CanOperationError("the interface was down for a moment")

    ride.drive_for(0.5)
    monkeypatch.setattr(ride.desk, "recv", fail)  # sending works again
    assert ride.tick() == stopped(GuardReason.BUS_LOST)
    ride.kurt2.release()  # the readings are 10 ms old
    for _ in range(10):
        assert ride.tick() == stopped(GuardReason.BUS_LOST)
    ride.sleep(1.0)
    ride.tick()  # opens the bus again
    assert ride.tick() == stopped(GuardReason.BUS_LOST)
    ride.kurt2.release()
    assert not ride.tick().latched


# Between two ticks


def test_touch_within_one_tick_is_a_front_bumper_once(ride: Ride) -> None:
    bumperc = CODEC.message("BUMPERC")
    free = ride.frames()[:-1]
    ride.desk.arrive(*free, *(bumperc.pack(pressed, 0) for pressed in (0, 0b1, 0)))
    ride.sleep(TICK_S)
    assert ride.decide() == GuardResult(STANDSTILL, (GuardReason.FRONT_BUMPER,), latched=False)
    assert ride.tick().reasons == (GuardReason.SLEW_LIMIT,)


# Wheels


def test_wheels_that_do_not_follow_stop_the_robot(ride: Ride) -> None:
    encoder = CODEC.message("ENCODER")
    grants = []
    for _ in range(25):
        frames = [frame for frame in ride.frames() if frame.arbitration_id != encoder.frame_id]
        ride.desk.arrive(*frames, encoder.pack(ticks(0.3), 0))
        ride.sleep(TICK_S)
        grants.append(ride.decide())
    assert 19 <= [grant.latched for grant in grants].index(True) <= 21
    assert grants[-1] == stopped(GuardReason.WHEELS_DISOBEY)
    assert ride.kurt2.health.trouble.startswith("right wheels")


# Infra-red boards


def frozen_but(ride: Ride, *alive: str) -> list[can.Message]:
    """Return a cycle in which only the infra-red frames of these names change."""
    still = [CODEC.message(name).pack(333, 333, 333, 333) for name in INFRARED_FRAMES if name not in alive]
    repeated = {frame.arbitration_id for frame in still}
    return [*still, *(frame for frame in ride.frames() if frame.arbitration_id not in repeated)]


@pytest.mark.parametrize(("alive", "board"), [((), "ADC*"), (("BDC00_03",), "ADC*"), (("ADC08_11",), "BDC*")])
def test_board_frozen_for_a_second_stops_the_robot(ride: Ride, alive: tuple[str, ...], board: str) -> None:
    grants = []
    for _ in range(105):
        ride.desk.arrive(*frozen_but(ride, *alive))
        ride.sleep(TICK_S)
        grants.append(ride.decide())
    assert 100 <= [grant.latched for grant in grants].index(True) <= 102
    assert grants[-1] == stopped(GuardReason.INFRARED_FROZEN)
    assert board in ride.kurt2.health.trouble


def test_one_sensor_of_each_board_that_lives_is_enough(ride: Ride) -> None:
    for _ in range(300):
        ride.desk.arrive(*frozen_but(ride, "ADC08_11", "BDC04_07"))
        ride.sleep(TICK_S)
        assert not ride.decide().latched


def test_unused_channels_do_not_keep_a_board_alive(ride: Ride) -> None:
    message = CODEC.message("ADC08_11")
    for n in range(105):
        frames = [frame for frame in frozen_but(ride, "BDC00_03") if frame.arbitration_id != message.frame_id]
        ride.desk.arrive(*frames, message.pack(333, 333, n, n))  # 10 and 11 carry something else
        ride.sleep(TICK_S)
        grant = ride.decide()
    assert grant == stopped(GuardReason.INFRARED_FROZEN)


def test_still_board_at_standstill_allows_a_second_of_driving(ride: Ride) -> None:
    latched = []
    for wanted_m_s, seconds in ((0.0, 3.0), (0.3, 0.5), (0.0, 3.0), (0.3, 1.0)):
        for _ in range(round(seconds / TICK_S)):
            ride.desk.arrive(*frozen_but(ride))
            ride.sleep(TICK_S)
            latched.append(ride.decide(wanted_m_s, wanted_m_s).latched)
    assert 699 <= latched.index(True) <= 702  # a second in two parts


def test_pause_of_a_second_does_not_count_as_frozen(ride: Ride) -> None:
    for _ in range(10):
        ride.tick()
    ride.sleep(1.5)
    ride.desk.arrive(*ride.frames())
    assert GuardReason.INFRARED_FROZEN not in ride.decide().reasons
    assert ride.tick().reasons != (GuardReason.INFRARED_FROZEN,)


def test_resume_with_frozen_board_stops_at_once(ride: Ride) -> None:
    latched = []
    for _ in range(120):
        ride.desk.arrive(*frozen_but(ride))
        ride.sleep(TICK_S)
        latched.append(ride.decide().latched)
        if latched[-1]:
            ride.kurt2.release()
    first, second = [tick for tick, it in enumerate(latched) if it][:2]
    assert second - first <= 3
    ride.kurt2.release()
    ride.tick()
    ride.kurt2.release()
    assert not ride.drive_for(2.0).latched


def test_sensors_on_one_controller_make_one_board(ends: tuple[CanBus, CanBus]) -> None:
    sensors = tuple(sensor for sensor in ROBOT.infrared.sensors if sensor.channel.startswith("ADC"))
    infrared = ROBOT.infrared.model_copy(update={"sensors": sensors})
    robot = Kurt2(ROBOT.model_copy(update={"infrared": infrared}), ends[0])
    applied = STANDSTILL
    for tick in range(300):
        now_s = 10.0 + tick * TICK_S
        send(ends[1], cycle(200 + tick % 2, ticks(applied.left_m_s), ticks(applied.right_m_s)))
        robot.sense(now_s)
        applied = robot.drive(WheelSpeeds(0.3, 0.3), now_s, now_s).wheel_speeds
    assert applied == (0.3, 0.3)
    robot.close()
