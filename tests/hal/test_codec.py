"""Frames as the database says, and as cantools itself would make them."""

from pathlib import Path
from typing import Any

import pytest
from cantools.database import Message
from hypothesis import given
from hypothesis import strategies as st

from hal.codec import CodecError, InvalidFrameError, load_codec, load_database
from tests.hal.helpers import CODEC

DATABASE = load_database()
PLAIN = [message for message in DATABASE.messages if not message.is_multiplexed()]


def raw_values(message: Message) -> st.SearchStrategy[dict[str, int]]:
    fields = {}
    for signal in message.signals:
        half = 1 << (signal.length - 1)
        low, high = (-half, half - 1) if signal.is_signed else (0, 2 * half - 1)
        fields[signal.name] = st.integers(low, high)
    return st.fixed_dictionaries(fields)


@st.composite
def messages_with_values(draw: st.DrawFn) -> tuple[Message, dict[str, int]]:
    message = draw(st.sampled_from(PLAIN))
    return message, draw(raw_values(message))


@given(messages_with_values())
def test_any_values_pack_as_in_cantools_and_come_back(case: tuple[Message, dict[str, int]]) -> None:
    message, values = case
    codec = CODEC.message(message.name)
    frame = codec.pack(*(values[name] for name in codec.signals))
    assert frame.arbitration_id == message.frame_id == codec.frame_id
    assert not frame.is_extended_id
    assert frame.data == message.encode(values, scaling=False, strict=False)
    assert dict(zip(codec.signals, codec.unpack(frame.data), strict=True)) == values


@given(st.sampled_from(PLAIN), st.binary(min_size=8, max_size=8))
def test_any_payload_is_unpacked_as_cantools_unpacks_it(message: Message, payload: bytes) -> None:
    codec = CODEC.message(message.name)
    theirs: Any = message.decode(payload, decode_choices=False, scaling=False)
    assert dict(zip(codec.signals, codec.unpack(bytearray(payload)), strict=True)) == theirs


@given(st.sampled_from(PLAIN), st.binary(max_size=12))
def test_any_length_that_covers_the_fields_will_do(message: Message, payload: bytes) -> None:
    codec = CODEC.message(message.name)
    covered = max(8 * (signal.start // 8) + 7 - signal.start % 8 + signal.length for signal in message.signals)
    if 8 * len(payload) < covered:
        with pytest.raises(InvalidFrameError, match=f"^{message.name}"):
            codec.unpack(payload)
    else:
        assert codec.unpack(payload) == codec.unpack(payload[:8].ljust(8, b"\0"))


def test_short_encoder_frame_is_read_while_it_holds_both_sides() -> None:
    encoder = CODEC.message("ENCODER")
    assert encoder.unpack(bytes.fromhex("0209FDF7")) == (521, -521)
    with pytest.raises(InvalidFrameError, match="ENCODER: 3"):
        encoder.unpack(bytes.fromhex("0209FD"))


def test_encoder_example_of_the_reference() -> None:
    assert CODEC.message("ENCODER").pack(521, -521).data == bytes.fromhex("0209FDF700000000")


def test_pose_of_the_controller_has_24_bit_places() -> None:
    pose = CODEC.message("DEADRECK")
    assert pose.signals == ("X", "Y", "ORIENTATION")
    assert pose.pack(1, -2, -9000).data == bytes.fromhex("000001FFFFFEDCD8")
    assert pose.unpack(bytes.fromhex("7FFFFF800000FFFF")) == (8388607, -8388608, -1)


@pytest.mark.parametrize(
    ("name", "values", "complaint"),
    [
        ("ENCODER", (0, 32768), r"ENCODER\.RIGHT: 32768 .* -32768 to 32767"),
        ("ADC00_03", (0, 0, -1, 0), r"ADC00_03\.ADC02: -1 .* 0 to 65535"),
        ("DEADRECK", (0, 1 << 23, 0), r"DEADRECK\.Y: 8388608 .* -8388608 to 8388607"),
        ("ENCODER", (1,), "ENCODER: 1 values .* LEFT, RIGHT"),
        ("DEADRECK", (1,), "DEADRECK: 1 values .* X, Y, ORIENTATION"),
        ("ENCODER", (0.5, 1), "integers"),
    ],
)
def test_a_value_that_does_not_fit_is_named(name: str, values: tuple[int, ...], complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        CODEC.message(name).pack(*values)


def test_every_message_of_the_reference_is_there() -> None:
    ids = [*range(0x04, 0x0F), 0x10, *range(0x14, 0x19), 0x1E, 0x80]
    assert sorted(CODEC.by_id) == ids
    assert {message.frame_id for message in DATABASE.messages} == {0x01, *ids}
    assert all(message.length == 8 and not message.is_extended_frame for message in DATABASE.messages)
    assert CODEC.message("ADC12_15").signals == ("ADC12", "ADC13", "ADC14", "BOARD_TEMPERATURE")
    assert CODEC.message("BDC12_15").signals == ("BDC12", "BDC13", "BDC14", "BDC15")


def test_cantools_shows_physical_values() -> None:
    tilt: Any = DATABASE.decode_message("TILT_COMP", bytes.fromhex("8F5C800000000000"))
    assert tilt["TILT_LEFT_RIGHT"] == pytest.approx(1.0)
    assert tilt["TILT_FRONT_BACK"] == pytest.approx(0.0, abs=1e-9)
    gyro: Any = DATABASE.decode_message("GYRO_MC2", (4992511).to_bytes(4, "big") + (5000).to_bytes(4, "big"))
    assert gyro == {"ANGLE": pytest.approx(1.0), "VARIANCE": pytest.approx(0.5)}


def test_a_message_that_is_not_there_is_named() -> None:
    with pytest.raises(CodecError, match=r"kurt2\.dbc: .*CONTROL.*INFO_1"):
        CODEC.message("CONTROL")


def test_databases_that_cannot_be_used_are_refused(tmp_path: Path) -> None:
    with pytest.raises(CodecError, match=r"nowhere\.dbc"):
        load_codec("nowhere.dbc")
    torn = tmp_path / "torn.dbc"
    torn.write_text("BO_ what?", encoding="utf-8")
    with pytest.raises(CodecError, match=r"torn\.dbc"):
        load_codec(str(torn))
    little = tmp_path / "little.dbc"
    little.write_text(
        'VERSION ""\nNS_ :\nBS_:\nBU_: A\nBO_ 5 ODD: 8 A\n SG_ S : 0|16@1+ (1,0) [0|1] "" A\n', encoding="utf-8"
    )
    with pytest.raises(CodecError, match=r"ODD\.S"):
        load_codec(str(little))
