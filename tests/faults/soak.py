"""Simulated hours in which everything fails: starts of the program, faults and a teacher's moods in sequence."""

import ctypes
import random
import threading
from pathlib import Path
from typing import NamedTuple

import psutil

from hal.guard_reason import GuardReason
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TeacherSettings
from kurt2rt.core.teaching.commands import (
    Appraise,
    BeginSession,
    Command,
    Correct,
    Resume,
    Reward,
    SetPhase,
    Stop,
    Take,
    Undo,
    Watch,
)
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.teacher.scripted.basic_teacher import view_of_tick
from kurt2rt.teacher.scripted.teacher import ScriptedTeacher
from simbridge.worlds.world_loading import load_world
from tests.faults.cable import SOUND, CableFaults
from tests.faults.fault import Fault
from tests.faults.program import TASK, TEACHER, Program
from tests.faults.rig import ROBOT, Rig
from tests.faults.table import CASES, TABLE, Case
from tests.faults.witness import Witness

MINUTE_S = 60.0
_LEAST_GAP_S = 3.0
"""Least time from a start or a fault to the next fault: a robot driven by hand is given back meanwhile."""
_HAND_FIRST_S, _SOUND_FIRST_S = 1.0, 0.1
"""A hand drives, and each message has arrived once, before it fails."""
_DOWN_S = (0.5, 3.0)
_CABLES = (SOUND, CableFaults(delay_s=0.002), CableFaults(lost=0.1))
_SHARES = (0.75, 0.15, 0.1)
"""Share of the starts on each cable."""
_SHOWS_M_S = 0.2
"""Slowest set point that shows whether wheels obey: in a narrow curve one side nearly stands."""

_REACTION_S = 1.0
_AWAY = 0.1
"""Share of the minutes in which the teacher is away."""
_MOST_CORRECTIONS = 100
"""Corrections of one start: lessons take memory, and more of them would hide what else grows."""
_STOPS_EVERY_S, _UNDOES_EVERY_S, _SIGNALS_EVERY_S = 45.0, 180.0, 20.0
_TAKES_EVERY_TICKS = 20


class Minute(NamedTuple):
    """Use of the machine by this process."""

    resident_mb: float
    open_files: int
    threads: int


class _Teacher:
    """Scripted teacher of one start: answers, corrects, praises, errs, stops, takes lessons back, goes away."""

    def __init__(self, program: Program, chance: random.Random) -> None:
        self._program, self._chance = program, chance
        self._phase = Phase(chance.choice((2, 2, 3, 4, 5)))
        self._scripted = ScriptedTeacher(
            TASK.policy.build(ROBOT.infrared),
            tuple(load_task_repertoire(TASK, ROBOT)),
            TeacherSettings(reaction_s=_REACTION_S, patience_s=0.3, error_rate=0.05),
            period_s=ROBOT.cycle_s,
            seed=chance.getrandbits(32),
            session=program.next_id(),
        )
        self._scripted.phase = self._phase
        self._appraisals = tuple(load_critic(TASK.critic).values)
        self._corrections = self._stopped_ticks = 0
        self._is_there = True

    def __call__(self, record: TickRecord) -> list[Command]:
        if record.tick % round(MINUTE_S / ROBOT.cycle_s) == 0:
            self._is_there = self._chance.random() > _AWAY
        if not self._is_there or self._program.hand is not None:
            return []
        return [Watch(TEACHER, record.tick), *self._commands(record)]

    def _commands(self, record: TickRecord) -> list[Command]:
        identity, chance = self._program.next_id(), self._chance
        if self._program.runtime.handler.authority.teacher not in (None, TEACHER):
            return [Take(identity, TEACHER)] if record.tick % _TAKES_EVERY_TICKS == 0 else []
        if record.number == 1:
            return [BeginSession(identity, TEACHER, identity), SetPhase(f"{identity}-phase", TEACHER, self._phase)]
        if record.guard_result.latched or record.decision.cause is DecisionCause.STOPPED:
            self._stopped_ticks += 1
            return [Resume(identity, TEACHER, record.tick)] if self._is_due(_REACTION_S) else []
        self._stopped_ticks = 0
        if self._happens(_STOPS_EVERY_S):
            return [Stop(identity, TEACHER)]
        if self._happens(_UNDOES_EVERY_S):
            return [Undo(identity, TEACHER)]
        if self._phase == Phase(3) and record.decision.driving and self._happens(_SIGNALS_EVERY_S):
            return [Reward(identity, TEACHER, chance.choice((1, 1, -1)), record.tick)]
        if self._phase == Phase(4) and self._happens(_SIGNALS_EVERY_S):
            return [Appraise(identity, TEACHER, chance.choice(self._appraisals), record.tick)]
        view = view_of_tick(record)
        if not view.asking and self._corrections >= _MOST_CORRECTIONS:
            return []  # he looks on
        command = self._scripted.update(view)
        self._corrections += isinstance(command, Correct)
        return [] if command is None else [command]

    def _is_due(self, period_s: float) -> bool:
        return self._stopped_ticks % round(period_s / ROBOT.cycle_s) == 0

    def _happens(self, every_s: float) -> bool:
        return self._chance.random() < ROBOT.cycle_s / every_s


class Soak:
    """One soak: `run` it, then look at what was seen."""

    def __init__(self, folder: Path, seed: int, *, lives_s: tuple[float, float], fault_gap_s: float) -> None:
        """`lives_s`: bounds of the time from a start of the program to its end. `fault_gap_s`: mean, between faults."""
        self.minutes: list[Minute] = []
        self.tried: list[tuple[Case, bool]] = []
        """Cases, and whether the robot drove when they began."""
        self.ticks = self.starts = self.most_waiting = self.lessons = 0
        self.complaints: list[str] = []
        self._folder, self._lives_s, self._gap_s = folder, lives_s, fault_gap_s
        self._chance = random.Random(f"soak {seed}")
        self.rig = Rig(ROBOT, load_world("a", ROBOT), self._chance)
        self._time = self.rig.time
        self.witness = Witness(self.rig)
        self._program: Program
        self._teacher: _Teacher
        self._deck: list[Case] = []
        self._case: Case
        self._fault: Fault | None = None
        self._next_fault_s = self._next_minute_s = 0.0
        self._old_frames = self._resumes = 0

    async def run(self, minutes: float) -> None:
        end_s = MINUTE_S * minutes
        while self._time.now_s() < end_s:
            await self._run_program(min(end_s, self._time.now_s() + self._chance.uniform(*self._lives_s)))
            self._time.run_until(self._time.now_s() + self._chance.uniform(*_DOWN_S))
        self.complaints += self.witness.complaints

    async def _run_program(self, until_s: float) -> None:
        self.starts += 1
        self.rig.power_cycle()  # garbled frames may have switched its motors off
        self.rig.set_down()
        (cable,) = self._chance.choices(_CABLES, _SHARES)
        program = Program(self.rig, self.witness, self._folder, self.starts, self._chance, cable=cable)
        self._program, self._teacher = program, _Teacher(program, self._chance)
        self._plan_next(0.0)
        await program.run(self._after_tick, lambda: self._time.now_s() >= until_s and self._fault is None)
        if self._fault is not None:
            self._time.run_until(self._fault.end_s)
            if self._case.must.ends_by != "restart":
                self.complaints.append(f"{self._case}: {program.ended_by}")
            self._end_fault()
        elif program.ended_by:
            self.complaints.append(program.ended_by)
        self.ticks += program.runtime.timer.ticks
        self.lessons += len(program.knowledge.submitted)
        self.complaints += program.close()

    def _after_tick(self, record: TickRecord) -> list[Command]:
        now_s = self._time.now_s()
        self.most_waiting = max(self.most_waiting, len(record.commands))
        if self._fault is None and now_s >= self._next_fault_s:
            self._begin_fault()
        elif self._fault is not None and now_s >= self._fault.end_s + TABLE.schedule.settles_s:
            self._end_fault()
            self._plan_next(self._chance.expovariate(1.0 / self._gap_s))
        if now_s >= self._next_minute_s and self._fault is None:
            self._next_minute_s = now_s + MINUTE_S
            self.minutes.append(_measured())
            self.rig.set_down()  # it may be stuck
            self._program.runtime.reposition()
        return self._teacher(record)

    def _plan_next(self, gap_s: float) -> None:
        self._next_fault_s = self._time.now_s() + _LEAST_GAP_S + gap_s

    def _begin_fault(self) -> None:
        if not self._deck:
            self._deck = list(CASES)
            self._chance.shuffle(self._deck)
        self._case = self._deck.pop()
        first_s = _HAND_FIRST_S if self._case.target == "teacher_link" else _SOUND_FIRST_S
        self._fault = self._program.plan_fault(self._case, self._time.now_s() + first_s)
        self._old_frames, self._resumes = self.witness.envelope.old_frames, self.witness.resumes

    def _end_fault(self) -> None:
        """Judge a fault that is over: a row of the table is for a robot that drives, and knows where it is."""
        case, fault, witness, must = self._case, self._fault, self.witness, self._case.must
        assert fault is not None
        drove = not witness.standstills(fault.begin_s - ROBOT.cycle_s, fault.begin_s)
        shows = GuardReason.WHEELS_DISOBEY not in must.words or (
            witness.slowest_m_s(fault.begin_s, fault.end_s) >= _SHOWS_M_S
        )
        if must.leads_to == "stands" and drove and shows and not witness.standstills(fault.begin_s, fault.end_s):
            self.complaints.append(f"{case}: must stand because of {must.words}, did not")
        # A robot that is told to drive on by a teacher who has not seen what is wrong may try again.
        allowed = must.old_frames * (1 + witness.resumes - self._resumes)
        old_frames = witness.envelope.old_frames - self._old_frames
        if old_frames > allowed:
            self.complaints.append(f"{case}: {old_frames} old set points arrived at the robot, allowed are {allowed}")
        self.tried.append((case, drove))
        self.complaints += self._program.end_fault()
        self._fault = None


def _measured() -> Minute:
    ctypes.CDLL(None).malloc_trim(0)
    process = psutil.Process()
    return Minute(process.memory_info().rss / 1e6, process.num_fds(), threading.active_count())
