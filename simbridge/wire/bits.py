"""Length of frames in bits including stuff bits, and arbitration.

CAN specification 2.0, part B: fields in section 3.1, bit stuffing in section 5, CRC in section 3.1.1.
"""

import can

INTERFRAME_BITS = 3
"""Recessive bits between two frames, in which no node may send."""

_AFTER_CRC_BITS = 10
"""Bits that are never stuffed: CRC delimiter, ACK slot and delimiter, seven of end of frame."""
_CRC_DELIMITER_BITS = 1
_CRC_BITS, _CRC_POLYNOMIAL = 15, 0x4599
_SHORT_HEADER_BITS, _LONG_HEADER_BITS = 19, 39
# Padding ahead of the start bit to whole bytes. The bits alternate and end unlike the start bit, so no run begins here.
_SHORT_LEAD, _LONG_LEAD = 0b010101, 0b01


def frame_bits(frame: can.Message) -> int:
    """Return the bits of a frame from its start bit to the end of frame, without the interframe space.

    The frame is a data or remote frame with an identifier of 11 or 29 bits.
    """
    header, payload = _header(frame), bytes(frame.data)
    crc = 0
    # The CRC starts at 0, so zeros ahead of the start bit do not change it.
    for byte in header.to_bytes(5 if frame.is_extended_id else 3, "big") + payload:
        crc = _CRC_OF_BYTE[(crc >> 7) ^ byte] ^ (crc << 8 & 0x7FFF)
    if frame.is_extended_id:
        bits, lead = _LONG_HEADER_BITS, _LONG_LEAD
    else:
        bits, lead = _SHORT_HEADER_BITS, _SHORT_LEAD
    whole = (lead << bits | header) << 8 * len(payload) | int.from_bytes(payload, "big")
    bits += 8 * len(payload) + _CRC_BITS
    state = 0
    for byte in (whole << _CRC_BITS | crc).to_bytes((bits + 7) // 8, "big"):
        state, stuffed = _STUFFED_BY_BYTE[state][byte]
        bits += stuffed
    return bits + _AFTER_CRC_BITS


def bits_before_ack(bits: int) -> int:
    """Return the number of a frame's bits ahead of its ACK slot."""
    return bits - _AFTER_CRC_BITS + _CRC_DELIMITER_BITS


def arbitration_key(frame: can.Message) -> int:
    """Return the arbitration field as a number; the smaller one wins, because a zero is dominant.

    11 bits: identifier, RTR, IDE. 29 bits: upper 11 bits, SRR, IDE, lower 18 bits, RTR.
    """
    if frame.is_extended_id:
        base, rest = divmod(frame.arbitration_id, 1 << 18)
        return base << 21 | 0b11 << 19 | rest << 1 | frame.is_remote_frame
    return frame.arbitration_id << 21 | frame.is_remote_frame << 20


def bits_to_difference(one: can.Message, other: can.Message) -> int | None:
    """Return the number of equal leading bits, without stuff bits, of two frames; None if all are equal."""
    length = min(len(one.data), len(other.data))
    bits = (_LONG_HEADER_BITS if one.is_extended_id else _SHORT_HEADER_BITS) + 8 * length
    difference = _beginning(one, length) ^ _beginning(other, length)
    return bits - difference.bit_length() if difference else None


def _beginning(frame: can.Message, length: int) -> int:
    return _header(frame) << 8 * length | int.from_bytes(frame.data[:length], "big")


def _header(frame: can.Message) -> int:
    """Return the bits from the start bit, which is 0, to the data length code."""
    if frame.is_extended_id:
        base, rest = divmod(frame.arbitration_id, 1 << 18)
        return base << 27 | 0b11 << 25 | rest << 7 | frame.is_remote_frame << 6 | frame.dlc
    return frame.arbitration_id << 7 | frame.is_remote_frame << 6 | frame.dlc


def _crc_of_byte(byte: int) -> int:
    crc = byte << 7
    for _ in range(8):
        crc = crc << 1 ^ (_CRC_POLYNOMIAL if crc & 0x4000 else 0)
    return crc & 0x7FFF


def _stuffed_by_byte(last: int, run: int, byte: int) -> tuple[int, int]:
    """Return the state and the number of stuff bits after a byte that follows `run` bits of value `last`."""
    stuffed = 0
    for place in range(7, -1, -1):
        bit = byte >> place & 1
        run = run + 1 if bit == last else 1
        last = bit
        if run == 5:  # the stuff bit has the other value and starts the next run
            last, run = 1 - last, 1
            stuffed += 1
    return _state(last, run), stuffed


def _state(last: int, run: int) -> int:
    return (1 - last) * 4 + run - 1


_CRC_OF_BYTE = tuple(_crc_of_byte(byte) for byte in range(256))
_STUFFED_BY_BYTE = tuple(
    tuple(_stuffed_by_byte(last, run, byte) for byte in range(256)) for last in (1, 0) for run in (1, 2, 3, 4)
)
"""Table by state (0: one bit of value 1, as between frames) and by byte."""
