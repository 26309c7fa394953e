"""The observer: what it lets pass, and that it would see a guard that lets go."""

import struct
from pathlib import Path

import pytest

from hal.control import Mode, SpeedControl, control_frame, encode_brake
from tests.stories.drill import drilled
from tests.stories.envelope import Envelope
from tests.stories.rig import ROBOT
from tests.stories.table import TABLE, Kind, Target
from tests.stories.wire import KURT2, decode_control

RANGE_FRAME = 5
BRAKE = bytes(encode_brake().data)


def set_point(left_cm_s: int, right_cm_s: int | None = None) -> bytes:
    right_cm_s = left_cm_s if right_cm_s is None else right_cm_s
    return struct.pack(">HhhH", 2, left_cm_s, right_cm_s, 1)


class Drive:
    """Frames handed to the bus one after the other, that arrive at once unless told otherwise."""

    def __init__(self) -> None:
        self.envelope = Envelope(TABLE.envelopes["kurt2"])
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
        heard_s: float = 0.0,
        bumpers: int = 0,
    ) -> "Drive":
        self.envelope.bumpers = bumpers
        self.number += 1
        self.now_s += after_s
        self.envelope.on_heard(RANGE_FRAME, b"", self.now_s - heard_s)
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
    def violations(self) -> list[str]:
        return self.envelope.violations


def two_lost(first: bytes, *lost_cm_s: int) -> Drive:
    """Return a drive of which frames are lost on the way, after the first one."""
    drive = Drive().on_sent(first, latched=first == BRAKE)
    for cm_s in lost_cm_s:
        drive.on_sent(set_point(cm_s), late_s=None)
    assert not drive.violations
    return drive


def test_it_reads_what_the_robot_reads() -> None:
    told = decode_control(bytes(control_frame(SpeedControl(Mode.SPEED_CM, -12, 34)).data))
    assert told is not None
    assert (told.left_m_s, told.right_m_s, told.brake) == (-0.12, 0.34, False)
    brake = decode_control(BRAKE)
    assert brake is not None
    assert brake.brake
    assert brake.standing
    assert decode_control(bytes(8)) is None
    assert decode_control(b"\0\2") is None


@pytest.mark.parametrize(
    ("drive", "complaint"),
    [
        (Drive().to(60).on_sent(set_point(61)), "0.61 m/s"),
        (Drive().to(10).on_sent(set_point(13)), "left jumps from 0.10 to 0.13"),
        (Drive().to(10).on_sent(set_point(10, 13)), "right jumps from 0.10 to 0.13"),
        (Drive().on_sent(set_point(0)).on_sent(set_point(5), after_s=0.5), "left jumps from 0.00 to 0.05"),
        (Drive().on_sent(BRAKE).on_sent(set_point(5)), "left jumps from 0.00 to 0.05"),
        (Drive().to(30).on_sent(set_point(25)), "left jumps from 0.30 to 0.25"),
        (Drive().to(1).on_sent(set_point(-1)), "left turns round from 0.01 to -0.01"),
        (Drive().to(10).on_sent(set_point(10), age_s=0.021), "a command 21.0 ms old"),
        (Drive().on_sent(struct.pack(">HhhH", 1, 10, 10, 1)), "no brake: 00 01 00 0a 00 0a 00 01"),
        (Drive().to(10).on_sent(set_point(10), heard_s=0.081), "sensors were silent for 81 ms"),
        (Drive().to(10).on_sent(set_point(10), bumpers=0b000100), "pushes on towards the bumpers 000100"),
        (Drive().on_sent(set_point(0)).on_sent(set_point(0, -1), bumpers=0b001000), "towards the bumpers 001000"),
        (Drive().on_sent(bytes(7)), "no brake: 00 00 00 00 00 00 00"),
        (Drive().on_sent(set_point(0), latched=True), "at 0.010 s: no brake though"),
        (two_lost(set_point(0), 1, 2).on_sent(set_point(9)), "left jumps from 0.00 to 0.09"),
        (two_lost(BRAKE, 3, 4).on_sent(set_point(8)), "in 40 ms, allowed are"),
    ],
)
def test_drive_beyond_the_limits_is_a_complaint(drive: Drive, complaint: str) -> None:
    assert any(complaint in each for each in drive.violations)


def test_a_frame_that_arrives_twice_is_a_complaint() -> None:
    drive = Drive().on_sent(set_point(0))
    drive.envelope.on_arrived(1, drive.now_s, set_point(0))
    assert "arrives twice" in drive.violations[0]


@pytest.mark.parametrize("answers", [True, False])
def test_a_touch_that_the_driver_does_not_read_is_a_complaint(answers: bool) -> None:
    drive = Drive().to(2)
    drive.envelope.on_heard(KURT2.bumpers_id or 0, bytes((0b000100, 0)), drive.now_s)
    drive.on_sent(set_point(0 if answers else 2))
    for _ in range(10):
        drive.on_sent(set_point(2))
    assert any("pushed on since bumpers 000111" in each for each in drive.violations) is not answers


def test_envelope_pressed_bumper_allows_reversal_but_no_jump() -> None:
    drive = Drive().on_sent(set_point(1)).on_sent(set_point(2)).on_sent(set_point(3))
    assert not drive.on_sent(set_point(-1), bumpers=0b000001).violations
    violations = drive.on_sent(set_point(9), bumpers=0b000001).violations
    assert any("left jumps from 0.00 to 0.09" in each for each in violations)


def test_a_new_driver_begins_at_rest_whatever_the_last_one_sent() -> None:
    """The last one was killed, and the robot braked by itself."""
    for first, complaints in ((3, 0), (5, 2)):  # of both sides
        drive = Drive().to(30)
        drive.envelope.begin_program()
        assert len(drive.on_sent(set_point(first), after_s=0.5).violations) == complaints


def test_envelope_faulty_clock_frames_are_judged_one_by_one() -> None:
    drive = Drive()
    drive.envelope.clock_is_faulty = True
    drive.on_sent(set_point(1)).on_sent(set_point(4), after_s=0.003)
    assert not drive.violations
    assert "left jumps from 0.04 to 0.09" in drive.on_sent(set_point(9), after_s=0.003).violations[0]


def test_it_counts_what_arrives_too_late_and_what_is_garbled() -> None:
    drive = (
        Drive().on_sent(set_point(1), late_s=0.019).on_sent(set_point(2), late_s=0.03).on_sent(set_point(0), late_s=0.5)
    )
    assert drive.envelope.old_frames == 1
    drive.envelope.on_arrived(1, 1.0, b"\xff" * 8)
    assert drive.envelope.unintelligible == 1
    assert not drive.violations


@pytest.mark.parametrize(
    ("target", "kind", "limits", "complaint"),
    [
        ("tick", "wrong", {"maximum_speed_m_s": 0.9}, ": 0.61 m/s"),
        ("tick", "wrong", {"acceleration_m_s2": 4.0}, "in 10 ms, allowed are 0.025 m/s"),
        ("tick", "stuck", {"ticks_ceased_s": 0.5}, "must stand within 110 ms"),
        ("left_motor", "off", {"wheel_error_s": 10.0}, "must stay stopped because of wheels disobey"),
    ],
)
async def test_a_guard_that_lets_go_is_seen_in_the_drills(
    target: Target, kind: Kind, limits: dict[str, float], complaint: str, tmp_path: Path
) -> None:
    careless = ROBOT.model_copy(update={"guard": ROBOT.guard.model_copy(update=limits)})
    said = await drilled(target, kind, tmp_path, robot=careless)
    assert any(complaint in each for each in said), said
