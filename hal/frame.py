"""A data frame of this robot: python-can's message with a standard identifier and a payload that never changes."""

from typing import Any

import can


class Frame(can.Message):
    """A classic CAN data frame with an 11-bit identifier.

    The payload is immutable, so copies share it: python-can's in-process bus deep-copies every frame for every
    listener, and its own copy costs more than all the rest of sending. Its kind is immutable, too: a frame of this
    class needs no look at its flags.
    """

    __slots__ = ()

    data: bytes  # type: ignore[assignment]  # python-can holds a bytearray, which a shared payload must not be

    # Constants of the class, which hide python-can's slots: setting six attributes takes a quarter of the time.
    is_extended_id = False
    is_remote_frame = False
    is_error_frame = False
    is_fd = False
    bitrate_switch = False
    error_state_indicator = False

    def __init__(self, frame_id: int, payload: bytes) -> None:
        self.arbitration_id = frame_id
        self.data = payload
        self.dlc = len(payload)
        self.channel = None
        self.timestamp = 0.0
        self.is_rx = True

    def __deepcopy__(self, memo: dict[int, Any] | None) -> "Frame":
        return Frame(self.arbitration_id, self.data)

    def __copy__(self) -> "Frame":
        return Frame(self.arbitration_id, self.data)
