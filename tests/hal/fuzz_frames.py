"""Frames that no robot would send: drawn at random, mutated from good ones, and in floods."""

import random
from collections.abc import Callable, Iterator

import can

from hal.bus import CONTROL_ID
from hal.frame import Frame
from tests.hal.helpers import CODEC

FD_LENGTHS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64)
"""Payload lengths in bytes of the codes 0 to 15 of CAN FD."""
CONTROL_MODES = (0, 1, 2, 0xFF00, 0xFF01, 0xFF02, 0xFF03, 0xFF04, 0xFF05, 0xFFFF)
_KNOWN = tuple(CODEC.by_id.values())
_STATES = (0x00, 0x04, 0x08, 0x0C, 0x10, 0x20, 0x30, 0x40, 0x03)

MakeFrame = Callable[[], can.Message]


class FuzzFrames:
    """A source of bad frames; the same seed gives the same ones."""

    def __init__(self, seed: int, *, fd: bool = True) -> None:
        """`fd`: the bus carries frames of CAN FD, too."""
        self._chance = random.Random(seed)
        self._fd = fd
        self._kinds: tuple[MakeFrame, ...] = (
            self.random_frame,
            self.known_frame,
            self.cut_frame,
            self.extended_frame,
            self.remote_frame,
            self.error_frame,
            self.control_frame,
            *((self.fd_frame,) if fd else ()),
        )

    def spells(self) -> Iterator[list[can.Message]]:
        """Yield the frames of each tick: spells of one kind, of all kinds, of silence, and floods."""
        chance = self._chance
        while True:
            kinds = chance.choice([self._kinds, (chance.choice(self._kinds),), (self.known_frame, self.cut_frame)])
            most = chance.choice([0, 3, 30, 30, 120])
            for _ in range(chance.randint(1, 60)):
                count = chance.randint(0, most)
                if chance.random() < 0.01:
                    count = 300  # more than a full bus carries in 10 ms
                    kinds = (chance.choice(self._kinds),)
                yield [chance.choice(kinds)() for _ in range(count)]

    def for_control(self) -> can.Message:
        """Yield frames for a receiver of CONTROL: most are CONTROL, some valid."""
        kinds = (self.control_frame, self.control_frame, self.control_frame, *self._kinds)
        return self._chance.choice(kinds)()

    def random_frame(self) -> can.Message:
        """Any identifier, any payload."""
        return self._frame(self._chance.getrandbits(11), self._bytes(self._chance.randint(0, 8)))

    def known_frame(self) -> can.Message:
        """Return an identifier of the database with a payload that may be right, nearly right, or not at all."""
        message = self._chance.choice(_KNOWN)
        kind = self._chance.random()
        if kind < 0.4:
            data = bytes(byte & 0x03 if at % 2 == 0 else byte for at, byte in enumerate(self._bytes(8)))
        elif kind < 0.6:
            data = self._chance.choice([bytes(8), b"\xff" * 8, b"\x03\xff" * 4, b"\x04\x00" * 4, b"\x7f\xff" * 4])
        else:
            data = self._bytes(8)
        return self._frame(message.frame_id, data)

    def cut_frame(self) -> can.Message:
        """Return an identifier of the database and fewer bytes than it needs; the length code may differ."""
        frame = self._frame(self._chance.choice(_KNOWN).frame_id, self._bytes(self._chance.randint(0, 7)))
        if self._fd and self._chance.random() < 0.3:
            frame.dlc = 8
        return frame

    def extended_frame(self) -> can.Message:
        """Return a 29-bit identifier, often one whose lower bits are those of a good frame."""
        wide = self._chance.getrandbits(29)
        if self._chance.random() < 0.5:
            wide = (wide & ~0x7FF) | self._chance.choice([CONTROL_ID, *CODEC.by_id])
        if self._chance.random() < 0.2:
            wide &= 0x7FF
        return self._frame(wide, self._bytes(8), is_extended_id=True)

    def remote_frame(self) -> can.Message:
        """Return a remote frame."""
        frame_id = self._chance.choice([CONTROL_ID, *CODEC.by_id])
        return can.Message(
            arbitration_id=frame_id, is_extended_id=False, is_remote_frame=True, dlc=self._chance.randint(0, 8)
        )

    def error_frame(self) -> can.Message:
        """Something that looks like an adapter's word on its troubles."""
        classes = self._chance.choice([self._chance.getrandbits(29), 1 << self._chance.randint(0, 9), 0x04, 0x88, 0])
        data = bytearray(self._bytes(self._chance.choice([0, 1, 7, 8, 8, 8])))
        if len(data) > 1:
            data[1] = self._chance.choice(_STATES)
        return self._frame(classes, bytes(data), is_extended_id=classes > 0x7FF, is_error_frame=True)

    def control_frame(self) -> can.Message:
        """Return another node's CONTROL, valid or not."""
        mode = self._chance.choice(CONTROL_MODES) if self._chance.random() < 0.8 else self._chance.getrandbits(16)
        speeds = self._chance.choice(
            [self._bytes(6), bytes(6), b"\x00\x14\x00\x14\x00\x01", b"\x01\x03\xff\x01\x03\xff"]
        )
        length = 8 if self._chance.random() < 0.8 else self._chance.randint(0, 7)
        return self._frame(CONTROL_ID, (mode.to_bytes(2, "big") + speeds)[:length])

    def fd_frame(self) -> can.Message:
        """Return a frame of CAN FD with its flags, of any length."""
        chance = self._chance
        return can.Message(
            arbitration_id=chance.choice([CONTROL_ID, *CODEC.by_id, chance.getrandbits(11)]),
            is_extended_id=False,
            is_fd=True,
            bitrate_switch=chance.random() < 0.5,
            error_state_indicator=chance.random() < 0.5,
            data=self._bytes(chance.choice(FD_LENGTHS)),
        )

    def _bytes(self, count: int) -> bytes:
        return self._chance.randbytes(count)

    def _frame(
        self, frame_id: int, data: bytes, *, is_extended_id: bool = False, is_error_frame: bool = False
    ) -> can.Message:
        if not is_extended_id and not is_error_frame and self._chance.random() < 0.7:
            return Frame(frame_id, data)  # as this program's own buses have them
        return can.Message(
            arbitration_id=frame_id, is_extended_id=is_extended_id, is_error_frame=is_error_frame, data=data
        )
