"""KURT2 on its CAN bus: frames become SensorReadings, and every set point passes the guard."""

import math
import time
from collections.abc import Callable
from typing import Final

import can

from hal.bus import CONTROL_ID, BusError, CanBus
from hal.bus_state import BusState
from hal.codec import InvalidFrameError, load_codec
from hal.guard import Guard
from hal.guard_reason import GuardReason
from hal.health import Health
from hal.infrared_frames import FrameBatch, FrameReader, InfraredCounts, infrared_frames
from hal.infrared_watch import InfraredWatch
from hal.robot import STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from hal.robot_settings import RobotSettings
from hal.watchdog import Watchdog
from hal.wheel_watch import WheelWatch

REOPEN_PERIOD_S = 1.0
_CLOCKS_DIFFER_S = 0.01
"""A frame that is stamped later than this after the present has no age: the wall clock was set back, or worse."""


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
        self._infrared = InfraredCounts(len(channels))
        analog = infrared_frames(channels, codec, self._infrared_watch, self._infrared)
        self._encoder = codec.message("ENCODER")
        self._bumperc = codec.message("BUMPERC")
        self._bumper_mask = (1 << len(settings.bumpers)) - 1
        self._readers: dict[int, FrameReader] = {frame.codec.frame_id: frame.read for frame in analog}
        self._readers |= {self._encoder.frame_id: self._read_encoder, self._bumperc.frame_id: self._read_bumpers}
        self._bumpers = 0
        self._bumper_payload: bytes | bytearray = b""
        self._encoder_at_s = self._bumpers_at_s = -math.inf
        self._readings = SensorReadings(
            time_s=-math.inf,
            infrared_counts=tuple(self._infrared.counts),
            infrared_age_s=math.inf,
            encoder_left_ticks=0,
            encoder_right_ticks=0,
            encoder_age_s=math.inf,
            bumpers=0,
            bumper_age_s=math.inf,
        )
        self._command = STANDSTILL
        self._bus_lost = self._closed = False
        self._reopen_at_s = math.inf
        self._frames = self._junk = self._foreign_control = self._receive_failures = 0
        self._receive_trouble = self._alarm = ""
        # CONTROL as well: a second sender of it must not go unnoticed.
        bus.set_id_filter({CONTROL_ID, *self._readers})

    def sense(self, now_s: float) -> SensorReadings:
        """Take everything that arrived, without waiting, and return the newest values; `now_s` in s.

        A frame is as old as its time stamp says; where the bus has no clock it arrived at `now_s`. A frame with junk in
        it, or from the future, changes nothing, not even its age: a channel that stays broken becomes stale, and the
        guard stands. A lost bus raises nothing; the readings age. Faults that must stop the robot at once do so in this
        call.
        """
        messages, bus_now_s = self._drain(now_s)
        paused = now_s - self._readings.time_s > self._pause_s
        if now_s < self._readings.time_s:
            self._forget_ages()
        batch = FrameBatch()
        self._read(messages, bus_now_s, now_s, batch)
        self._foreign_control += batch.foreign_control
        self._readings = self._newest(now_s, batch)
        self._sound_alarms(batch, paused=paused)
        return self._readings

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """Ask for wheel speeds in m/s; times in s. The guard sends the safe part in this tick's CONTROL frame.

        Call it once per tick after `sense`, because the call is the watchdog's beat.
        """
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
        """Brake, end the watchdog and close the bus; may be called twice."""
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

    def _sound_alarms(self, batch: FrameBatch, *, paused: bool) -> None:
        """Stop for what the newest readings show, or for a bus that was off since the ones before, even for a moment.

        `paused`: the loop neither sensed nor drove for long, so the frames of the pause came at once.
        """
        readings = self._readings
        if batch.bus_off or self._bus_state.off:
            self._stop(GuardReason.BUS_OFF)
        if batch.foreign_control:
            self._stop(
                GuardReason.FOREIGN_CONTROL, f"bus {self._bus.name}: another node sends CONTROL; find and end it"
            )
        disobedience = self._wheel_watch.check(
            readings.encoder_left_ticks, readings.encoder_right_ticks, batch.encoder_frames, readings.time_s
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

    def _read(self, messages: list[can.Message], bus_now_s: float | None, now_s: float, batch: FrameBatch) -> None:
        """Read waiting frames in order; `bus_now_s`: the present on the clock of their time stamps, None without."""
        error_frames, readers = 0, self._readers
        for message in messages:
            if message.is_error_frame:
                error_frames += 1
                self._bus_state.note(message)
                batch.bus_off = batch.bus_off or self._bus_state.off
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
                    reader(message.data, at_s, batch)
                elif frame_id == CONTROL_ID:
                    batch.foreign_control += 1
            except InvalidFrameError:
                self._junk += 1
        if len(messages) > error_frames and not batch.bus_off:
            self._bus_state.note_traffic()

    def _read_encoder(self, data: bytes | bytearray, at_s: float, batch: FrameBatch) -> None:
        left, right = self._encoder.unpack(data)
        batch.left_ticks += left
        batch.right_ticks += right
        batch.encoder_frames += 1
        self._encoder_at_s = at_s

    def _read_bumpers(self, data: bytes | bytearray, at_s: float, batch: FrameBatch) -> None:  # noqa: ARG002 - FrameReader
        if data != self._bumper_payload:
            self._bumpers = self._bumperc.unpack(data)[0] & self._bumper_mask
            self._bumper_payload = data
        self._bumpers_at_s = at_s

    def _newest(self, now_s: float, batch: FrameBatch) -> SensorReadings:
        return SensorReadings(
            time_s=now_s,
            infrared_counts=tuple(self._infrared.counts) if batch.infrared_changed else self._readings.infrared_counts,
            infrared_age_s=now_s - min(self._infrared.times_s),
            encoder_left_ticks=batch.left_ticks,
            encoder_right_ticks=batch.right_ticks,
            encoder_age_s=now_s - self._encoder_at_s,
            bumpers=self._bumpers,
            bumper_age_s=now_s - self._bumpers_at_s,
        )

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
        self._infrared.times_s[:] = [-math.inf] * len(self._infrared.times_s)
