"""A frame as bits: how many it takes on the wire, stuff bits counted over the bits it has, and who wins the wire.

CAN specification 2.0, part B: fields in section 3.1, bit stuffing in section 5, CRC in section 3.1.1.
"""

import can

INTERFRAME_BITS = 3
"""Recessive bits between two frames, in which nobody may send."""

_AFTER_CRC_BITS = 10
"""CRC delimiter, ACK slot and its delimiter, seven of end of frame: these are never stuffed."""
_CRC_DELIMITER_BITS = 1
_CRC_BITS, _CRC_POLYNOMIAL = 15, 0x4599
_SHORT_HEADER_BITS, _LONG_HEADER_BITS = 19, 39
# Ahead of the start bit, so that all stuffed bits fill whole bytes. They alternate and end unlike the start bit: no
# run begins in them.
_SHORT_LEAD, _LONG_LEAD = 0b010101, 0b01


def frame_bits(frame: can.Message) -> int:
    """Bits of a frame from its start bit to the end of its end-of-frame field; the interframe space is not in it.

    Data and remote frames with identifiers of 11 and 29 bits.
    """
    header, payload = _header(frame), bytes(frame.data)
    crc = 0
    # The CRC begins at 0, so zeros ahead of the start bit leave it as it is.
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
    """How many of a frame's bits are ahead of its ACK slot, in which somebody has to answer."""
    return bits - _AFTER_CRC_BITS + _CRC_DELIMITER_BITS


def arbitration_key(frame: can.Message) -> int:
    """The bits by which a frame wins or loses the wire, as a number: the smaller one wins, a zero is dominant.

    Identifier, then for 11 bits RTR and IDE, for 29 bits SRR, IDE, the other 18 bits and RTR.
    """
    if frame.is_extended_id:
        base, rest = divmod(frame.arbitration_id, 1 << 18)
        return base << 21 | 0b11 << 19 | rest << 1 | frame.is_remote_frame
    return frame.arbitration_id << 21 | frame.is_remote_frame << 20


def bits_to_difference(one: can.Message, other: can.Message) -> int | None:
    """How many bits two frames of one arbitration key share before they differ, stuff bits aside; None: they do not."""
    length = min(len(one.data), len(other.data))
    bits = (_LONG_HEADER_BITS if one.is_extended_id else _SHORT_HEADER_BITS) + 8 * length
    difference = _beginning(one, length) ^ _beginning(other, length)
    return bits - difference.bit_length() if difference else None


def _beginning(frame: can.Message, length: int) -> int:
    return _header(frame) << 8 * length | int.from_bytes(frame.data[:length], "big")


def _header(frame: can.Message) -> int:
    """From the start bit, which is 0, to the data length code."""
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
    """State after a byte that follows `run` bits of the value `last`, and the stuff bits that it needs."""
    stuffed = 0
    for place in range(7, -1, -1):
        bit = byte >> place & 1
        run = run + 1 if bit == last else 1
        last = bit
        if run == 5:  # the stuff bit is the other value and begins the next run
            last, run = 1 - last, 1
            stuffed += 1
    return _state(last, run), stuffed


def _state(last: int, run: int) -> int:
    return (1 - last) * 4 + run - 1


_CRC_OF_BYTE = tuple(_crc_of_byte(byte) for byte in range(256))
_STUFFED_BY_BYTE = tuple(
    tuple(_stuffed_by_byte(last, run, byte) for byte in range(256)) for last in (1, 0) for run in (1, 2, 3, 4)
)
"""By the state before (0: one bit of value 1, as between frames) and by byte."""
