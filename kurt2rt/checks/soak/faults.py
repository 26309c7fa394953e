"""Random faults of a soak and their judgement."""

import random
from collections.abc import Callable
from typing import NamedTuple

from hal.guard_reason import GuardReason
from kurt2rt.checks.faults.complaint import Complaint, ComplaintCode, complaint
from kurt2rt.checks.faults.failing_recorder import FailingRecorder
from kurt2rt.checks.faults.fault_rig import RigDisturbance
from kurt2rt.checks.faults.table import FaultCase, FaultTable, Kind, Target, cases_of
from kurt2rt.checks.soak.disk_list import Spool
from kurt2rt.checks.soak.long_run_rig import SoakRig
from kurt2rt.checks.soak.observer import SoakObserver
from kurt2rt.checks.soak.program_run import ProgramRun

_LEAST_GAP_S = 4.0
_LOOKS_AGAIN_S = 1.0
_SHOWS_M_S = 0.2
_LESSON_EVERY_S = 1.0
_SETTLES_S = 0.3
_HAND_FIRST_S, _SOUND_FIRST_S = 1.0, 0.1


class FaultResult(NamedTuple):
    """Result of one fault."""

    at_s: float
    target: Target
    kind: Kind
    drove: bool
    """True if the robot drove when the fault began."""
    stood_after_s: float | None
    """Time to the first standstill; None without one."""
    latched: str | None
    """Guard's latch reason at the end; None without a latch."""
    complaints: tuple[Complaint, ...] = ()


class SoakFaults:
    """Sequence of single faults, each case of the table equally often."""

    def __init__(self, rig: SoakRig, observer: SoakObserver, table: FaultTable, gap_s: float, seed: int) -> None:
        self.results: Spool[FaultResult] = Spool()
        self.may_end_program = False
        """True if the active fault may end the program."""
        self.acting: FaultCase | None = None
        self.acts_until_s = 0.0
        """End of the newest fault."""
        self.program: ProgramRun | None = None
        """Running program; None between two starts."""
        self._rig, self._observer, self._table = rig, observer, table
        self._gap_s = gap_s
        self._chance = random.Random(f"faults, seed {seed}")
        self._deck: list[FaultCase] = []
        self._disturbance: RigDisturbance | None = None
        self._recorder: FailingRecorder | None = None
        self._newest: FaultResult | None = None
        self._drove = False
        self._old_frames = self._resumes = 0
        self._faulty_program: ProgramRun | None = None
        self._plan()

    def _plan(self) -> None:
        gap_s = _LEAST_GAP_S + self._chance.expovariate(1.0 / self._gap_s)
        self._rig.time.at(self._rig.time.now_s() + gap_s, self._begin)

    def _begin(self) -> None:
        time, program = self._rig.time, self.program
        if program is None or not program.ready:
            time.at(time.now_s() + _LOOKS_AGAIN_S, self._begin)
            return
        if not self._deck:
            self._deck = list(cases_of(self._table))
            self._chance.shuffle(self._deck)
        case = self.acting = self._deck.pop()
        must, now_s = case.must, time.now_s()
        # A repeated message must have been received once, and manual driving must have begun before its link fails.
        begin_s = now_s + (_HAND_FIRST_S if case.target == "teacher_link" else _SOUND_FIRST_S)
        end_s = begin_s + (must.lasts_s or self._table.schedule.lasts_s)
        self.acts_until_s = end_s
        self._old_frames, self._resumes = self._observer.envelope.old_frames, self._observer.resumes
        self._observer.clock_is_faulty = case.target == "clock"
        time.at(begin_s, self._note_driving)
        self._faulty_program = program
        self.may_end_program = must.ends_by == "restart"
        self._observer.envelope.slew_share = must.slew_share
        self._observer.envelope.clock_is_faulty = case.target == "clock"
        disturbance = self._disturbance = self._rig.begin(
            case.target, case.kind, begin_s=begin_s, end_s=end_s, period_s=must.period_s, delay_s=must.delay_s
        )
        match case.target:
            case "clock":
                program.clock.disturb(disturbance)
            case "tick":
                program.level.disturb(disturbance)
            case "disk":
                program.knowledge.disturb(disturbance)
                # A disk that comes and goes is to be met in both.
                every_s = min(_LESSON_EVERY_S, must.period_s or _LESSON_EVERY_S)
                for number in range(int((end_s - begin_s) / every_s)):
                    time.at(begin_s + number * every_s, self._on_program(ProgramRun.repeat_known_lesson))
            case "recorder":
                self._recorder = FailingRecorder(time, disturbance)
                self._rig.attach_tap(self._recorder)
            case "teacher_link":
                program.take_manual_control(disturbance)
        if must.stop_said_after_s is not None:
            time.at(begin_s + must.stop_said_after_s, self._on_program(ProgramRun.stop))
        time.at(end_s, self._judge)
        time.at(end_s + _SETTLES_S, self._end)

    def _note_driving(self) -> None:
        self._drove = not self._observer.stands
        self._observer.watch_for_standstill()

    def _on_program(self, act: Callable[[ProgramRun], None]) -> Callable[[], None]:
        def do() -> None:
            if self.program is not None and self.program is self._faulty_program:
                act(self.program)

        return do

    def _judge(self) -> None:
        """Judge the fault at its end."""
        case, robot, observer = self.acting, self._rig.robot, self._observer
        assert case is not None
        assert self._disturbance is not None
        begin_s = self._disturbance.begin_s
        stood_at_s = observer.first_standstill_s()
        complaints: list[Complaint] = []
        # A robot that stood already shows nothing. One that is told to drive on by a teacher who has not seen what is
        # wrong may try again, and may put as many old set points into a queue that is blocked as the first time.
        # And wheels show only at some speed whether they obey: in a narrow curve one side nearly stands.
        shows = GuardReason.WHEELS_DISOBEY not in case.must.words or observer.slowest_m_s >= _SHOWS_M_S
        if case.must.leads_to == "stands" and self._drove and stood_at_s is None and shows:
            complaints.append(complaint(ComplaintCode.DROVE_ALL_THE_WHILE))
        old_frames = observer.envelope.old_frames - self._old_frames
        allowed = case.must.old_frames * (1 + observer.resumes - self._resumes)
        if old_frames > allowed and self.program is self._faulty_program:
            complaints.append(complaint(ComplaintCode.OLD_FRAMES, frames=old_frames, allowed=allowed))
        self._newest = FaultResult(
            at_s=begin_s,
            target=case.target,
            kind=case.kind,
            drove=self._drove,
            stood_after_s=None if stood_at_s is None else max(0.0, stood_at_s - begin_s),
            latched=None if robot is None else robot.health.latched,
            complaints=tuple(complaints),
        )

    def _end(self) -> None:
        case, program, seen = self.acting, self.program, self._newest
        assert case is not None
        assert seen is not None
        self._rig.end()
        self._observer.envelope.slew_share = 1.0
        self._observer.envelope.clock_is_faulty = False
        self._observer.clock_is_faulty = False
        if self._recorder is not None:
            self._rig.attach_tap(None)
            self._recorder.close()
            uncounted = self._recorder.uncounted_frames()
            if uncounted is not None:
                seen = seen._replace(complaints=(uncounted,))
            self._recorder = None
        self.results.append(seen)
        if program is not None and program is self._faulty_program:
            program.clear(case.target)
        self.acting = self._disturbance = self._faulty_program = None
        self.may_end_program = False
        self._plan()
