"""Frames as the database says, and as cantools itself would make them."""

from pathlib import Path
from typing import Any

import pytest
from cantools.database import Message
from hypothesis import given
from hypothesis import strategies as st

from config.errors import UserError
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
    with pytest.raises(CodecError, match=r"little\.dbc: ODD\.S: .*; mend"):
        load_codec(str(little))


HEAD = 'VERSION ""\nNS_ :\nBS_:\nBU_: A\n'


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("BO_ 5 NO_SIGNALS: 8 A\n", ["NO_SIGNALS"]),
        ("BO_ 5 NO_BYTES: 0 A\n", ["NO_BYTES"]),
        ('BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 A\n SG_ S : 7|8@0+ (1,0) [0|0] "" A\n', []),
        ('BO_ 2147483653 WIDE: 8 A\n SG_ S : 7|8@0+ (1,0) [0|0] "" A\n', []),
        ('BO_ 5 OF_FD: 64 A\n SG_ S : 7|8@0+ (1,0) [0|0] "" A\n', []),
    ],
    ids=["no signals", "no bytes", "no place", "29 bits", "FD"],
)
def test_odd_messages_are_empty_or_left_out(tmp_path: Path, text: str, names: list[str]) -> None:
    path = tmp_path / "odd.dbc"
    path.write_text(HEAD + text, encoding="utf-8")
    codec = load_codec(str(path))
    assert [message.name for message in codec.by_id.values()] == names
    for message in codec.by_id.values():
        assert message.unpack(message.pack().data) == message.unpack(bytes(8)) == ()


def test_messages_with_one_identifier_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "twice.dbc"
    path.write_text(HEAD + "BO_ 5 FIRST: 8 A\n\nBO_ 5 SECOND: 8 A\n", encoding="utf-8")
    with pytest.raises(CodecError, match=r"twice\.dbc: FIRST: another .* 0x05; leave"):
        load_codec(str(path))


def test_message_with_other_signals_is_refused() -> None:
    assert CODEC.message("ENCODER", ("LEFT", "RIGHT")) is CODEC.message("ENCODER")
    with pytest.raises(CodecError, match=r"kurt2\.dbc: ENCODER: its signals are LEFT, RIGHT; give it LEFT, MID"):
        CODEC.message("ENCODER", ("LEFT", "MID"))


@st.composite
def dbc_messages(draw: st.DrawFn) -> str:
    """Return a message of a DBC file, which may have odd identifiers, lengths and signals."""
    length = draw(st.sampled_from([0, 1, 2, 8, 8, 64]))
    lines = [
        f"BO_ {draw(st.sampled_from([5, 6, 7, 2048, 1 << 31, 3221225472]))} M{draw(st.integers(0, 9))}: {length} A"
    ]
    for number in range(draw(st.integers(0, 3))):
        start, width = draw(st.integers(0, 8 * length + 7)), draw(st.integers(0, 33))
        layout = f"{start}|{width}@{draw(st.integers(0, 1))}{draw(st.sampled_from('+-'))}"
        mux = draw(st.sampled_from(["", "", "", " M", " m0"]))
        lines.append(f' SG_ S{number}{mux} : {layout} ({draw(st.sampled_from(["1", "0", "0.5"]))},0) [0|0] "" A')
    return "\n".join(lines)


@given(messages=st.lists(dbc_messages(), max_size=3), odd=st.text(max_size=1))
def test_any_database_is_a_codec_or_one_line(
    tmp_path_factory: pytest.TempPathFactory, messages: list[str], odd: str
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.dbc"
    path.write_bytes((HEAD + odd + "\n".join(messages) + "\n").encode(errors="surrogatepass"))
    try:
        codec = load_codec(str(path))
    except UserError as error:
        text = str(error)
        assert "\n" not in text
        assert text.startswith(f"{path}: ")
        assert "; " in text
        return
    for message in codec.by_id.values():
        zeros = (0,) * len(message.signals)
        assert message.unpack(message.pack(*zeros).data) == zeros
