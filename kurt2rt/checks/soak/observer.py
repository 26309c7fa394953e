"""Observer of every tick of a soak at both ends of the bus: envelope, standstill, tick accounting, odometry."""

import math

from hal.robot import STANDSTILL, Robot, SensorReadings
from kurt2rt.checks.faults.bus_observer import BusObserver
from kurt2rt.checks.faults.complaint import Complaint, ComplaintCode, complaint
from kurt2rt.checks.faults.envelope import Envelope
from kurt2rt.checks.faults.table import EnvelopeSettings
from kurt2rt.checks.soak.long_run_rig import SoakRig
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.teaching.commands import Resume
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.ledger import TickTimer

_MOST_TOLD = 200
"""Complaints that are stored."""
_ROUNDING_S = 1e-6


class Complaints:
    """Counter of complaints that stores the first ones."""

    def __init__(self) -> None:
        self.count = 0
        self.stored: list[Complaint] = []

    def add(self, found: Complaint) -> None:
        """Count a complaint; store it while there are few."""
        self.count += 1
        if len(self.stored) < _MOST_TOLD:
            self.stored.append(found)


class OdometryCheck:
    """Comparison of encoder ticks and true wheel rotation each minute; skipped after a fault or a repositioning."""

    def __init__(self, rig: SoakRig, metres_per_tick: float) -> None:
        self.worst_m = 0.0
        """Largest difference of a side in one interval."""
        self._rig = rig
        self._metres_per_tick = metres_per_tick
        self._ticks = [0, 0]
        self._turned_m = [0.0, 0.0]
        self._valid = False

    def on_tick(self, readings: SensorReadings) -> None:
        """Add a tick's encoder counts."""
        self._ticks[0] += readings.encoder_left_ticks
        self._ticks[1] += readings.encoder_right_ticks

    def invalidate(self) -> None:
        """Skip the next comparison, because a fault or a repositioning made it meaningless."""
        self._valid = False

    def compare(self) -> None:
        """Compare encoder ticks and true rotation since the last call, and begin the next interval.

        The largest difference goes to `worst_m`.
        """
        if self._valid:
            for ticks, turned_m, before_m in zip(self._ticks, self._rig.turned_m, self._turned_m, strict=True):
                self.worst_m = max(self.worst_m, abs(ticks * self._metres_per_tick - (turned_m - before_m)))
        self._ticks = [0, 0]
        self._turned_m = list(self._rig.turned_m)
        self._valid = True


class SoakObserver(BusObserver):
    """Observer of sent and received frames and of tick records."""

    def __init__(self, rig: SoakRig, limits: EnvelopeSettings) -> None:
        super().__init__(rig, Envelope(limits))
        self.complaints = Complaints()
        """Complaints about envelope, standstill and tick accounting."""
        self.ticks = self.missed_ticks = 0
        """Ticks of all starts."""
        self.late_s = 0.0
        """Lateness of the newest tick on the program's clock."""
        self.resumes = 0
        """Accepted commands to resume."""
        self.clock_is_faulty = False
        """True while the program's clock fails; deadlines are not judged then."""
        self._limits = limits
        self._told_standing = True
        self.stood_at_s: float | None = None
        self.slowest_m_s = 0.0
        """Slowest set point of a side since `watch_for_standstill`."""
        self._heard_at_s = 0.0
        self._must_stand = ""
        self._period_s = 0.0
        rig.on_control = self._on_arrival

    def begin_program(self, robot: Robot, period_s: float) -> None:
        """Observe the driver `robot` of a restarted program, which must stand until it is resumed.

        `period_s`: of its ticks, in s.
        """
        self.attach(robot)
        self._period_s = period_s
        self._must_stand = "the program was started"

    def on_tick(self, record: TickRecord, ledger: TickTimer, begun_s: float) -> None:
        """Check a tick; violations are added to the complaints.

        `ledger`: lateness and missed ticks. `begun_s`: start of the program's loop on its own clock, in s.
        """
        now_s = self._time.now_s()
        moves = record.guard_result.wheel_speeds != STANDSTILL
        if moves and not record.decision.driving:
            self.complaints.add(complaint(ComplaintCode.DROVE_THOUGH, now_s, cause=record.decision.cause))
        accepted = {result.command_id for result in record.results if result.accepted}
        if any(isinstance(each, Resume) and each.command_id in accepted for each in record.commands):
            self._must_stand = ""
            self.resumes += 1
        # A teacher's hand tells it to drive, until it lets go.
        if moves and self._must_stand and record.decision.cause is not DecisionCause.TEACHER:
            self.complaints.add(complaint(ComplaintCode.DROVE_UNTOLD, now_s, must_stand=self._must_stand))
        if record.guard_result.latched:
            self._must_stand = ", ".join(record.guard_result.reasons) or "stopped for good"
        if ledger.ticks + 1 + ledger.missed_ticks != record.tick:
            done, missed = ledger.ticks + 1, ledger.missed_ticks
            code = ComplaintCode.TICKS_UNACCOUNTED
            self.complaints.add(complaint(code, now_s, tick=record.tick, done=done, missed=missed))
        late_s = self.late_s = record.now_s - begun_s - record.tick * self._period_s
        if not -_ROUNDING_S <= late_s < self._period_s + _ROUNDING_S and not self.clock_is_faulty:
            self.complaints.add(complaint(ComplaintCode.OFF_DEADLINE, now_s, tick=record.tick, late_s=late_s))
        for each in self.envelope.violations:
            self.complaints.add(each)
        self.envelope.violations.clear()

    @property
    def stands(self) -> bool:
        """Return whether the robot must stand: it was commanded to, or receives nothing."""
        return self._told_standing or self._silent

    def watch_for_standstill(self) -> None:
        """Watch for the next standstill, which `first_standstill_s` then returns."""
        self.stood_at_s = None
        self.slowest_m_s = math.inf

    def first_standstill_s(self) -> float | None:
        """Return the time in s of the first standstill since `watch_for_standstill`; None without one."""
        if self.stood_at_s is None and self._silent:
            return self._heard_at_s + self._limits.controller_watchdog_s
        return self.stood_at_s

    @property
    def _silent(self) -> bool:
        return self._time.now_s() - self._heard_at_s >= self._limits.controller_watchdog_s

    def sense(self, now_s: float) -> SensorReadings:
        """Read the sensors; a pressed bumper allows a wheel to turn round at once."""
        readings = super().sense(now_s)
        self.envelope.bumper_pressed = readings.bumpers != 0
        return readings

    def _on_arrival(self, number: int, payload: bytes, at_s: float) -> None:
        told = self.envelope.on_arrived(number, at_s, payload)
        if told is None:
            return
        if self.stood_at_s is None:
            silent_until_s = self._heard_at_s + self._limits.controller_watchdog_s
            if silent_until_s <= at_s:
                self.stood_at_s = silent_until_s
            elif told.standing:
                self.stood_at_s = at_s
        self._told_standing = told.standing
        self.slowest_m_s = min(self.slowest_m_s, abs(told.left_m_s), abs(told.right_m_s))
        self._heard_at_s = at_s
