"""Witness at both ends of the bus and of every tick: envelope, standing until told, and the ticks' accounts."""

import hashlib
import math
from typing import NamedTuple

from hal.robot import STANDSTILL, Robot, SensorReadings
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import ResultCode
from kurt2rt.core.teaching.commands import Drive, Resume, Stop, Take
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.faulty_sensor import RobotProxy
from kurt2rt.platform.tick_timer import TickTimer
from tests.stories.envelope import Envelope
from tests.stories.rig import Rig
from tests.stories.table import TABLE
from tests.stories.wire import WheelCommand

_ROUNDING_S = 1e-6
_LOOKS_EVERY_S = 0.05
_SLOWNESS = 2.0
_CLOCK_SETTLES_S = 0.1
"""Time after the end of a clock's fault in which it may still jump, back to the truth."""
_STANDS_M_S = 0.02
_ROLLS_OUT_S = 0.6
"""Time after the robot's own watchdog in which wheels come to rest."""


class StandstillInterval(NamedTuple):
    """Time span in which the robot had to stand."""

    from_s: float
    to_s: float


class Witness(RobotProxy):
    """Robot of the tick that sees what the driver sends, what arrives at the robot, and what each tick did."""

    def __init__(self, rig: Rig) -> None:
        self.limits = TABLE.envelopes[rig.ends.wire.robot]
        self.envelope = Envelope(self.limits, rig.ends.wire)
        self.complaints = self.envelope.violations
        """Complaints about envelope, standstill and ticks."""
        self.latched: tuple[float, str] | None = None
        """Time and reason of the guard's first latch since `watch`; None without one."""
        self.drove_at_s: list[float] = []
        """Times of ticks with moving set points since `watch`."""
        self._rig, self._time = rig, rig.time
        self._arrivals: list[tuple[float, WheelCommand]] = []
        self._causes: list[tuple[float, tuple[str, ...]]] = []
        self._watches = False
        self._sensed_at_s = self._clock_faulty_until_s = 0.0
        self._clock_slow_at_s = -math.inf
        self._must_stand = ""
        self._stops = set[str]()
        """Ids of the stops of teachers since the last resume."""
        self._stop_tick = self._newest_press = self._ended_press = -1
        """Tick of the newest stop of a teacher, and ids of hands' presses: the newest, and the newest one before it."""
        self._stopped_by, self._driver = set[str](), ""
        """Teachers who said stop since the last resume and since the last one took the robot, and whose hand drives."""
        self.digest = hashlib.sha256()
        """Of all frames that were sent, and of their times."""
        self._moved_at_s = 0.0
        rig.ends.on_sent, rig.ends.on_arrived = self._on_sent, self._on_arrived
        rig.ends.on_heard = self.envelope.on_heard
        rig.time.every(_LOOKS_EVERY_S, 0.0, self._look_at_the_wheels)

    def begin_program(self, robot: Robot) -> None:
        """Observe the driver of a new program, which must stand until it is resumed."""
        self._robot = robot
        self._must_stand = "the program was started"
        self._stops.clear()
        self._stopped_by.clear()
        self._stop_tick = self._newest_press = self._ended_press = -1
        self.envelope.begin_program()

    def watch(self) -> None:
        """Remember from now on what the robot was told and why, and nothing of before."""
        self._watches, self.latched = True, None
        del self._arrivals[:-1]
        self._causes.clear()
        self.drove_at_s.clear()

    def sense(self, now_s: float) -> SensorReadings:
        """Return the driver's readings; the age of the next decision counts from this call."""
        self._sensed_at_s = self._time.now_s()
        clock = self._rig.injection.of("clock")
        if clock is not None and clock.kind == "slow":
            self._clock_slow_at_s = self._sensed_at_s
        self.envelope.clock_slowness = self.clock_slowness(self.limits.controller_watchdog_s)
        if clock is not None:
            self._clock_faulty_until_s = self._sensed_at_s + _CLOCK_SETTLES_S
        self.envelope.clock_is_faulty = self._sensed_at_s < self._clock_faulty_until_s
        readings = super().sense(now_s)
        self.envelope.bumpers = readings.bumpers
        return readings

    def on_tick(self, record: TickRecord, timer: TickTimer, begun_s: float, period_s: float) -> None:
        """Check a tick of a loop that began at `begun_s` on its own clock."""
        now_s, cause = self._time.now_s(), record.decision.cause
        moves = record.guard_result.wheel_speeds != STANDSTILL
        if moves and not record.decision.driving:
            self._complain(f"drives though {cause}")
        self._note_commands(record)
        # A teacher's hand tells it to drive, until it lets go.
        by_hand = cause is DecisionCause.TEACHER and self._newest_press > self._ended_press
        by_hand = by_hand and self._stopped_by <= {self._driver}
        if moves and self._must_stand and not by_hand:
            self._complain(f"drives though {self._must_stand}, without a resume")
        if record.guard_result.latched:
            self._note_latch(now_s, ", ".join(record.guard_result.reasons) or "stopped for good")
        if timer.ticks + 1 + timer.missed_ticks != record.tick:
            self._complain(f"tick {record.tick}: {timer.ticks + 1} and {timer.missed_ticks} missed are not as many")
        late_s = record.now_s - begun_s - record.tick * period_s
        if not -_ROUNDING_S <= late_s < period_s + _ROUNDING_S and not self.envelope.clock_is_faulty:
            self._complain(f"tick {record.tick} is {late_s:.6f} s off its deadline")
        if self._watches and moves:
            self.drove_at_s.append(now_s)
        elif self._watches:
            # A layer that wants to drive is not why the robot stands.
            self._causes.append((now_s, (*(() if record.decision.driving else (cause,)), *record.guard_result.reasons)))

    def clock_slowness(self, within_s: float) -> float:
        """Return the most seconds that one of the driver's clock took in the last `within_s`."""
        return _SLOWNESS if self._time.now_s() - self._clock_slow_at_s < within_s else 1.0

    def standstills(self, begin_s: float, end_s: float) -> list[StandstillInterval]:
        """Return the spans in which the robot had to stand: it was told to, or its own watchdog had expired."""
        stands: list[StandstillInterval] = []
        state, since_s, heard_at_s = True, 0.0, 0.0
        heard = [(at_s, told.standing) for at_s, told in self._arrivals if at_s < end_s]
        for at_s, standing in (*heard, (end_s, True)):
            if not state and at_s - heard_at_s >= self.limits.controller_watchdog_s:
                state, since_s = True, heard_at_s + self.limits.controller_watchdog_s
            if at_s == end_s:
                break
            if standing != state:
                if state:
                    stands.append(StandstillInterval(since_s, at_s))
                state, since_s = standing, at_s
            heard_at_s = at_s
        if state:
            stands.append(StandstillInterval(since_s, end_s))
        return [StandstillInterval(max(each.from_s, begin_s), each.to_s) for each in stands if each.to_s > begin_s]

    def causes_from(self, time_s: float) -> tuple[str, ...]:
        """Return the causes of the first standstill command from `time_s` on; empty without one."""
        first_s = next((at_s for at_s, _ in self._causes if at_s >= time_s), None)
        return tuple(dict.fromkeys(word for at_s, words in self._causes if at_s == first_s for word in words))

    def slowest_m_s(self, begin_s: float, end_s: float) -> float:
        """Return the slowest set point of a side in a span of time."""
        told = (each for at_s, each in self._arrivals if begin_s <= at_s < end_s)
        return min((min(abs(each.left_m_s), abs(each.right_m_s)) for each in told), default=0.0)

    def _on_sent(self, number: int, payload: bytes) -> None:
        now_s, robot = self._time.now_s(), self._rig.robot
        self.digest.update(payload + round(now_s * 1e6).to_bytes(8, "big"))
        latched = None if robot is None else robot.health.latched
        if latched is not None:
            self._note_latch(now_s, latched)
        self.envelope.on_sent(number, now_s, payload, now_s - self._sensed_at_s, latched=latched is not None)

    def _note_commands(self, record: TickRecord) -> None:
        """Note stops, presses and resumes of a tick."""
        resumed = {each.command_id for each in record.results if each.code is ResultCode.RESUMED}
        for each in record.commands:
            match each:
                case Resume(seen_tick=seen) if each.command_id in resumed:
                    self._must_stand = ""
                    self._stops.clear()
                    self._stopped_by.clear()
                    if seen is not None and seen < self._stop_tick:
                        self._complain("a stop is lifted by a teacher who had not seen it")
                case Stop(press_id=None):
                    self._must_stand = f"{each.teacher} said stop"
                    self._stopped_by.add(each.teacher)
                    self._ended_press = self._newest_press
                    if each.command_id not in self._stops:  # a copy is not a newer one
                        self._stops.add(each.command_id)
                        self._stop_tick = record.tick
                case Take():
                    self._stopped_by &= {each.teacher}
                case Drive(press_id=press_id):
                    self._newest_press, self._driver = max(self._newest_press, press_id), each.teacher

    def _note_latch(self, now_s: float, reason: str) -> None:
        self._must_stand = reason
        if self._watches:
            self.latched = self.latched or (now_s, reason)
            self._causes.append((now_s, (reason,)))

    def _look_at_the_wheels(self) -> None:
        """Complain of wheels that turn though nothing told them to for long; a broken motor or a stranger may."""
        now_s, injection = self._time.now_s(), self._rig.injection
        faults = [injection.of(each) for each in ("left_motor", "right_motor", "serial", "topics")]
        if any(each is not None and (each.kind == "stranger" or "motor" in each.target) for each in faults):
            self._moved_at_s = now_s
        turns = max(abs(each) for each in self._rig.simulation.wheel_speeds) > _STANDS_M_S
        if turns and now_s - self._moved_at_s > self.limits.controller_watchdog_s + _ROLLS_OUT_S:
            self._complain(f"wheels turn {now_s - self._moved_at_s:.1f} s after the last set point")
            self._moved_at_s = now_s

    def _on_arrived(self, number: int, payload: bytes, at_s: float) -> None:
        told = self.envelope.on_arrived(number, at_s, payload)
        if told is not None:
            if not told.standing:
                self._moved_at_s = at_s
            if not self._watches:
                self._arrivals.clear()
            self._arrivals.append((at_s, told))

    def _complain(self, text: str) -> None:
        self.complaints.append(f"at {self._time.now_s():.3f} s: {text}")
