"""Guard: the only sender of set points. It applies what is safe of each request, from any source."""

import math
from threading import RLock

from hal.bus import BusError
from hal.guard_limits import REASONS, limited, limits_of
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from hal.robot_settings import RobotSettings
from hal.wheel_port import WheelPort

_UNCONFIRMED = 2
"""Own messages not yet carried by the link. A set point behind two of them reaches the motors after 20 ms or more.
A brake is never too old."""


class Guard:
    """Only sender of set points: applies what is safe of the wanted wheel speeds, and brakes on request.

    It limits speed and acceleration, blocks the way of a pressed bumper, and stands for old readings or commands.
    A trouble of the link latches it until `release`. Thread safe: watchdog and signal handlers call `emergency_stop`.

    Every rule demands proof that driving is safe, so a NaN in any input stops the robot.
    """

    def __init__(self, robot: RobotSettings, port: WheelPort) -> None:
        """Send through `port`, which belongs to this guard alone from now on."""
        limits = robot.guard
        self._port = port
        self._limits = limits_of(robot)
        self._command_age_s = limits.command_age_s
        self._stale_infrared_s = limits.stale_infrared_s
        self._stale_encoder_s = limits.stale_encoder_s
        # A robot without bumpers need not report them.
        self._stale_bumper_s = limits.stale_bumper_s if robot.bumpers else math.inf
        # Reentrant, because a signal handler may stop the robot during the same thread's drive().
        self._lock = RLock()
        self._latched: GuardReason | None = None
        self._left_m_s = self._right_m_s = 0.0
        # Most ticks repeat the last command.
        self._last_wanted = STANDSTILL
        self._last_command = port.command(STANDSTILL)
        self._driven_at_s = -math.inf
        self._send_failures = 0
        self._bus_trouble = ""

    @property
    def latched(self) -> GuardReason | None:
        """Reason that the robot stays stopped until `release`; None if it does not."""
        return self._latched

    @property
    def send_failures(self) -> int:
        """Messages that the link did not take."""
        return self._send_failures

    @property
    def bus_trouble(self) -> str:
        """Text of the newest sending error; empty if there was none since the last release."""
        return self._bus_trouble

    def drive(self, wanted: WheelSpeeds, readings: SensorReadings, decided_at_s: float, now_s: float) -> GuardResult:
        """Send one message with what is safe of `wanted`; speeds in m/s, times in s on the runtime's clock.

        Returns the applied speeds, which are those in the message, truncated to its resolution, and the reasons for
        other differences. No set point is queued after messages that the link has not carried yet; a brake is. A link
        that fails raises nothing: the guard brakes and stays stopped.
        """
        with self._lock:
            if self._latched is None and self._port.unconfirmed >= _UNCONFIRMED:
                self._bus_trouble = f"{self._port.name}: frames are not carried; {self._port.remedy}"
                self._latch(GuardReason.BUS_BLOCKED)
            if self._latched is not None:
                return self._stay_stopped(self._latched)
            left_m_s, right_m_s = wanted
            stand = self._reason_to_stand(left_m_s, right_m_s, readings, decided_at_s, now_s)
            if stand is None:
                reasons = self._limit((left_m_s, right_m_s), readings.bumpers, now_s)
            else:
                reasons = (stand,)
                self._left_m_s = self._right_m_s = 0.0
            if math.isfinite(now_s):
                self._driven_at_s = now_s
            if self._last_wanted.left_m_s != self._left_m_s or self._last_wanted.right_m_s != self._right_m_s:
                self._last_wanted = WheelSpeeds(self._left_m_s, self._right_m_s)
                self._last_command = self._port.command(self._last_wanted)
            command = self._last_command
            try:
                self._port.send(command.message)
            except BusError as error:
                self._note(error)
                self._latch(GuardReason.BUS_LOST)
            if self._latched is not None:  # by the bus, or by a signal handler while this message was sent
                return self._stay_stopped(self._latched)
            return GuardResult(command.applied, reasons, latched=False)

    def emergency_stop(self, reason: GuardReason) -> None:
        """Brake now and stay stopped until `release`; the first reason stands. May be repeated, never raises."""
        with self._lock:
            self._latch(reason)
            self._send_brake()

    def release(self) -> None:
        """End a latched stop; the robot stands until it is driven, and starts from a speed of 0."""
        with self._lock:
            if self._latched == GuardReason.BUS_BLOCKED:
                # Frames that were lost on the way out would count as yet to be carried for ever.
                self._port.forget_unconfirmed()
            self._latched = None
            self._bus_trouble = ""

    def _reason_to_stand(
        self, left_m_s: float, right_m_s: float, readings: SensorReadings, decided_at_s: float, now_s: float
    ) -> GuardReason | None:
        if not (math.isfinite(left_m_s) and math.isfinite(right_m_s)):
            return GuardReason.NOT_A_NUMBER
        sensed_ago_s = now_s - readings.time_s
        decided_ago_s = now_s - decided_at_s
        if not (now_s >= self._driven_at_s and sensed_ago_s >= 0.0 and decided_ago_s >= 0.0):
            return GuardReason.CLOCK_RAN_BACKWARDS
        if not decided_ago_s <= self._command_age_s:
            return GuardReason.COMMAND_TOO_OLD
        # Nor is a frame from after the readings a fresh one.
        if not sensed_ago_s <= sensed_ago_s + readings.infrared_age_s <= self._stale_infrared_s:
            return GuardReason.INFRARED_STALE
        if not sensed_ago_s <= sensed_ago_s + readings.encoder_age_s <= self._stale_encoder_s:
            return GuardReason.ENCODER_STALE
        if not sensed_ago_s <= sensed_ago_s + readings.bumper_age_s <= self._stale_bumper_s:
            return GuardReason.BUMPER_STALE
        return None

    def _limit(self, wanted: tuple[float, float], bumpers: int, now_s: float) -> tuple[GuardReason, ...]:
        """Move the set points toward the wanted speeds within the limits; return the limits that were met."""
        present, elapsed_s = (self._left_m_s, self._right_m_s), now_s - self._driven_at_s
        self._left_m_s, self._right_m_s, met = limited(wanted, present, bumpers, elapsed_s, self._limits)
        return REASONS[met]

    def _latch(self, reason: GuardReason) -> None:
        if self._latched is None:
            self._latched = reason
        self._left_m_s = self._right_m_s = 0.0

    def _stay_stopped(self, reason: GuardReason) -> GuardResult:
        self._left_m_s = self._right_m_s = 0.0  # again, for the stop may have come in the middle of an approach
        self._send_brake()
        return GuardResult(STANDSTILL, (reason,), latched=True)

    def _send_brake(self) -> None:
        try:
            self._port.send(self._port.brake)
        except BusError as error:
            self._note(error)

    def _note(self, error: BusError) -> None:
        self._send_failures += 1
        self._bus_trouble = str(error)
