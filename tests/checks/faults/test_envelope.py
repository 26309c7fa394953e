"""The observer: what it lets pass, and that it would see a guard that lets go."""

import struct

import pytest

from hal.control import Mode, SpeedControl, control_frame, encode_brake
from kurt2rt.checks.faults.complaint import Complaint, ComplaintCode, complaint
from kurt2rt.checks.faults.envelope import Envelope, decode_command
from kurt2rt.checks.faults.suite import FaultTrial
from tests.checks.faults.helpers import TABLE, tried, with_guard

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

    def on_sent(
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
        self.envelope.on_sent(self.number, self.now_s, payload, age_s, latched=latched)
        if late_s is not None:
            self.envelope.on_arrived(self.number, self.now_s + late_s, payload)
        return self

    def to(self, cm_s: int) -> "Drive":
        """Speed up to `cm_s` as a good guard does, one cm/s in a cycle."""
        for speed in range(cm_s + 1):
            self.on_sent(set_point(speed))
        return self

    @property
    def violations(self) -> list[Complaint]:
        return self.envelope.violations

    @property
    def jumps_m_s(self) -> set[tuple[object, object, object]]:
        """Side, speed before and speed after of each jump."""
        jumps = [each.values for each in self.violations if each.code is ComplaintCode.JUMPED]
        return {(each["side"], each["from_m_s"], each["to_m_s"]) for each in jumps}


def test_it_reads_what_the_robot_reads() -> None:
    told = decode_command(bytes(control_frame(SpeedControl(Mode.SPEED_CM, -12, 34)).data))
    assert told is not None
    assert (told.left_m_s, told.right_m_s, told.brake) == (-0.12, 0.34, False)
    brake = decode_command(BRAKE)
    assert brake is not None
    assert brake.brake
    assert brake.standing
    assert decode_command(bytes(8)) is None
    assert decode_command(b"\0\2") is None


def test_a_good_drive_passes() -> None:
    drive = (
        Drive()
        .to(60)
        .on_sent(set_point(0))
        .to(30)
        .on_sent(BRAKE, latched=True)
        .on_sent(set_point(3))
        .on_sent(set_point(0))
    )
    drive.on_sent(set_point(-1)).on_sent(set_point(-2), after_s=0.1)
    assert not drive.violations
    assert drive.envelope.frames > 90


@pytest.mark.parametrize(
    ("drive", "code", "value"),
    [
        (Drive().to(60).on_sent(set_point(61)), ComplaintCode.TOO_FAST, 0.61),
        (Drive().to(10).on_sent(set_point(13)), ComplaintCode.JUMPED, "left"),
        (Drive().to(10).on_sent(set_point(10, 13)), ComplaintCode.JUMPED, "right"),
        (Drive().on_sent(set_point(0)).on_sent(set_point(5), after_s=0.5), ComplaintCode.JUMPED, 0.05),
        (Drive().on_sent(BRAKE).on_sent(set_point(5)), ComplaintCode.JUMPED, 0.05),
        (Drive().to(30).on_sent(set_point(25)), ComplaintCode.JUMPED, 0.25),
        (Drive().to(1).on_sent(set_point(-1)), ComplaintCode.TURNED_ROUND, -0.01),
        (Drive().to(10).on_sent(set_point(10), age_s=0.021), ComplaintCode.OLD_COMMAND, 21.0),
        (Drive().on_sent(struct.pack(">HhhH", 1, 10, 10, 1)), ComplaintCode.UNKNOWN_FRAME, "00 01 00 0a 00 0a 00 01"),
        (Drive().on_sent(bytes(7)), ComplaintCode.UNKNOWN_FRAME, "00 00 00 00 00 00 00"),
    ],
)
def test_drive_beyond_the_limits_is_a_complaint(drive: Drive, code: ComplaintCode, value: float | str) -> None:
    assert any(each.code is code and value in each.values.values() for each in drive.violations)


def test_set_point_of_a_latched_driver_is_a_complaint() -> None:
    assert Drive().on_sent(set_point(0), latched=True).violations == [complaint(ComplaintCode.NO_BRAKE, 0.01)]


def test_it_judges_what_arrives_even_when_frames_are_lost() -> None:
    drive = (
        Drive()
        .on_sent(set_point(0))
        .on_sent(set_point(1), late_s=None)
        .on_sent(set_point(2), late_s=None)
        .on_sent(set_point(3))
    )
    assert not drive.violations
    drive = Drive().on_sent(set_point(0)).on_sent(set_point(1), late_s=None).on_sent(set_point(2), late_s=None)
    drive.envelope.on_arrived(3, drive.now_s, set_point(9))
    assert ("left", 0.0, 0.09) in drive.jumps_m_s


@pytest.mark.parametrize(("cm_s", "allowed"), [(6, True), (8, False)])
def test_envelope_allows_the_longest_step_among_lost_frames(cm_s: int, allowed: bool) -> None:
    drive = Drive().on_sent(BRAKE, latched=True).on_sent(set_point(3), late_s=None).on_sent(set_point(4), late_s=None)
    assert drive.violations == []
    drive.on_sent(set_point(cm_s))
    heard = [each for each in drive.violations if round(float(each.values["within_ms"])) in (30, 40)]
    assert (heard == []) is allowed


def test_envelope_allows_an_early_longest_step_after_a_brake() -> None:
    drive = Drive().on_sent(BRAKE, latched=True).on_sent(set_point(3), after_s=0.002)
    assert drive.violations == []


def test_a_stop_may_be_among_frames_that_were_lost_on_the_way() -> None:
    slows = Drive().on_sent(set_point(5)).on_sent(set_point(0), late_s=None).on_sent(set_point(1))
    turns = Drive().on_sent(set_point(1)).on_sent(set_point(0), late_s=None).on_sent(set_point(-1))
    assert not slows.violations
    assert not turns.violations


def test_envelope_arrival_reversal_needs_a_rest() -> None:
    codes = [each.code for each in Drive().on_sent(set_point(1)).on_sent(set_point(-1)).violations]
    assert ComplaintCode.TURNED_ROUND in codes


def test_envelope_pressed_bumper_allows_reversal_but_no_jump() -> None:
    drive = Drive().on_sent(set_point(1)).on_sent(set_point(2)).on_sent(set_point(3))
    drive.envelope.bumper_pressed = True
    assert not drive.on_sent(set_point(-1)).violations
    assert ("left", 0.0, 0.09) in drive.on_sent(set_point(9)).jumps_m_s


def test_envelope_faulty_clock_frames_are_judged_one_by_one() -> None:
    drive = Drive()
    drive.envelope.clock_is_faulty = True
    drive.on_sent(set_point(1)).on_sent(set_point(4), after_s=0.003)
    assert not drive.violations
    assert ("left", 0.04, 0.09) in drive.on_sent(set_point(9), after_s=0.003).jumps_m_s


def test_it_counts_what_arrives_too_late_and_what_is_garbled() -> None:
    drive = (
        Drive().on_sent(set_point(1), late_s=0.019).on_sent(set_point(2), late_s=0.03).on_sent(set_point(0), late_s=0.5)
    )
    assert drive.envelope.old_frames == 1
    drive.envelope.on_arrived(1, 1.0, b"\xff" * 8)
    assert drive.envelope.unintelligible == 1
    assert not drive.violations


# A guard that lets go is seen in the drills themselves.


def test_a_guard_without_a_speed_limit_is_seen() -> None:
    trial = tried("tick", "wrong", robot=with_guard(maximum_speed_m_s=0.9))
    assert not trial.verdict.passed
    (first, *_) = [each for each in trial.outcome.problems if each.code is ComplaintCode.TOO_FAST]
    assert first.at_s == pytest.approx(2.215, abs=5e-4)
    assert first.values["speed_m_s"] == 0.62


def test_a_guard_that_slews_too_fast_is_seen() -> None:
    trial = tried("tick", "wrong", robot=with_guard(acceleration_m_s2=4.0))
    assert not trial.verdict.passed
    jumps = [each.values for each in trial.outcome.problems if each.code is ComplaintCode.JUMPED]
    assert any(each["allowed_m_s"] == pytest.approx(0.025, abs=5e-4) for each in jumps)


def test_a_guard_that_takes_old_commands_is_seen() -> None:
    trial = tried("tick", "slow", robot=with_guard(command_age_s=0.05))
    assert not trial.verdict.passed
    ages = [each.values["age_ms"] for each in trial.outcome.problems if each.code is ComplaintCode.OLD_COMMAND]
    assert any(each == pytest.approx(30.0, abs=0.05) for each in ages)


def late_ms(trial: FaultTrial) -> list[object]:
    """Return the limits that standstills came too late for."""
    return [each.values["must_ms"] for each in trial.verdict.complaints if each.code is ComplaintCode.STOOD_LATE]


def test_a_guard_that_trusts_old_readings_is_seen() -> None:
    trial = tried("sensor_board_1", "off", robot=with_guard(stale_infrared_s=0.2))
    assert late_ms(trial) == [60.0]


def test_a_watchdog_that_sleeps_is_seen() -> None:
    trial = tried("tick", "stuck", robot=with_guard(ticks_ceased_s=0.5))
    assert late_ms(trial) == [120.0]


def test_guard_without_wheel_watch_is_seen() -> None:
    trial = tried("left_motor", "off", robot=with_guard(wheel_error_s=10.0))
    codes = {each.code: each.values for each in trial.verdict.complaints}
    assert codes[ComplaintCode.STOOD_FOR_ANOTHER_CAUSE]["must"] == "wheels disobey"
