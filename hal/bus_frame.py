"""Classic CAN frames as the 16 bytes of Linux's `struct can_frame`, for buses outside this process."""

import struct

import can

from hal.frame import Frame

BUS_FRAME = struct.Struct("=IB3x8s")
"""Identifier with its flags, length, payload padded with zeros."""

_EXTENDED, _REMOTE, _ERROR = 0x8000_0000, 0x4000_0000, 0x2000_0000
_FLAGS = _EXTENDED | _REMOTE | _ERROR
_STANDARD_ID, _EXTENDED_ID = 0x7FF, 0x1FFF_FFFF
_LONGEST = 8


def pack_bus_frame(frame: can.Message) -> bytes:
    """Return the 16 bytes of a frame in Linux's layout.

    Raises ValueError for a frame that is not classic CAN.
    """
    length = frame.dlc if frame.is_remote_frame else len(frame.data)
    if length > _LONGEST or frame.is_fd:
        raise ValueError(f"frame 0x{frame.arbitration_id:X} is not of classic CAN: {length} bytes, FD {frame.is_fd}")
    flagged_id = frame.arbitration_id
    # A wider identifier would come out as another one, or set flags.
    if not 0 <= flagged_id <= (_EXTENDED_ID if frame.is_extended_id or frame.is_error_frame else _STANDARD_ID):
        raise ValueError(f"frame 0x{flagged_id:X} is not of classic CAN: its identifier has too many bits")
    if frame.is_extended_id:
        flagged_id |= _EXTENDED
    if frame.is_remote_frame:
        flagged_id |= _REMOTE
    if frame.is_error_frame:
        flagged_id |= _ERROR
    return BUS_FRAME.pack(flagged_id, length, frame.data)


def frame_of(flagged_id: int, length: int, payload: bytes) -> can.Message:
    """Return the frame of a record that BUS_FRAME unpacked, without time stamp and channel.

    Args:
        flagged_id: identifier with the flags of Linux in its highest bits.
        length: number of bytes of `payload` that count.
        payload: 8 bytes.
    """
    if not flagged_id & _FLAGS:
        return Frame(flagged_id & _STANDARD_ID, payload[:length])
    is_extended = bool(flagged_id & _EXTENDED)
    is_remote = bool(flagged_id & _REMOTE)
    return can.Message(
        arbitration_id=flagged_id & (_EXTENDED_ID if is_extended else _STANDARD_ID),
        is_extended_id=is_extended,
        is_remote_frame=is_remote,
        is_error_frame=bool(flagged_id & _ERROR),
        dlc=min(length, _LONGEST),
        data=None if is_remote else payload[:length],
    )


def is_heard(frame: can.Message, heard: frozenset[int] | None) -> bool:
    """Return whether a filter of standard identifiers (None: no filter) passes a frame; error frames always pass."""
    if heard is None or frame.is_error_frame:
        return True
    return frame.arbitration_id in heard and not frame.is_extended_id
