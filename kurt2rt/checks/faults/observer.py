"""Observer of a fault scenario at both ends of the bus."""

from typing import NamedTuple

from hal.robot import STANDSTILL
from kurt2rt.checks.faults.bus_observer import BusObserver
from kurt2rt.checks.faults.complaint import ComplaintCode, complaint
from kurt2rt.checks.faults.envelope import Envelope
from kurt2rt.checks.faults.fault_rig import FaultRig
from kurt2rt.core.tick_record import TickRecord


class Stand(NamedTuple):
    """Time span in which the robot had to stand."""

    from_s: float
    to_s: float


class WheelObserver(BusObserver):
    """Observer of both ends of the bus."""

    def __init__(self, rig: FaultRig, envelope: Envelope, controller_watchdog_s: float) -> None:
        super().__init__(rig, envelope)
        self.attach(rig.robot)
        self.latched: tuple[float, str] | None = None
        """Time and reason of the guard's first latch; None without one."""
        self.drove_at_s: list[float] = []
        """Times of ticks with moving set points."""
        self._begin_s = rig.disturbance.begin_s
        self._controller_watchdog_s = controller_watchdog_s
        self._arrivals: list[tuple[float, bool]] = []
        self._causes: list[tuple[float, tuple[str, ...]]] = []
        rig.on_control = self._on_arrival

    def on_tick(self, record: TickRecord) -> None:
        """Record the set points of a tick, or the causes of its standstill; call it after each tick."""
        now_s = self._time.now_s()
        if record.guard_result.wheel_speeds != STANDSTILL:
            self.drove_at_s.append(now_s)
            if not record.decision.driving:
                drove = complaint(ComplaintCode.DROVE_THOUGH, now_s, cause=record.decision.cause)
                self.envelope.violations.append(drove)
        else:
            # A layer that wants to drive is not why the robot stands.
            cause = () if record.decision.driving else (str(record.decision.cause),)
            self._causes.append((now_s, (*cause, *record.guard_result.reasons)))

    def standstills(self, begin_s: float, end_s: float) -> list[Stand]:
        """Return the spans from `begin_s` to `end_s`, in s, in which the robot had to stand.

        It was commanded to, or its own watchdog had expired.
        """
        stands: list[Stand] = []
        state, since_s, heard_at_s = True, 0.0, 0.0
        heard = [each for each in self._arrivals if each[0] < end_s]
        for at_s, standing in (*heard, (end_s, True)):
            if not state and at_s - heard_at_s >= self._controller_watchdog_s:
                state, since_s = True, heard_at_s + self._controller_watchdog_s
            if at_s == end_s:
                break
            if standing != state:
                if state:
                    stands.append(Stand(since_s, at_s))
                state, since_s = standing, at_s
            heard_at_s = at_s
        if state:
            stands.append(Stand(since_s, end_s))
        return [Stand(max(each.from_s, begin_s), each.to_s) for each in stands if each.to_s > begin_s]

    def causes_from(self, time_s: float) -> tuple[str, ...]:
        """Return the causes of the first standstill command from `time_s` on, in s; empty without one."""
        first_s = next((at_s for at_s, _ in self._causes if at_s >= time_s), None)
        return tuple(dict.fromkeys(word for at_s, words in self._causes if at_s == first_s for word in words))

    def _on_sent(self, number: int, payload: bytes) -> None:
        now_s, robot = self._time.now_s(), self._rig.robot
        latched = None if robot is None else robot.health.latched
        if latched is not None:
            if self.latched is None and now_s >= self._begin_s:
                self.latched = (now_s, latched)
            self._causes.append((now_s, (latched,)))
        super()._on_sent(number, payload)

    def _on_arrival(self, number: int, payload: bytes) -> None:
        now_s = self._time.now_s()
        told = self.envelope.on_arrived(number, now_s, payload)
        if told is not None:
            self._arrivals.append((now_s, told.standing))
