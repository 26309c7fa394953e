"""docs/the-robot.md holds the numbers of the shipped robot, and its example frames are those of the codec."""

import re
from pathlib import Path

import pytest

from hal.control import Mode, RawControl, RawSide, SpeedControl, control_frame, encode_brake
from tests.hal.helpers import CODEC, ROBOT, SENSORS

TEXT = (Path(__file__).parents[2] / "docs" / "the-robot.md").read_text(encoding="utf-8")
EXAMPLES = {
    "RAW, half drive forward": control_frame(RawControl(RawSide(512), RawSide(512))),
    "RAW, emergency stop": encode_brake(),
    "SPEED_CM, +50 cm/s left, -50 cm/s right": control_frame(SpeedControl(Mode.SPEED_CM, 50, -50)),
    "SPEED, 30 % both": control_frame(SpeedControl(Mode.SPEED, 30, 30)),
    "ENCODER (0x09), +521 left, -521 right": CODEC.message("ENCODER").pack(521, -521),
}


def test_printed_frames_equal_those_of_the_codec() -> None:
    printed = re.findall(r"^\| ([^|]+) \| `([0-9A-F ]{23})` \|$", TEXT, re.MULTILINE)
    assert {name: bytes.fromhex(data) for name, data in printed} == {name: each.data for name, each in EXAMPLES.items()}


def test_printed_sensors_equal_those_of_the_settings() -> None:
    rows = re.findall(r"^\| (s\d+) \| (\w+) \| ([-\d.]+), ([-\d.]+) \| (-?\d+) \|", TEXT, re.MULTILINE)
    printed = [(name, channel, *map(float, place)) for name, channel, *place in rows]
    assert printed == [(each.name, each.channel, each.x_m, each.y_m, each.heading_deg) for each in SENSORS]


def test_printed_counts_follow_the_infrared_law() -> None:
    distances, counts = (
        [float(cell) for cell in re.findall(rf"^\| {name} \| (.+) \|$", TEXT, re.MULTILINE)[0].split(" | ")]
        for name in (r"d \[m\]", "counts here")
    )
    assert [round(ROBOT.infrared.counts_at(distance_m)) for distance_m in distances] == counts


@pytest.mark.parametrize("name", ["INFO_1", "ADC12_15", "ENCODER", "BUMPERC", "DEADRECK", "GETSPEED", "TILT_COMP"])
def test_printed_identifier_equals_that_of_the_database(name: str) -> None:
    (identifier,) = re.findall(rf"^\| (0x\w+) \| {name} \|", TEXT, re.MULTILINE)
    assert CODEC.message(name).frame_id == int(identifier, 16)
