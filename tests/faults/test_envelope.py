"""The observer: what it lets pass, and that it would see a guard that lets go."""

import struct

import pytest

from hal.control import Mode, SpeedControl, control_frame, encode_brake
from kurt2rt.faults.envelope import Envelope, told_by
from tests.faults.helpers import TABLE, tried, with_guard

BRAKE = bytes(encode_brake().data)


def set_point(left_cm_s: int, right_cm_s: int | None = None) -> bytes:
    right_cm_s = left_cm_s if right_cm_s is None else right_cm_s
    return struct.pack(">HhhH", 2, left_cm_s, right_cm_s, 1)


class Drive:
    """Frames handed to the bus one after the other, that arrive at once unless told otherwise."""

    def __init__(self) -> None:
        self.envelope = Envelope(TABLE.envelope)
        self.number = 0
        self.now_s = 0.0

    def put(
        self,
        payload: bytes,
        *,
        after_s: float = 0.01,
        age_s: float = 0.0,
        latched: bool = False,
        late_s: float | None = 0.0,
    ) -> "Drive":
        self.number += 1
        self.now_s += after_s
        self.envelope.put(self.number, self.now_s, payload, age_s, latched=latched)
        if late_s is not None:
            self.envelope.arrived(self.number, self.now_s + late_s, payload)
        return self

    def to(self, cm_s: int) -> "Drive":
        """As a good guard does it, one cm/s in a cycle."""
        for speed in range(cm_s + 1):
            self.put(set_point(speed))
        return self

    @property
    def violations(self) -> str:
        return "; ".join(self.envelope.violations)


def test_it_reads_what_the_robot_reads() -> None:
    told = told_by(bytes(control_frame(SpeedControl(Mode.SPEED_CM, -12, 34)).data))
    assert told is not None
    assert (told.left_m_s, told.right_m_s, told.brake) == (-0.12, 0.34, False)
    brake = told_by(BRAKE)
    assert brake is not None
    assert brake.brake
    assert brake.standing
    assert told_by(bytes(8)) is None
    assert told_by(b"\0\2") is None


def test_a_good_drive_passes() -> None:
    drive = Drive().to(60).put(set_point(0)).to(30).put(BRAKE, latched=True).put(set_point(3)).put(set_point(0))
    drive.put(set_point(-1)).put(set_point(-2), after_s=0.1)
    assert not drive.violations
    assert drive.envelope.frames > 90


@pytest.mark.parametrize(
    ("drive", "said"),
    [
        (Drive().to(60).put(set_point(61)), "0.61 m/s"),
        (Drive().to(10).put(set_point(13)), "left from 0.10 to 0.13"),
        (Drive().to(10).put(set_point(10, 13)), "right from 0.10 to 0.13"),
        (Drive().put(set_point(0)).put(set_point(5), after_s=0.5), "left from 0.00 to 0.05"),
        (Drive().put(BRAKE).put(set_point(5)), "left from 0.00 to 0.05"),
        (Drive().to(30).put(set_point(25)), "left from 0.30 to 0.25"),
        (Drive().to(1).put(set_point(-1)), "without a rest"),
        (Drive().to(10).put(set_point(10), age_s=0.021), "a command 21.0 ms old"),
        (Drive().put(set_point(0), latched=True), "no brake"),
        (Drive().put(struct.pack(">HhhH", 1, 10, 10, 1)), "no set point and no brake"),
        (Drive().put(bytes(7)), "no set point and no brake"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_it_sees_what_is_beyond_the_limits(drive: Drive, said: str) -> None:
    assert said in drive.violations


def test_it_judges_what_arrives_even_when_frames_are_lost() -> None:
    drive = Drive().put(set_point(0)).put(set_point(1), late_s=None).put(set_point(2), late_s=None).put(set_point(3))
    assert not drive.violations
    drive = Drive().put(set_point(0)).put(set_point(1), late_s=None).put(set_point(2), late_s=None)
    drive.envelope.arrived(3, drive.now_s, set_point(9))
    assert "left from 0.00 to 0.09" in drive.violations


@pytest.mark.parametrize(("cm_s", "allowed"), [(6, True), (8, False)])
def test_the_longest_step_after_a_brake_may_be_among_frames_that_were_lost(cm_s: int, allowed: bool) -> None:
    drive = Drive().put(BRAKE, latched=True).put(set_point(3), late_s=None).put(set_point(4), late_s=None)
    assert drive.violations == ""
    drive.put(set_point(cm_s))
    heard = [each for each in drive.envelope.violations if "30 ms" in each or "40 ms" in each]
    assert (heard == []) is allowed


def test_the_first_step_after_a_brake_may_be_the_longest_however_soon_it_comes() -> None:
    drive = Drive().put(BRAKE, latched=True).put(set_point(3), after_s=0.002)
    assert drive.violations == ""


def test_a_stop_may_be_among_frames_that_were_lost_on_the_way() -> None:
    slows = Drive().put(set_point(5)).put(set_point(0), late_s=None).put(set_point(1))
    turns = Drive().put(set_point(1)).put(set_point(0), late_s=None).put(set_point(-1))
    assert not slows.violations
    assert not turns.violations


def test_what_follows_one_another_at_the_robot_must_rest_in_between() -> None:
    assert "turns round" in Drive().put(set_point(1)).put(set_point(-1)).violations


def test_off_a_bumper_a_wheel_may_turn_round_at_once_but_not_jump() -> None:
    drive = Drive().put(set_point(1)).put(set_point(2)).put(set_point(3))
    drive.envelope.off_a_bumper = True
    assert not drive.put(set_point(-1)).violations
    assert "left from 0.00 to 0.09" in drive.put(set_point(9)).violations


def test_frames_of_a_driver_whose_clock_jumps_are_judged_one_by_one() -> None:
    drive = Drive()
    drive.envelope.clock_is_wrong = True
    drive.put(set_point(1)).put(set_point(4), after_s=0.003)
    assert not drive.violations
    assert "left from 0.04 to 0.09" in drive.put(set_point(9), after_s=0.003).violations


def test_it_counts_what_arrives_too_late_and_what_is_garbled() -> None:
    drive = Drive().put(set_point(1), late_s=0.019).put(set_point(2), late_s=0.03).put(set_point(0), late_s=0.5)
    assert drive.envelope.old_frames == 1
    drive.envelope.arrived(1, 1.0, b"\xff" * 8)
    assert drive.envelope.unintelligible == 1
    assert not drive.violations


# A guard that lets go is seen in the drills themselves.


def test_a_guard_without_a_speed_limit_is_seen() -> None:
    trial = tried("tick", "wrong", robot=with_guard(maximum_speed_m_s=0.9))
    assert not trial.verdict.passed
    assert "at 2.215 s: 0.62 m/s" in trial.outcome.problems


def test_a_guard_that_slews_too_fast_is_seen() -> None:
    trial = tried("tick", "wrong", robot=with_guard(acceleration_m_s2=4.0))
    assert not trial.verdict.passed
    assert "allowed are 0.025 m/s" in " ".join(trial.outcome.problems)


def test_a_guard_that_takes_old_commands_is_seen() -> None:
    trial = tried("tick", "slow", robot=with_guard(command_age_s=0.05))
    assert not trial.verdict.passed
    assert "a command 30.0 ms old" in " ".join(trial.outcome.problems)


def test_a_guard_that_trusts_old_readings_is_seen() -> None:
    trial = tried("sensor_board_1", "off", robot=with_guard(stale_infrared_s=0.2))
    assert any("must stand within 60 ms" in each for each in trial.verdict.complaints)


def test_a_watchdog_that_sleeps_is_seen() -> None:
    trial = tried("tick", "stuck", robot=with_guard(ticks_ceased_s=0.5))
    assert any("must stand within 120 ms" in each for each in trial.verdict.complaints)


def test_wheels_that_nobody_watches_are_seen() -> None:
    trial = tried("left_motor", "off", robot=with_guard(wheel_error_s=10.0))
    assert any("must stand because of wheels disobey, stood because of" in each for each in trial.verdict.complaints)
