"""Length of a frame in bits, against can-utils and against the bits written as text."""

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simbridge.wire.bits import arbitration_key, bits_to_difference, frame_bits


def message(frame_id: int, payload: bytes = b"", *, extended: bool = False, remote: bool = False) -> can.Message:
    return can.Message(arbitration_id=frame_id, data=payload, is_extended_id=extended, is_remote_frame=remote)


@st.composite
def any_frame(draw: st.DrawFn) -> can.Message:
    extended, remote = draw(st.booleans()), draw(st.booleans())
    frame_id = draw(st.one_of(st.integers(0, 0x7FF), st.integers(0, 0x1FFFFFFF)) if extended else st.integers(0, 0x7FF))
    # Bytes with long runs, which random ones seldom have.
    byte = st.one_of(st.sampled_from((0x00, 0xFF, 0x1F, 0xF8, 0x0F, 0x07)), st.integers(0, 255))
    payload = b"" if remote else bytes(draw(st.lists(byte, max_size=8)))
    return message(frame_id, payload, extended=extended, remote=remote)


def written_out(frame: can.Message) -> tuple[str, str]:
    """Return the arbitration field, and the bits from the start bit to the CRC, as text without stuff bits."""
    remote = "1" if frame.is_remote_frame else "0"
    if frame.is_extended_id:
        identifier = f"{frame.arbitration_id:029b}"
        arbitration = identifier[:11] + "11" + identifier[11:] + remote
        reserved = "00"
    else:
        arbitration = f"{frame.arbitration_id:011b}" + remote + "0"
        reserved = "0"
    bits = "0" + arbitration + reserved + f"{frame.dlc:04b}" + "".join(f"{byte:08b}" for byte in frame.data)
    register = [0] * 15
    for bit in bits:  # the CRC's shift register as the specification draws it
        feedback = int(bit) ^ register[0]
        register = [*register[1:], 0]
        if feedback:
            register = [each ^ int(tap) for each, tap in zip(register, "100010110011001", strict=True)]
    return arbitration, bits + "".join(str(each) for each in register)


def stuffed(bits: str) -> str:
    out = ""
    for bit in bits:
        out += bit
        if out.endswith(("00000", "11111")):
            out += "1" if bit == "0" else "0"
    return out


@pytest.mark.parametrize(
    ("frame", "bits"),
    [
        # Counted by can-utils (canframelen, mode exact), less the three bits of interframe space.
        (message(0x000), 50),
        (message(0x7FF), 47),
        (message(0x555, bytes.fromhex("55" * 8)), 109),
        (message(0x000, bytes(8)), 124),
        (message(0x7FF, b"\xff" * 8), 123),
        (message(0x123, remote=True), 45),
        (message(0x009, b"\0"), 55),
        (message(0x078, bytes.fromhex("3C3C3C")), 71),
        (message(0x001, bytes.fromhex("0002000000000001")), 122),  # CONTROL: stand, SPEED_CM
        (message(0x001, bytes.fromhex("00000103FF0103FF")), 122),  # CONTROL: brake
        (message(0x15555555, bytes.fromhex("AA" * 8), extended=True), 128),
        (message(0x00000000, bytes(8), extended=True), 147),
        (message(0x1FFFFFFF, b"\xff" * 8, extended=True), 146),
        (message(0x1FFFFFFF, extended=True, remote=True), 71),
    ],
)
def test_frame_bits_equal_those_of_can_utils(frame: can.Message, bits: int) -> None:
    assert frame_bits(frame) == bits


@given(any_frame())
def test_frame_bits_equal_the_bits_written_out(frame: can.Message) -> None:
    _, bits = written_out(frame)
    # CRC delimiter, ACK slot, ACK delimiter, seven bits of end of frame
    assert frame_bits(frame) == len(stuffed(bits)) + 1 + 1 + 1 + 7


@given(any_frame())
def test_frame_bits_stay_within_published_bounds(frame: can.Message) -> None:
    """Davis and Burns 2007: at most 55 + 10 n bits, for 29 bits of identifier 80 + 10 n, interframe space included."""
    bits = frame_bits(frame) + 3
    data_bytes = len(frame.data)
    if frame.is_extended_id:
        assert 67 + 8 * data_bytes <= bits <= 80 + 10 * data_bytes
    else:
        assert 47 + 8 * data_bytes <= bits <= 55 + 10 * data_bytes


@given(any_frame(), any_frame())
def test_arbitration_key_orders_by_the_first_zero(one: can.Message, other: can.Message) -> None:
    first, second = written_out(one)[0], written_out(other)[0]
    # A field of 11 bits is compared with the beginning of one of 29 bits: its IDE bit is the last that counts.
    differing = [(a, b) for a, b in zip(first, second, strict=False) if a != b]
    if differing:
        assert (arbitration_key(one) < arbitration_key(other)) is (differing[0] == ("0", "1"))
    else:
        assert arbitration_key(one) == arbitration_key(other)


@given(any_frame(), st.binary(max_size=8))
def test_bits_to_difference_finds_the_first_different_bit(one: can.Message, payload: bytes) -> None:
    other = message(one.arbitration_id, payload, extended=one.is_extended_id)
    one.is_remote_frame = False
    first, second = written_out(one)[1], written_out(other)[1]
    same = next((at for at, (a, b) in enumerate(zip(first, second, strict=False)) if a != b), None)
    assert bits_to_difference(one, other) == same
