"""Base of every driver: guard, watchdog, alarms and health, whatever link leads to the robot."""

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Final, Protocol

from hal import points
from hal.bus import BusError
from hal.bus_state import ControllerState
from hal.guard import Guard
from hal.guard_reason import GuardReason
from hal.health import Health
from hal.infrared_watch import InfraredWatch
from hal.robot import STANDSTILL, GuardResult, SensorReadings, WheelSpeeds, readings_before_the_first
from hal.robot_settings import RobotSettings
from hal.watchdog import Watchdog
from hal.wheel_port import WheelPort
from hal.wheel_watch import WheelWatch

REOPEN_PERIOD_S = 1.0


class Arrivals:
    """Counters of the messages that one call of `sense` reads."""

    __slots__ = (
        "bumpers",
        "bus_off",
        "fault",
        "foreign_control",
        "infrared_changed",
        "left_ticks",
        "responded_s",
        "right_ticks",
        "turned_s",
    )

    def __init__(self) -> None:
        self.left_ticks = self.right_ticks = self.foreign_control = 0
        self.bumpers = 0
        """Bumpers that any message says are pressed: a touch may begin and end between two calls."""
        self.fault = ""
        """First fault that the robot tells, also if a later message says that it is over."""
        self.turned_s = 0.0
        """Time in s in which the wheels turned by these ticks; 0 if no message tells it."""
        self.responded_s = 0.0
        """Time in s that the wheels had since the previous call to respond to their set points."""
        self.infrared_changed = self.bus_off = False


class CanControllerState(Protocol):
    """Error state of this machine's CAN controller, for the health report (hal.bus_state.BusState)."""

    error_frames: int
    controller: ControllerState

    @property
    def trouble(self) -> str:
        """Fault and remedy in one line; empty while the controller is error-active."""
        ...


class NoCanController:
    """Error state that a robot without CAN reports: always error-active, never in trouble."""

    error_frames = 0
    controller = ControllerState.ACTIVE
    trouble = ""


class GuardedRobot(ABC):
    """Driver (hal.robot.Robot) that owns the guard of its wheels, the watchdog, and the watches that stop the robot.

    A kind of robot adds how its readings arrive. It stores them in `_counts`, and their times in `_times_s`, one for
    each message that carries some. Times are of the runtime's clock, minus infinity before the first.
    """

    foreign_alarm = "another node sends CONTROL; find and end it"
    """Text of the stop for commands of another sender."""

    def __init__(
        self,
        settings: RobotSettings,
        port: WheelPort,
        infrared_watch: InfraredWatch,
        watchdog_clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Drive through `port`, which belongs to the guard alone from then on."""
        self._link_name: Final = port.name
        self._controller: CanControllerState = NoCanController()
        self._guard: Final = Guard(settings, port)
        self.watchdog: Final = Watchdog(self._guard, settings.guard.ticks_ceased_s, watchdog_clock)
        """Watchdog, which the real-time loop starts. `drive` is its beat."""
        self._infrared_watch: Final = infrared_watch
        self._wheel_watch: Final = WheelWatch(settings)
        self._pause_s: Final = settings.guard.ticks_ceased_s
        self._bumper_mask: Final = (1 << len(settings.bumpers)) - 1
        self._counts = [0] * len(settings.infrared.sensors)
        self._times_s: list[float] = []
        self._bumpers = 0
        self._encoder_at_s = self._bumpers_at_s = -math.inf
        self._readings = readings_before_the_first(len(self._counts))
        self._command = STANDSTILL
        self._link_lost = self._closed = False
        self._reopen_at_s = math.inf
        self._frames = self._junk = self._foreign_control = self._receive_failures = 0
        self._receive_trouble = self._alarm = self._fault = self._second_sender = self._notice = ""

    @abstractmethod
    def _receive(self, now_s: float, arrivals: Arrivals) -> None:
        """Take everything that arrived, without waiting, and note it in `arrivals`; a lost link raises nothing."""

    @abstractmethod
    def _reopen_link(self) -> None:
        """Open the link again. Raises hal.bus.BusError while it is still lost."""

    @abstractmethod
    def _close_link(self) -> None:
        """Close the link; may be called twice."""

    def sense(self, now_s: float) -> SensorReadings:
        """Take everything that arrived, without waiting, and return the newest values; `now_s` in s.

        A message is as old as its time stamp says; where the link has no clock it arrived at `now_s`. One with junk in
        it, or from the future, changes nothing, not even its age: a sensor that stays broken becomes stale, and the
        guard stands. A lost link raises nothing; the readings age. Faults that must stop the robot at once do so here.
        """
        paused = now_s - self._readings.time_s > self._pause_s
        if now_s < self._readings.time_s:
            self._forget_ages()
        arrivals = Arrivals()
        self._receive(now_s, arrivals)
        self._foreign_control += arrivals.foreign_control
        self._readings = self._newest(now_s, arrivals)
        self._sound_alarms(arrivals, paused=paused)
        return self._readings

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """Ask for wheel speeds in m/s; times in s. The guard sends the safe part in this tick's message.

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
        """End a latched stop; the robot still stands until it is driven.

        While the link is lost, the robot tells a fault, or a second node sends its readings, it stays stopped.
        """
        if self._link_lost:
            return  # readings from just before would do for some ticks
        self._alarm = ""
        self._guard.release()
        self._stop_for_lasting(self._fault)

    def close(self) -> None:
        """Brake, end the watchdog and close the link; may be called twice."""
        self._closed = True
        self.watchdog.stop()
        self._guard.emergency_stop(GuardReason.CLOSED)
        self._close_link()

    @property
    def health(self) -> Health:
        """Counters as they stand now."""
        controller = self._controller
        return Health(
            frames=self._frames,
            junk=self._junk,
            error_frames=controller.error_frames,
            foreign_control=self._foreign_control,
            send_failures=self._guard.send_failures,
            receive_failures=self._receive_failures,
            bus_trouble=self._receive_trouble or self._guard.bus_trouble,
            controller=controller.controller,
            controller_trouble=controller.trouble,
            alarm=self._alarm,
            latched=self._guard.latched,
            notice=f"{self._link_name}: {self._notice}" if self._notice else "",
        )

    def _sound_alarms(self, arrivals: Arrivals, *, paused: bool) -> None:
        """Stop for what the newest readings show, or for a bus that was off since the ones before, even for a moment.

        `paused`: the loop neither sensed nor drove for long, so the messages of the pause came at once.
        """
        readings = self._readings
        if arrivals.bus_off:
            self._stop(GuardReason.BUS_OFF)
        if arrivals.foreign_control:
            self._stop(GuardReason.FOREIGN_CONTROL, f"{self._link_name}: {self.foreign_alarm}")
        self._stop_for_lasting(arrivals.fault or self._fault)
        disobedience = self._wheel_watch.check(
            readings.encoder_left_ticks,
            readings.encoder_right_ticks,
            arrivals.turned_s,
            arrivals.responded_s,
            readings.time_s,
        )
        if disobedience:
            self._stop(
                GuardReason.WHEELS_DISOBEY,
                f"{disobedience}; check motors, encoders, cables; switch the robot off and on",
            )
        freeze = self._infrared_watch.check_frozen(readings.time_s, driving=self._command != STANDSTILL and not paused)
        if freeze:
            self._stop(GuardReason.INFRARED_FROZEN, freeze)

    def _stop_for_lasting(self, fault: str) -> None:
        """Stop for causes that a release does not end; `fault`: of the robot itself."""
        if self._second_sender:
            sends = f"another node sends {self._second_sender}, too; find and end it"
            self._stop(GuardReason.FOREIGN_TELEMETRY, f"{self._link_name}: {sends}")
        if fault:
            self._stop(GuardReason.ROBOT_FAULT, f"{self._link_name}: the robot tells a fault: {fault}; mend it")

    def _stop(self, reason: GuardReason, alarm: str = "") -> None:
        if self._guard.latched is None:  # the first reason stands, and with it what is said about it
            self._alarm = alarm
            self._guard.emergency_stop(reason)

    def _newest(self, now_s: float, arrivals: Arrivals) -> SensorReadings:
        changed = arrivals.infrared_changed
        return SensorReadings(
            time_s=now_s,
            infrared_counts=tuple(self._counts) if changed else self._readings.infrared_counts,
            infrared_age_s=now_s - min(self._times_s),
            encoder_left_ticks=arrivals.left_ticks,
            encoder_right_ticks=arrivals.right_ticks,
            encoder_age_s=now_s - self._encoder_at_s,
            bumpers=self._bumpers | arrivals.bumpers,
            bumper_age_s=now_s - self._bumpers_at_s if self._bumper_mask else 0.0,  # without bumpers none are missed
        )

    def _lose_link(self, error: BusError, now_s: float) -> None:
        """Count a failure to receive, and stop the robot at the first."""
        self._receive_failures += 1
        if not self._link_lost:
            self._link_lost = True
            self._receive_trouble = str(error)
            self._reopen_at_s = now_s + REOPEN_PERIOD_S
            self._guard.emergency_stop(GuardReason.BUS_LOST)

    def _try_to_reopen(self, now_s: float) -> None:
        """Open a lost link again, once a second: only this shows that an unplugged adapter is back."""
        if not self._link_lost or now_s < self._reopen_at_s or self._closed:
            return
        self._reopen_at_s = now_s + REOPEN_PERIOD_S
        if points.happens("the bus is not back yet"):
            return
        try:
            self._reopen_link()
        except BusError as error:
            self._receive_trouble = str(error)
        else:
            self._link_lost = False
            self._receive_trouble = ""

    def _forget_ages(self) -> None:
        """Forget arrival times after the clock ran backwards, because they would make old messages look new."""
        self._encoder_at_s = self._bumpers_at_s = -math.inf
        self._times_s[:] = [-math.inf] * len(self._times_s)
