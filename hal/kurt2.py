"""KURT2 on its CAN bus: frames become SensorReadings, and every set point passes the guard."""

import time
from collections.abc import Callable
from typing import Final

import can

from hal.bus import CONTROL_ID, DRAIN_FRAMES, BusError, CanBus
from hal.bus_state import BusState
from hal.can_wheel_port import CanWheelPort
from hal.codec import InvalidFrameError, load_codec
from hal.guarded_robot import Arrivals, GuardedRobot
from hal.infrared_frames import FrameReader, InfraredCounts, board_of, infrared_frames
from hal.infrared_watch import InfraredWatch
from hal.kurt2_settings import Kurt2Settings
from hal.sender_watch import SenderWatch

_CLOCKS_DIFFER_S = 0.01
"""A frame that is stamped later than this after the present has no age: the wall clock was set back, or worse."""


class Kurt2(GuardedRobot):
    """A robot (hal.robot.Robot) over a CanBus, which it owns from then on."""

    def __init__(
        self, settings: Kurt2Settings, bus: CanBus, watchdog_clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Take the bus. Raises hal.bus.BusError when another robot has it, hal.codec.CodecError for a bad database."""
        self._bus: Final = bus
        self._bus_state: Final = BusState(bus.name)
        channels = tuple(sensor.channel for sensor in settings.infrared.sensors)
        watch = InfraredWatch(map(board_of, channels), settings.guard.frozen_infrared_s)
        super().__init__(settings, CanWheelPort(settings, bus), watch, watchdog_clock)
        self._controller = self._bus_state
        codec = load_codec(settings.can.database)
        analog = infrared_frames(channels, codec, watch, InfraredCounts(self._counts, self._times_s))
        self._encoder = codec.message("ENCODER", ("LEFT", "RIGHT"))
        self._bumperc = codec.message("BUMPERC", ("BUMPERS", "REMOTE_CONTROL"))
        self._readers: dict[int, FrameReader] = {frame.codec.frame_id: frame.read for frame in analog}
        self._readers |= {self._encoder.frame_id: self._read_encoder, self._bumperc.frame_id: self._read_bumpers}
        self._frames_of: Final = dict.fromkeys(self._readers, 0)
        """Number of frames so far, by identifier."""
        names = [f"0x{frame_id:02X} ({codec.by_id[frame_id].name})" for frame_id in self._readers]
        self._sender_watch: Final = SenderWatch(names, self._frames_of.values(), settings.cycle_s)
        self._bumper_payload: bytes | bytearray = b""
        self._cycle_s: Final = settings.cycle_s
        self._encoder_frames = 0
        """ENCODER frames of the present call of `sense`."""
        # CONTROL as well: a second sender of it must not go unnoticed.
        bus.set_id_filter({CONTROL_ID, *self._readers})

    def _receive(self, now_s: float, arrivals: Arrivals) -> None:
        messages, bus_now_s = self._drain(now_s)
        self._encoder_frames = 0
        self._read(messages, bus_now_s, now_s, arrivals)
        self._sender_watch.update(now_s, bus_now_s, more_wait=len(messages) >= DRAIN_FRAMES)
        self._second_sender = self._sender_watch.surplus
        # Time goes by the controller's cycles: a frame that was lost takes its ticks along, and leaves the band wider.
        arrivals.turned_s = arrivals.responded_s = self._encoder_frames * self._cycle_s
        arrivals.bus_off = arrivals.bus_off or self._bus_state.off

    def _reopen_link(self) -> None:
        self._bus.reopen()

    def _close_link(self) -> None:
        self._bus.shutdown()

    def _read(self, messages: list[can.Message], bus_now_s: float | None, now_s: float, arrivals: Arrivals) -> None:
        """Read waiting frames in order; `bus_now_s`: the present on the clock of their time stamps, None without."""
        error_frames, readers, frames_of = 0, self._readers, self._frames_of
        for message in messages:
            if message.is_error_frame:
                error_frames += 1
                self._bus_state.note(message)
                arrivals.bus_off = arrivals.bus_off or self._bus_state.off
                continue
            if message.is_extended_id or message.is_remote_frame:
                self._junk += 1
                continue
            frame_id = message.arbitration_id
            at_s = now_s
            if bus_now_s is not None:
                at_s -= bus_now_s - message.timestamp
                if not at_s <= now_s + _CLOCKS_DIFFER_S and frame_id != CONTROL_ID:  # not a number, too
                    self._junk += 1
                    continue
                at_s = min(at_s, now_s)
            reader = readers.get(frame_id)
            try:
                if reader is not None:
                    frames_of[frame_id] += 1
                    reader(message.data, at_s, arrivals)
                elif frame_id == CONTROL_ID:
                    arrivals.foreign_control += 1
            except InvalidFrameError:
                self._junk += 1
        if len(messages) > error_frames and not arrivals.bus_off:
            self._bus_state.note_traffic()

    def _read_encoder(self, data: bytes | bytearray, at_s: float, arrivals: Arrivals) -> None:
        left, right = self._encoder.unpack(data)
        arrivals.left_ticks += left
        arrivals.right_ticks += right
        self._encoder_frames += 1
        self._encoder_at_s = at_s

    def _read_bumpers(self, data: bytes | bytearray, at_s: float, arrivals: Arrivals) -> None:
        if data != self._bumper_payload:
            self._bumpers = self._bumperc.unpack(data)[0] & self._bumper_mask
            self._bumper_payload = data
        arrivals.bumpers |= self._bumpers
        self._bumpers_at_s = at_s

    def _drain(self, now_s: float) -> tuple[list[can.Message], float | None]:
        """Return the waiting frames, and the present on the clock of their time stamps."""
        messages: list[can.Message] = []
        bus_now_s: float | None = None
        try:
            # The clock after the frames, and both or neither: a frame must not look younger than it is.
            messages, bus_now_s = self._bus.drain(), self._bus.now_s()
        except BusError as error:
            self._lose_link(error, now_s)
        self._try_to_reopen(now_s)
        self._frames += len(messages)
        return messages, bus_now_s
