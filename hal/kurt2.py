"""The KURT2 on its CAN bus: frames become Senses, and every set point goes through the guard."""

import math
import time
from collections.abc import Callable, Mapping
from typing import Final

import can

from hal.bus import CONTROL_ID, BusError, CanBus
from hal.codec import Codec, JunkFrameError, MessageCodec, load_codec
from hal.guard import BUS_LOST, Guard
from hal.health import Health
from hal.robot import HIGHEST_COUNTS, Grant, Senses, WheelSpeeds
from hal.robot_settings import RobotSettings
from hal.watchdog import TICKS_CEASED, Watchdog

CLOSED = "closed"
REOPEN_PERIOD_S = 1.0


class _AnalogFrame:
    """One frame of the converter: where its channels go in Senses.infrared_counts."""

    __slots__ = ("codec", "last_payload", "places", "received_at_s")

    def __init__(self, codec: MessageCodec, sensor_of_channel: Mapping[str, int]) -> None:
        self.codec = codec
        self.places = tuple(
            (at, sensor_of_channel[channel]) for at, channel in enumerate(codec.signals) if channel in sensor_of_channel
        )
        self.last_payload: bytes | bytearray = b""
        self.received_at_s = -math.inf


class Kurt2:
    """A robot (hal.robot.Robot) over a CanBus, which it owns from then on."""

    def __init__(
        self, settings: RobotSettings, bus: CanBus, watchdog_clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Take the bus. Raises hal.bus.BusError when another robot has it, hal.codec.CodecError for a bad database."""
        self._bus: Final = bus
        self._guard: Final = Guard(settings, bus)
        self.watchdog: Final = Watchdog(self._guard, settings.guard.ticks_ceased_s, watchdog_clock)
        """The second guard; whoever runs the robot in real time starts it. `drive` is its beat."""
        codec = load_codec(settings.can.database)
        self._analog = _analog_frames(settings, codec)
        self._encoder = codec.message("ENCODER")
        self._bumperc = codec.message("BUMPERC")
        self._known_ids = frozenset(codec.by_id)
        self._bumper_mask = (1 << len(settings.bumpers)) - 1
        self._counts = [0] * len(settings.infrared.sensors)
        self._bumpers = 0
        self._encoder_at_s = self._bumpers_at_s = -math.inf
        self._senses = Senses(-math.inf, tuple(self._counts), math.inf, 0, 0, math.inf, 0, math.inf)
        self._bus_lost = self._closed = False
        self._reopen_at_s = math.inf
        self._frames = self._junk = self._unknown = self._foreign_control = self._receive_failures = 0
        self._receive_trouble = ""

    def sense(self, now_s: float) -> Senses:
        """Take everything that arrived, without waiting, and return the newest values.

        Frames count as received at `now_s`. A frame with junk in it changes nothing, not even its age: a channel that
        stays broken becomes stale, and the guard stands. A lost bus raises nothing; the senses age.
        """
        left_ticks = right_ticks = 0
        changed = False
        for message in self._drain(now_s):
            data = message.data
            frame_id = message.arbitration_id
            if message.is_extended_id or message.is_remote_frame or message.is_error_frame:
                self._junk += 1
                continue
            analog = self._analog.get(frame_id)
            try:
                if analog is not None:
                    if data != analog.last_payload:
                        self._read_analog(analog, data)
                        changed = True
                    analog.received_at_s = now_s
                elif frame_id == self._encoder.frame_id:
                    left, right = self._encoder.unpack(data)
                    left_ticks += left
                    right_ticks += right
                    self._encoder_at_s = now_s
                elif frame_id == self._bumperc.frame_id:
                    self._bumpers = self._bumperc.unpack(data)[0] & self._bumper_mask
                    self._bumpers_at_s = now_s
                elif frame_id == CONTROL_ID:
                    self._foreign_control += 1
                elif frame_id not in self._known_ids:
                    self._unknown += 1
            except JunkFrameError:
                self._junk += 1
        infrared_at_s = min([analog.received_at_s for analog in self._analog.values()])
        self._senses = Senses(
            now_s,
            tuple(self._counts) if changed else self._senses.infrared_counts,
            now_s - infrared_at_s,
            left_ticks,
            right_ticks,
            now_s - self._encoder_at_s,
            self._bumpers,
            now_s - self._bumpers_at_s,
        )
        return self._senses

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> Grant:
        """Ask for wheel speeds in m/s; what is safe by the newest senses goes out in this tick's CONTROL frame."""
        if self.watchdog.ticks_ceased:
            # The loop came back before the watchdog's thread did; its beat must not hide the gap.
            self._guard.emergency_stop(TICKS_CEASED)
        grant = self._guard.drive(wanted, self._senses, decided_at_s, now_s)
        self.watchdog.beat()
        return grant

    def emergency_stop(self, reason: str) -> None:
        """Brake now and stay stopped until `release`."""
        self._guard.emergency_stop(reason)

    def release(self) -> None:
        """End a latched stop; the robot still stands until it is driven."""
        self._guard.release()

    def close(self) -> None:
        """Brake, end the watchdog and give the bus back."""
        self._closed = True
        self.watchdog.stop()
        self._guard.emergency_stop(CLOSED)
        self._bus.shutdown()

    @property
    def health(self) -> Health:
        """Counters as they stand now."""
        return Health(
            frames=self._frames,
            junk=self._junk,
            unknown=self._unknown,
            foreign_control=self._foreign_control,
            send_failures=self._guard.send_failures,
            receive_failures=self._receive_failures,
            bus_trouble=self._receive_trouble or self._guard.bus_trouble,
            latched=self._guard.latched,
        )

    def _drain(self, now_s: float) -> list[can.Message]:
        messages: list[can.Message] = []
        try:
            messages = self._bus.drain()
        except BusError as error:
            self._receive_failures += 1
            if not self._bus_lost:
                self._bus_lost = True
                self._receive_trouble = str(error)
                self._reopen_at_s = now_s + REOPEN_PERIOD_S
                self._guard.emergency_stop(BUS_LOST)
        if self._bus_lost and now_s >= self._reopen_at_s and not self._closed:
            self._reopen(now_s)
        self._frames += len(messages)
        return messages

    def _reopen(self, now_s: float) -> None:
        """An adapter that was unplugged fails once and is silent then: only opening it anew shows that it is back."""
        self._reopen_at_s = now_s + REOPEN_PERIOD_S
        try:
            self._bus.reopen()
        except BusError as error:
            self._receive_trouble = str(error)
        else:
            self._bus_lost = False
            self._receive_trouble = ""

    def _read_analog(self, analog: _AnalogFrame, data: bytes | bytearray) -> None:
        raw = analog.codec.unpack(data)
        for at, _ in analog.places:
            # The C167's result register keeps the channel number above the result (reference 5, point 7).
            if raw[at] > HIGHEST_COUNTS:
                raise JunkFrameError(f"{analog.codec.name}: {raw[at]} counts, a 10-bit converter has {HIGHEST_COUNTS}")
        for at, sensor in analog.places:
            self._counts[sensor] = raw[at]
        analog.last_payload = data


def _analog_frames(settings: RobotSettings, codec: Codec) -> dict[int, _AnalogFrame]:
    """The frames that carry channels of the sensor table, by identifier; channel names are signal names."""
    sensor_of_channel = {sensor.channel: at for at, sensor in enumerate(settings.infrared.sensors)}
    frames = {frame_id: _AnalogFrame(message, sensor_of_channel) for frame_id, message in codec.by_id.items()}
    return {frame_id: frame for frame_id, frame in frames.items() if frame.places}
