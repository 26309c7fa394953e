"""The controller's end of a bus, with wiring mistakes and pressed bumpers."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

import can

from hal.bus import CONTROL_ID
from hal.codec import load_codec
from hal.control import Control, RawControl, SpeedControl, control_frame, decode_control
from hal.frame import Frame
from hal.in_process_bus import InProcessBus
from hal.kurt2_settings import SpeedMode

_CODEC = load_codec()
_ENCODER, _BUMPERC = _CODEC.message("ENCODER"), _CODEC.message("BUMPERC")


@dataclass
class Wiring:
    """Wiring mistakes of a robot; by default there are none."""

    modes: Collection[SpeedMode] = tuple(SpeedMode)
    """Speed modes of the firmware; others change nothing, as junk does."""
    wild_modes: Collection[SpeedMode] = ()
    """Speed loops of the firmware that run away, as one does whose encoder counts the wrong way."""
    motors_exchanged: bool = False
    reversed_motors: Collection[int] = ()
    """Sides, 0 left, whose motor's leads are exchanged."""
    encoders_exchanged: bool = False
    reversed_encoders: Collection[int] = ()
    dead_encoders: Collection[int] = ()
    brake_works: bool = True
    silent_ids: Collection[int] = ()
    """Frames that never come."""
    every_other: Collection[int] = ()
    """Frames that come at half their pace."""
    bumper_bits: Mapping[str, int] = field(default_factory=dict)
    """Bits of the bumpers by name."""
    hanging_bits: int = 0
    pressed: int = 0
    controls: int = 0
    """CONTROL frames that arrived."""


class WiredEnd(InProcessBus):
    """An end of the in-process bus with such a wiring behind it."""

    def __init__(self, name: str, wiring: Wiring) -> None:
        super().__init__(name)
        self._wiring = wiring
        self._turns = 0

    def recv(self, timeout: float | None = None) -> can.Message | None:
        while (message := super().recv(timeout)) is not None:
            if message.arbitration_id != CONTROL_ID:
                return message
            self._wiring.controls += 1
            control = self._at_the_motors(decode_control(message.data))
            if control is not None:
                return control_frame(control)
        return None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        frame_id = msg.arbitration_id
        wiring = self._wiring
        if frame_id == _ENCODER.frame_id:
            msg = self._from_the_encoders(msg)
        elif frame_id == _BUMPERC.frame_id:
            msg = _BUMPERC.pack(wiring.pressed | wiring.hanging_bits, 0)
        self._turns += frame_id in wiring.every_other
        if frame_id in wiring.silent_ids or (frame_id in wiring.every_other and self._turns % 2):
            return
        super().send(msg, timeout)

    def _at_the_motors(self, control: Control) -> Control | None:
        wiring = self._wiring
        if isinstance(control, SpeedControl):
            if SpeedMode(control.mode.name) not in wiring.modes:
                return None
            sides = [control.left, control.right]
            signed = [
                -speed if side in wiring.reversed_motors else speed
                for side, speed in enumerate(_at_plugs(sides, wiring))
            ]
            gain = 6 if SpeedMode(control.mode.name) in wiring.wild_modes else 1
            return control._replace(left=gain * signed[0], right=gain * signed[1])
        if isinstance(control, RawControl):
            braking = control.left.brake and control.right.brake
            if not wiring.brake_works if braking else SpeedMode.RAW not in wiring.modes:
                return None
            raw = _at_plugs([control.left, control.right], wiring)
            turned = [
                each._replace(backward=not each.backward) if side in wiring.reversed_motors else each
                for side, each in enumerate(raw)
            ]
            return RawControl(turned[0], turned[1])
        return control

    def _from_the_encoders(self, message: can.Message) -> Frame:
        wiring = self._wiring
        counted = list(_ENCODER.unpack(message.data))
        for side in (0, 1):
            if side in wiring.reversed_encoders:
                counted[side] = -counted[side]
            if side in wiring.dead_encoders:
                counted[side] = 0
        return _ENCODER.pack(*(reversed(counted) if wiring.encoders_exchanged else counted))


_Side = TypeVar("_Side")


def _at_plugs(sides: list[_Side], wiring: Wiring) -> list[_Side]:
    return sides[::-1] if wiring.motors_exchanged else sides
