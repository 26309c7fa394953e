"""Guard: only safe set points reach the wheels, for any decision."""

import math
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.bus import CanBus
from hal.control import Control, Mode, RawControl, RawSide, SpeedControl
from hal.guard_reason import GuardReason
from hal.kurt2_settings import Kurt2Settings, SpeedMode
from hal.robot import STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from hal.robot_settings import BumperEnd
from tests.hal.helpers import ROBOT, TICK_S, bus_pair, controls, cycle, fresh, guard_on, robot_with, send

Ends = tuple[CanBus, CanBus]
BRAKE = RawControl(RawSide(0, brake=True), RawSide(0, brake=True))
FRONT, REAR = 0b000_010, 0b010_000
LIMITS = ROBOT.guard


class Driver:
    """Driver of a guard tick by tick, with the receiving controller."""

    def __init__(self, ends: Ends, robot: Kurt2Settings = ROBOT) -> None:
        self.guard = guard_on(robot, ends[0])
        self._far_end = ends[1]
        self.now_s = 50.0

    def drive(self, left_m_s: float, right_m_s: float, bumpers: int = 0) -> GuardResult:
        self.now_s += TICK_S
        return self.tell(WheelSpeeds(left_m_s, right_m_s), fresh(self.now_s, bumpers))

    def tell(self, wanted: WheelSpeeds, readings: SensorReadings, decided_ago_s: float = 0.0) -> GuardResult:
        return self.guard.drive(wanted, readings, self.now_s - decided_ago_s, self.now_s)

    def drive_for(self, seconds: float, left_m_s: float, right_m_s: float) -> GuardResult:
        for _ in range(round(seconds / TICK_S)):
            grant = self.drive(left_m_s, right_m_s)
        return grant

    def sent(self) -> list[Control]:
        return controls(self._far_end)

    def last_sent(self) -> Control:
        return self.sent()[-1]


@pytest.fixture
def driver(ends: Ends) -> Driver:
    return Driver(ends)


def test_a_safe_wish_is_granted_and_sent_once_a_tick(driver: Driver) -> None:
    grant = driver.drive_for(1.0, 0.3, -0.2)
    assert grant == GuardResult(WheelSpeeds(0.3, -0.2), (), latched=False)
    sent = driver.sent()
    assert len(sent) == 100
    assert sent[-1] == SpeedControl(Mode.SPEED_CM, 30, -20)


def test_the_robot_speeds_up_no_faster_than_allowed(driver: Driver) -> None:
    driver.drive(0.0, 0.0)
    speeds = [driver.drive(0.3, 0.3).wheel_speeds.left_m_s for _ in range(20)]
    assert speeds[:4] == [0.01, 0.03, 0.04, 0.06]
    assert speeds[-1] == 0.3
    driver.sent()
    assert GuardReason.SLEW_LIMIT in driver.drive(0.6, 0.6).reasons


def test_slowing_down_has_its_own_limit_and_a_stop_has_none(driver: Driver) -> None:
    driver.drive_for(1.0, 0.5, 0.5)
    assert driver.drive(0.1, 0.1) == GuardResult(WheelSpeeds(0.47, 0.47), (GuardReason.SLEW_LIMIT,), latched=False)
    assert driver.drive(0.0, 0.2) == GuardResult(WheelSpeeds(0.0, 0.44), (GuardReason.SLEW_LIMIT,), latched=False)
    assert driver.drive(0.0, 0.0) == GuardResult(STANDSTILL, (), latched=False)


def test_turning_back_passes_through_zero(driver: Driver) -> None:
    driver.drive_for(0.1, 0.05, -0.05)
    speeds = [driver.drive(-0.05, 0.05).wheel_speeds for _ in range(6)]
    assert speeds[:4] == [(0.02, -0.02), (0.0, 0.0), (-0.01, 0.01), (-0.03, 0.03)]
    assert speeds[-1] == (-0.05, 0.05)


def test_a_late_tick_does_not_turn_into_a_jump(driver: Driver) -> None:
    driver.drive(0.0, 0.0)
    driver.now_s += 10.0
    assert driver.drive(0.6, 0.6).wheel_speeds == (0.03, 0.03)


def test_the_curve_is_kept_when_the_speed_is_not(driver: Driver) -> None:
    grant = driver.drive_for(1.0, 1.2, 0.6)
    assert grant == GuardResult(WheelSpeeds(0.6, 0.3), (GuardReason.SPEED_LIMIT,), latched=False)
    assert driver.drive_for(1.0, -0.8, -1.2).wheel_speeds == (-0.4, -0.6)


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf])
def test_nan_or_infinite_speed_stands(driver: Driver, odd: float) -> None:
    driver.drive_for(1.0, 0.3, 0.3)
    for wanted in ((odd, 0.3), (0.3, odd)):
        assert driver.drive(*wanted) == GuardResult(STANDSTILL, (GuardReason.NOT_A_NUMBER,), latched=False)
        assert driver.last_sent() == SpeedControl(Mode.SPEED_CM, 0, 0)
    assert driver.drive(0.3, 0.3).wheel_speeds == (0.01, 0.01)


@pytest.mark.parametrize(
    ("ages_s", "reason"),
    [
        ((LIMITS.stale_infrared_s + 1e-6, 0.0, 0.0), GuardReason.INFRARED_STALE),
        ((math.inf, 0.0, 0.0), GuardReason.INFRARED_STALE),
        ((math.nan, 0.0, 0.0), GuardReason.INFRARED_STALE),
        ((0.0, LIMITS.stale_encoder_s + 1e-6, 0.0), GuardReason.ENCODER_STALE),
        ((0.0, math.inf, 0.0), GuardReason.ENCODER_STALE),
        ((0.0, math.nan, 0.0), GuardReason.ENCODER_STALE),
        ((0.0, 0.0, LIMITS.stale_bumper_s + 1e-6), GuardReason.BUMPER_STALE),
        ((0.0, 0.0, math.inf), GuardReason.BUMPER_STALE),
        ((0.0, 0.0, math.nan), GuardReason.BUMPER_STALE),
    ],
)
def test_a_robot_without_feeling_stands(
    driver: Driver, ages_s: tuple[float, float, float], reason: GuardReason
) -> None:
    driver.drive_for(1.0, 0.3, 0.3)
    driver.now_s += TICK_S
    grant = driver.tell(WheelSpeeds(0.3, 0.3), fresh(driver.now_s, 0, *ages_s))
    assert grant == GuardResult(STANDSTILL, (reason,), latched=False)
    assert driver.last_sent() == SpeedControl(Mode.SPEED_CM, 0, 0)


def test_ages_within_the_limits_are_good_enough(driver: Driver) -> None:
    readings = fresh(driver.now_s, 0, LIMITS.stale_infrared_s, LIMITS.stale_encoder_s, LIMITS.stale_bumper_s)
    assert driver.tell(WheelSpeeds(0.01, 0.01), readings, decided_ago_s=0.0).wheel_speeds == (0.01, 0.01)


def test_a_robot_without_bumpers_does_not_wait_for_them(ends: Ends) -> None:
    driver = Driver(ends, ROBOT.model_copy(update={"bumpers": ()}))
    grant = driver.tell(WheelSpeeds(0.01, 0.01), fresh(driver.now_s, bumper_age_s=math.inf))
    assert grant == GuardResult(WheelSpeeds(0.01, 0.01), (), latched=False)


def test_old_readings_are_as_stale_as_old_frames(driver: Driver) -> None:
    readings = fresh(driver.now_s)
    driver.now_s += LIMITS.stale_infrared_s + 1e-6
    assert driver.tell(WheelSpeeds(0.3, 0.3), readings).reasons == (GuardReason.INFRARED_STALE,)


def test_the_limits_themselves_are_allowed(driver: Driver) -> None:
    driver.now_s = LIMITS.command_age_s
    assert driver.tell(WheelSpeeds(0.01, 0.01), fresh(driver.now_s), decided_ago_s=LIMITS.command_age_s).reasons == ()
    fastest_m_s = LIMITS.maximum_speed_m_s
    assert driver.drive_for(1.0, fastest_m_s, -fastest_m_s) == GuardResult(WheelSpeeds(0.6, -0.6), (), latched=False)


def test_an_old_command_stands(driver: Driver) -> None:
    wanted = WheelSpeeds(0.01, 0.01)
    assert driver.tell(wanted, fresh(driver.now_s), LIMITS.command_age_s - 1e-6).reasons == ()
    grant = driver.tell(wanted, fresh(driver.now_s), LIMITS.command_age_s + 1e-6)
    assert grant == GuardResult(STANDSTILL, (GuardReason.COMMAND_TOO_OLD,), latched=False)


def test_a_clock_that_runs_backwards_stands_for_that_tick(driver: Driver) -> None:
    driver.drive_for(1.0, 0.3, 0.3)
    driver.now_s -= 0.5
    backwards = driver.tell(WheelSpeeds(0.3, 0.3), fresh(driver.now_s))
    assert backwards == GuardResult(STANDSTILL, (GuardReason.CLOCK_RAN_BACKWARDS,), latched=False)
    assert driver.drive(0.3, 0.3).wheel_speeds == (0.01, 0.01)


def test_readings_or_commands_from_the_future_stand(driver: Driver) -> None:
    wanted = WheelSpeeds(0.3, 0.3)
    assert driver.tell(wanted, fresh(driver.now_s + 1.0)).reasons == (GuardReason.CLOCK_RAN_BACKWARDS,)
    assert driver.tell(wanted, fresh(driver.now_s), decided_ago_s=-1.0).reasons == (GuardReason.CLOCK_RAN_BACKWARDS,)


@pytest.mark.parametrize("now_s", [math.nan, math.inf, -math.inf])
def test_a_time_that_is_none_stands_and_is_forgotten(driver: Driver, now_s: float) -> None:
    driver.drive_for(1.0, 0.3, 0.3)
    grant = driver.guard.drive(WheelSpeeds(0.3, 0.3), fresh(driver.now_s), driver.now_s, now_s)
    assert grant.wheel_speeds == STANDSTILL
    assert driver.drive(0.3, 0.3).wheel_speeds == (0.01, 0.01)


def test_a_front_bumper_lets_the_robot_back_off_only(driver: Driver) -> None:
    driver.drive_for(1.0, 0.3, 0.3)
    assert driver.drive(0.3, 0.3, FRONT) == GuardResult(STANDSTILL, (GuardReason.FRONT_BUMPER,), latched=False)
    assert driver.drive(-0.2, 0.2, FRONT).wheel_speeds == (-0.01, 0.0)
    grant = driver.drive(-0.2, -0.2, FRONT)
    assert grant == GuardResult(WheelSpeeds(-0.03, -0.01), (GuardReason.SLEW_LIMIT,), latched=False)


def test_a_rear_bumper_lets_the_robot_drive_on_only(driver: Driver) -> None:
    driver.drive_for(1.0, -0.3, -0.3)
    assert driver.drive(-0.3, -0.3, REAR) == GuardResult(STANDSTILL, (GuardReason.REAR_BUMPER,), latched=False)
    assert driver.drive(0.2, -0.2, REAR).wheel_speeds == (0.01, 0.0)
    assert driver.drive(0.2, 0.2, REAR).reasons == (GuardReason.SLEW_LIMIT,)


@pytest.mark.parametrize(
    ("bumper", "reason", "barred"), [(FRONT, GuardReason.FRONT_BUMPER, 1), (REAR, GuardReason.REAR_BUMPER, -1)]
)
def test_a_bumper_is_a_reason_only_for_a_wheel_it_bars(driver: Driver, bumper: int, reason: str, barred: int) -> None:
    for left, right in ((0.2, -0.2), (-0.2, 0.2), (0.2, 0.0), (0.0, 0.2)):
        assert reason in driver.drive(barred * left, barred * right, bumper).reasons
    for left, right in ((-0.2, -0.2), (-0.2, 0.0), (0.0, -0.2), (0.0, 0.0)):
        assert reason not in driver.drive(barred * left, barred * right, bumper).reasons


@pytest.mark.parametrize("bit", range(8))
def test_each_bit_is_the_bumper_of_the_robots_table(driver: Driver, bit: int) -> None:
    ends = [bumper.end for bumper in ROBOT.bumpers]
    driver.drive_for(1.0, 0.1, -0.1)
    grant = driver.drive(0.1, -0.1, 1 << bit)
    assert grant.wheel_speeds.left_m_s == (0.0 if ends[bit : bit + 1] == [BumperEnd.FRONT] else 0.1)
    assert grant.wheel_speeds.right_m_s == (0.0 if ends[bit : bit + 1] == [BumperEnd.REAR] else -0.1)


def test_a_bumper_does_not_wait_for_the_braking_ramp(driver: Driver) -> None:
    driver.drive_for(1.0, 0.5, 0.5)
    assert driver.drive(-0.2, -0.2, FRONT).wheel_speeds == (-0.01, -0.01)
    driver.drive_for(1.0, -0.5, -0.5)
    assert driver.drive(0.2, 0.2, REAR).wheel_speeds == (0.01, 0.01)


def test_between_two_bumpers_the_robot_stands(driver: Driver) -> None:
    assert driver.drive(0.2, -0.2, FRONT | REAR).reasons == (GuardReason.FRONT_BUMPER, GuardReason.REAR_BUMPER)
    assert driver.last_sent() == SpeedControl(Mode.SPEED_CM, 0, 0)


def test_an_emergency_stop_brakes_at_once_and_lasts(driver: Driver) -> None:
    driver.drive_for(1.0, 0.3, 0.3)
    driver.sent()
    driver.guard.emergency_stop(GuardReason.SERVICE_ENDS)
    assert driver.sent() == [BRAKE]
    driver.guard.emergency_stop(GuardReason.PROGRAM_WAITS)
    for _ in range(3):
        assert driver.drive(0.3, 0.3) == GuardResult(STANDSTILL, (GuardReason.SERVICE_ENDS,), latched=True)
    assert driver.sent() == [BRAKE] * 4
    driver.guard.release()
    assert driver.guard.latched is None
    assert driver.sent() == []
    assert driver.drive(0.3, 0.3).wheel_speeds.left_m_s <= LIMITS.acceleration_m_s2 * 2 * TICK_S


def test_a_signal_in_the_middle_of_a_decision_has_the_last_word(driver: Driver) -> None:
    class Interrupted(SensorReadings):
        """A signal handler of the same thread runs while the guard checks the readings."""

        @property
        def bumpers(self) -> int:
            driver.guard.emergency_stop(GuardReason.PROGRAM_WAITS)
            return 0

    driver.drive_for(1.0, 0.3, 0.3)
    driver.sent()
    driver.now_s += TICK_S
    grant = driver.tell(WheelSpeeds(0.3, 0.3), Interrupted(*fresh(driver.now_s)))
    assert grant == GuardResult(STANDSTILL, (GuardReason.PROGRAM_WAITS,), latched=True)
    assert driver.last_sent() == BRAKE


def test_stop_and_release_between_ticks_start_from_zero(driver: Driver) -> None:
    driver.drive_for(1.0, 0.3, 0.3)
    driver.guard.emergency_stop(GuardReason.SERVICE_ENDS)
    driver.guard.release()
    assert driver.drive(0.3, 0.3).wheel_speeds == (0.01, 0.01)


def test_stop_by_signal_during_drive_starts_from_zero(driver: Driver) -> None:
    class Interrupted(float):
        """A signal handler of the same thread runs while the guard looks at this speed."""

        __hash__ = float.__hash__

        def __eq__(self, other: object) -> bool:
            driver.guard.emergency_stop(GuardReason.PROGRAM_WAITS)
            return float(self) == other

    driver.drive_for(1.0, 0.3, 0.3)
    driver.now_s += TICK_S
    assert driver.tell(WheelSpeeds(0.3, Interrupted(0.3)), fresh(driver.now_s)).latched
    driver.guard.release()
    assert driver.drive(0.3, 0.3).wheel_speeds == (0.01, 0.01)


def test_a_lost_bus_latches_and_is_counted_but_never_raised(driver: Driver, ends: Ends) -> None:
    robot_end, far_end = ends
    driver.drive_for(1.0, 0.3, 0.3)
    robot_end.shutdown()
    assert driver.drive(0.3, 0.3) == GuardResult(STANDSTILL, (GuardReason.BUS_LOST,), latched=True)
    driver.guard.emergency_stop(GuardReason.RUN_OVER)
    assert driver.guard.latched == GuardReason.BUS_LOST
    assert driver.guard.send_failures == 3
    assert "shut down" in driver.guard.bus_trouble
    robot_end.reopen()
    far_end.drain()
    assert driver.drive(0.3, 0.3).latched
    assert driver.sent() == [BRAKE]
    driver.guard.release()
    assert driver.drive(0.3, 0.3).wheel_speeds == (0.03, 0.03)


def test_a_full_queue_on_the_way_out_is_a_lost_bus(driver: Driver, ends: Ends) -> None:
    driver.drive(0.1, 0.1)
    send(ends[0], [cycle()[0]] * 4095)
    assert driver.drive(0.1, 0.1).reasons == (GuardReason.BUS_LOST,)
    assert driver.guard.send_failures == 2
    assert len(ends[1].drain()) == 4096


def test_one_bus_has_one_guard(ends: Ends) -> None:
    guard_on(ROBOT, ends[0])
    with pytest.raises(OSError, match="CONTROL"):
        guard_on(ROBOT, ends[0])


@pytest.mark.parametrize(
    ("mode", "sent", "granted_m_s"),
    [
        (SpeedMode.SPEED, SpeedControl(Mode.SPEED, 43, -43), 0.2967),
        (SpeedMode.RAW, RawControl(RawSide(682), RawSide(682, backward=True)), 0.302),
    ],
)
def test_other_modes_grant_what_their_frames_can_say(
    ends: Ends, mode: SpeedMode, sent: Control, granted_m_s: float
) -> None:
    robot = ROBOT.model_copy(update={"can": ROBOT.can.model_copy(update={"speed_mode": mode})})
    driver = Driver(ends, robot)
    grant = driver.drive_for(1.0, 0.3025, -0.3025)
    assert driver.last_sent() == sent
    assert grant.wheel_speeds == pytest.approx((granted_m_s, -granted_m_s))
    assert grant.reasons == ()


def test_limits_come_from_the_settings(ends: Ends) -> None:
    driver = Driver(ends, robot_with(maximum_speed_m_s=0.2, acceleration_m_s2=20.0))
    driver.drive(0.0, 0.0)
    driver.drive(0.5, 0.5)
    assert driver.drive(0.5, 0.5) == GuardResult(WheelSpeeds(0.2, 0.2), (GuardReason.SPEED_LIMIT,), latched=False)


ANY_FLOAT = st.floats(allow_nan=True, allow_infinity=True)
LIKELY = st.one_of(st.floats(-1.0, 1.0), ANY_FLOAT)


@st.composite
def histories(draw: st.DrawFn) -> Iterator[tuple[float, float, int, float]]:
    step = st.tuples(LIKELY, LIKELY, st.integers(0, 0xFF), st.one_of(st.floats(-0.02, 0.05), ANY_FLOAT))
    return iter(draw(st.lists(step, max_size=30)))


@given(histories())
def test_no_history_of_wishes_breaks_a_limit(history: Iterator[tuple[float, float, int, float]]) -> None:
    """Any requests, bumpers and time steps stay within speed, slew and bumper limits, and one frame a tick."""
    ends = bus_pair()
    guard = guard_on(ROBOT, ends[0])
    now_s, before = 0.0, STANDSTILL
    for left, right, bumpers, step_s in history:
        now_s += step_s if math.isfinite(step_s) and abs(step_s) < 1e6 else 0.0
        grant = guard.drive(WheelSpeeds(left, right), fresh(now_s, bumpers), now_s, now_s)
        (sent,) = controls(ends[1])
        assert isinstance(sent, SpeedControl)
        assert sent.wheel_speeds(ROBOT.motors) == grant.wheel_speeds
        assert sent.keep
        for was_m_s, is_m_s in zip(before, grant.wheel_speeds, strict=True):
            assert abs(is_m_s) <= LIMITS.maximum_speed_m_s
            assert was_m_s * is_m_s >= 0.0 or bumpers
            assert abs(is_m_s) - abs(was_m_s) <= LIMITS.acceleration_m_s2 * 2 * TICK_S + 0.0101
            assert not (is_m_s > 0.0 and bumpers & 0b000_111)
            assert not (is_m_s < 0.0 and bumpers & 0b111_000)
        before = grant.wheel_speeds
    for end in ends:
        end.shutdown()
