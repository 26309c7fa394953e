"""KURT2 on its CAN bus: frames become SensorReadings, and every set point passes the guard."""

import math
import time
from collections.abc import Callable
from typing import Final

import can

from hal.bus import CONTROL_ID, BusError, CanBus
from hal.bus_state import BusState
from hal.codec import Codec, InvalidFrameError, MessageCodec, load_codec
from hal.guard import Guard
from hal.guard_reason import GuardReason
from hal.health import Health
from hal.infrared_watch import Board, InfraredWatch
from hal.robot import HIGHEST_COUNTS, STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from hal.robot_settings import RobotSettings
from hal.watchdog import Watchdog
from hal.wheel_watch import WheelWatch

REOPEN_PERIOD_S = 1.0
_CLOCKS_DIFFER_S = 0.01
"""A frame that is stamped later than this after the present has no age: the wall clock was set back, or worse."""


class _AnalogFrame:
    """Frame of a converter: the places of its channels in SensorReadings.infrared_counts, and its board."""

    __slots__ = ("board", "codec", "last_payload", "places", "received_at_s")

    def __init__(self, codec: MessageCodec, places: tuple[tuple[int, int], ...], board: Board) -> None:
        """Set `places`: (place in the frame, place in SensorReadings.infrared_counts) of each distance channel."""
        self.codec = codec
        self.places = places
        self.board = board
        self.last_payload: bytes | bytearray = b""
        self.received_at_s = -math.inf


class Kurt2:
    """A robot (hal.robot.Robot) over a CanBus, which it owns from then on."""

    def __init__(
        self, settings: RobotSettings, bus: CanBus, watchdog_clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Take the bus. Raises hal.bus.BusError when another robot has it, hal.codec.CodecError for a bad database."""
        self._bus: Final = bus
        self._bus_state: Final = BusState(bus.name)
        self._guard: Final = Guard(settings, bus)
        self.watchdog: Final = Watchdog(self._guard, settings.guard.ticks_ceased_s, watchdog_clock)
        """Watchdog, which the real-time loop starts. `drive` is its beat."""
        channels = tuple(sensor.channel for sensor in settings.infrared.sensors)
        self._infrared_watch: Final = InfraredWatch(channels, settings.guard.frozen_infrared_s)
        self._wheel_watch: Final = WheelWatch(settings)
        self._pause_s: Final = settings.guard.ticks_ceased_s
        codec = load_codec(settings.can.database)
        self._analog = _analog_frames(channels, codec, self._infrared_watch)
        self._encoder = codec.message("ENCODER")
        self._bumperc = codec.message("BUMPERC")
        self._bumper_mask = (1 << len(settings.bumpers)) - 1
        self._counts = [0] * len(channels)
        self._bumpers = 0
        self._encoder_at_s = self._bumpers_at_s = -math.inf
        self._readings = SensorReadings(-math.inf, tuple(self._counts), math.inf, 0, 0, math.inf, 0, math.inf)
        self._command = STANDSTILL
        self._bus_lost = self._closed = False
        self._reopen_at_s = math.inf
        self._frames = self._junk = self._foreign_control = self._receive_failures = 0
        self._receive_trouble = self._alarm = ""
        # CONTROL as well: a second sender of it must not go unnoticed.
        bus.set_id_filter({CONTROL_ID, self._encoder.frame_id, self._bumperc.frame_id, *self._analog})

    def sense(self, now_s: float) -> SensorReadings:
        """Take everything that arrived, without waiting, and return the newest values.

        A frame is as old as its time stamp says; where the bus has no clock it arrived at `now_s`. A frame with junk
        in it, or from the future, changes nothing, not even its age: a channel that stays broken becomes stale, and
        the guard stands. A lost bus raises nothing; the readings age. What must stop the robot at once does so here.
        """
        messages, bus_now_s = self._drain(now_s)
        paused = now_s - self._readings.time_s > self._pause_s
        if now_s < self._readings.time_s:
            self._forget_ages()
        left_ticks = right_ticks = encoder_frames = error_frames = foreign_control = 0
        changed = bus_off = False
        for message in messages:
            if message.is_error_frame:
                error_frames += 1
                self._bus_state.note(message)
                bus_off = bus_off or self._bus_state.off
                continue
            if message.is_extended_id or message.is_remote_frame:
                self._junk += 1
                continue
            data = message.data
            frame_id = message.arbitration_id
            at_s = now_s
            if bus_now_s is not None:
                at_s -= bus_now_s - message.timestamp
                if not at_s <= now_s + _CLOCKS_DIFFER_S and frame_id != CONTROL_ID:  # not a number, too
                    self._junk += 1
                    continue
                at_s = min(at_s, now_s)
            analog = self._analog.get(frame_id)
            try:
                if analog is not None:
                    if data != analog.last_payload and self._read_analog(analog, data):
                        analog.board.still_s = 0.0
                        changed = True
                    analog.received_at_s = at_s
                elif frame_id == self._encoder.frame_id:
                    left, right = self._encoder.unpack(data)
                    left_ticks += left
                    right_ticks += right
                    encoder_frames += 1
                    self._encoder_at_s = at_s
                elif frame_id == self._bumperc.frame_id:
                    self._bumpers = self._bumperc.unpack(data)[0] & self._bumper_mask
                    self._bumpers_at_s = at_s
                elif frame_id == CONTROL_ID:
                    foreign_control += 1
            except InvalidFrameError:
                self._junk += 1
        if len(messages) > error_frames and not bus_off:
            self._bus_state.note_traffic()
        self._foreign_control += foreign_control
        infrared_at_s = min([analog.received_at_s for analog in self._analog.values()])
        self._readings = SensorReadings(
            now_s,
            tuple(self._counts) if changed else self._readings.infrared_counts,
            now_s - infrared_at_s,
            left_ticks,
            right_ticks,
            now_s - self._encoder_at_s,
            self._bumpers,
            now_s - self._bumpers_at_s,
        )
        self._sound_alarms(encoder_frames, foreign_control, bus_off=bus_off, paused=paused)
        return self._readings

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """Ask for wheel speeds in m/s; what is safe by the newest readings goes out in this tick's CONTROL frame."""
        if self.watchdog.ticks_ceased:
            # The loop came back before the watchdog's thread did; its beat must not hide the gap.
            self._guard.emergency_stop(GuardReason.TICKS_CEASED)
        result = self._guard.drive(wanted, self._readings, decided_at_s, now_s)
        self._command = result.wheel_speeds
        self._wheel_watch.set_command(result.wheel_speeds)
        self.watchdog.beat()
        return result

    def emergency_stop(self, reason: GuardReason) -> None:
        """Brake now and stay stopped until `release`."""
        self._guard.emergency_stop(reason)

    def release(self) -> None:
        """End a latched stop; the robot still stands until it is driven. While the bus is lost it stays stopped."""
        if self._bus_lost:
            return  # readings from just before would do for some ticks
        self._alarm = ""
        self._guard.release()

    def close(self) -> None:
        """Brake, end the watchdog and give the bus back."""
        self._closed = True
        self.watchdog.stop()
        self._guard.emergency_stop(GuardReason.CLOSED)
        self._bus.shutdown()

    @property
    def health(self) -> Health:
        """Counters as they stand now."""
        bus = self._bus_state
        return Health(
            frames=self._frames,
            junk=self._junk,
            error_frames=bus.error_frames,
            foreign_control=self._foreign_control,
            send_failures=self._guard.send_failures,
            receive_failures=self._receive_failures,
            bus_trouble=self._receive_trouble or self._guard.bus_trouble,
            controller=bus.controller,
            controller_trouble=bus.trouble,
            alarm=self._alarm,
            latched=self._guard.latched,
        )

    def _sound_alarms(self, encoder_frames: int, foreign_control: int, *, bus_off: bool, paused: bool) -> None:
        """Stop for what the newest readings show.

        `bus_off`: the bus was off since the last ones, if only for a moment. `paused`: the loop neither sensed nor
        drove for long, so the frames of the pause came at once.
        """
        readings = self._readings
        if bus_off or self._bus_state.off:
            self._stop(GuardReason.BUS_OFF)
        if foreign_control:
            self._stop(
                GuardReason.FOREIGN_CONTROL, f"bus {self._bus.name}: another node sends CONTROL; find and end it"
            )
        disobedience = self._wheel_watch.check(
            readings.encoder_left_ticks, readings.encoder_right_ticks, encoder_frames, readings.time_s
        )
        if disobedience:
            self._stop(
                GuardReason.WHEELS_DISOBEY,
                f"{disobedience}; check motors, encoders, cables; switch the robot off and on",
            )
        freeze = self._infrared_watch.check_frozen(readings.time_s, driving=self._command != STANDSTILL and not paused)
        if freeze:
            self._stop(GuardReason.INFRARED_FROZEN, freeze)

    def _stop(self, reason: GuardReason, alarm: str = "") -> None:
        if self._guard.latched is None:  # the first reason stands, and with it what is said about it
            self._alarm = alarm
            self._guard.emergency_stop(reason)

    def _drain(self, now_s: float) -> tuple[list[can.Message], float | None]:
        """Return the waiting frames, and the present on the clock of their time stamps."""
        messages: list[can.Message] = []
        bus_now_s: float | None = None
        try:
            # The clock after the frames, and both or neither: a frame must not look younger than it is.
            messages, bus_now_s = self._bus.drain(), self._bus.now_s()
        except BusError as error:
            self._receive_failures += 1
            if not self._bus_lost:
                self._bus_lost = True
                self._receive_trouble = str(error)
                self._reopen_at_s = now_s + REOPEN_PERIOD_S
                self._guard.emergency_stop(GuardReason.BUS_LOST)
        if self._bus_lost and now_s >= self._reopen_at_s and not self._closed:
            self._reopen(now_s)
        self._frames += len(messages)
        return messages, bus_now_s

    def _reopen(self, now_s: float) -> None:
        """Open the bus again: only this shows that an unplugged adapter is back."""
        self._reopen_at_s = now_s + REOPEN_PERIOD_S
        try:
            self._bus.reopen()
        except BusError as error:
            self._receive_trouble = str(error)
        else:
            self._bus_lost = False
            self._receive_trouble = ""

    def _forget_ages(self) -> None:
        """Forget arrival times after the clock ran backwards, because they would make old frames look new."""
        self._encoder_at_s = self._bumpers_at_s = -math.inf
        for analog in self._analog.values():
            analog.received_at_s = -math.inf

    def _read_analog(self, analog: _AnalogFrame, data: bytes | bytearray) -> bool:
        """Store the frame's distance channels; return whether one changed. Raises InvalidFrameError."""
        raw = analog.codec.unpack(data)
        for at, _ in analog.places:
            # The C167 keeps the channel number in the upper bits (docs/the-robot.md#range-of-a-channel).
            if raw[at] > HIGHEST_COUNTS:
                raise InvalidFrameError(f"{analog.codec.name}: {raw[at]} counts (allowed 0 to {HIGHEST_COUNTS})")
        changed = False
        for at, sensor in analog.places:
            if self._counts[sensor] != raw[at]:
                self._counts[sensor] = raw[at]
                changed = True
        analog.last_payload = data
        return changed


def _analog_frames(channels: tuple[str, ...], codec: Codec, watch: InfraredWatch) -> dict[int, _AnalogFrame]:
    """Return the frames that carry channels of the sensor table, by identifier; channel names are signal names."""
    frames = {}
    for frame_id, message in codec.by_id.items():
        places = tuple((at, channels.index(name)) for at, name in enumerate(message.signals) if name in channels)
        if places:
            board = watch.board_of(channels[places[0][1]])
            frames[frame_id] = _AnalogFrame(message, places, board)
    return frames
