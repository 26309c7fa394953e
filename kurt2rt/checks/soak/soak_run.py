"""Simulated day: starts of the program, faults and moods in sequence."""

import gc
import random
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path

from kurt2rt.checks.faults.complaint import Complaint, ComplaintCode, complaint
from kurt2rt.checks.faults.table import FaultTable
from kurt2rt.checks.soak.checks import HOUR_S, envelope_check, fault_check, memory_check, starts_check, steady_check
from kurt2rt.checks.soak.disk_list import Spool
from kurt2rt.checks.soak.faults import FaultResult, SoakFaults
from kurt2rt.checks.soak.log import MinuteLog
from kurt2rt.checks.soak.long_run_rig import SoakRig
from kurt2rt.checks.soak.observer import OdometryCheck, SoakObserver
from kurt2rt.checks.soak.operator import SoakOperator
from kurt2rt.checks.soak.program_run import ProgramRun, ProgramStart
from kurt2rt.checks.soak.resource_usage import objects_by_type, used_mb
from kurt2rt.checks.soak.result import CheckCode, SoakCheck, SoakMinute, SoakResult, SoakStart
from kurt2rt.checks.soak.settings import SoakSettings
from kurt2rt.checks.soak.teacher import SoakTeacher
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.runs.recording.recording import Recording
from kurt2rt.service.assembly import RunSettings

_MINUTE_S = 60.0
_LEAST_RUN_S = 5.0
_MOST_UNEXPECTED = 20
"""Unexpected ends after which the soak stops."""


class SoakRun:
    """One soak on its rig."""

    def __init__(
        self,
        rig: SoakRig,
        soak: SoakSettings,
        table: FaultTable,
        run_settings: RunSettings,
        recording: Recording,
        *,
        seed: int,
        by_module: bool = False,
    ) -> None:
        """`run_settings`: with the soak's knowledge file. `by_module`: trace memory, four times slower."""
        settings, task = run_settings.robot, run_settings.task
        self._rig, self._soak, self._run_settings = rig, soak, run_settings
        self._recording = recording
        self._seed = seed
        self._by_module = by_module
        self._period_s = settings.cycle_s
        self._chance = random.Random(f"day {soak.name}, seed {seed}")
        self._observer = SoakObserver(rig, table.envelope)
        actions = tuple(load_task_repertoire(task, settings))
        self._teacher = SoakTeacher(soak, task, settings, actions, seed)
        self._faults = SoakFaults(rig, self._observer, table, soak.fault_gap_s, seed)
        self._operator = SoakOperator(rig, soak.picked_up_after_s, self._period_s)
        self._odometry = OdometryCheck(rig, settings.geometry.metres_per_tick)
        self._log = MinuteLog()
        self._starts: Spool[SoakStart] = Spool()
        self._unexpected: list[Complaint] = []
        self._objects: dict[str, dict[str, int]] = {}
        self._first_hour: tracemalloc.Snapshot | None = None
        self._next_minute_s = _MINUTE_S
        self._missed_before = 0
        self._refused = self._most_waiting = self._session_off = 0
        self._recorded = self._unrecorded = 0
        self._troubles: list[str] = []
        self._session_from: int | None = None
        self._cut_short = False

    def end(self) -> None:
        """End after the active fault; the results so far are judged. Safe in a signal handler."""
        self._cut_short = True

    async def run(self, hours: float, on_progress: Callable[[float], None]) -> SoakResult:
        """Run for `hours` of simulated time, once; `on_progress` gets simulated seconds.

        Raises KnowledgeError, SettingsError, DiskOutOfStepError, OSError.
        """
        try:
            return await self._run(hours, on_progress)
        finally:
            for spool in (self._log.minutes, self._starts, self._faults.results):
                spool.close()

    async def _run(self, hours: float, on_progress: Callable[[float], None]) -> SoakResult:
        begun_s = time.monotonic()
        end_s = hours * HOUR_S
        clock = self._rig.time
        if self._by_module:
            tracemalloc.start(1)
        while not self._cut_short and clock.now_s() < end_s - _LEAST_RUN_S and len(self._unexpected) < _MOST_UNEXPECTED:
            until_s = min(end_s, clock.now_s() + self._chance.uniform(*self._soak.lives_s))
            start = await self._run_program(until_s, on_progress)
            # A fault that ended the program must be over before the restart.
            clock.run_until(max(clock.now_s(), self._faults.acts_until_s) + self._chance.uniform(*self._soak.down_s))
            # On a robot the end of the program takes all that it knew along; two at a time would count twice.
            gc.collect()
            self._starts.append(start._replace(left_mb=round(used_mb(), 3)))
        return self._result(clock.now_s(), time.monotonic() - begun_s)

    async def _run_program(self, until_s: float, on_progress: Callable[[float], None]) -> SoakStart:
        wires = self._soak.wires
        (wire,) = self._chance.choices(list(wires), list(wires.values()))
        begun_s = self._rig.time.now_s()
        start = ProgramStart(len(self._starts) + 1, wire, self._seed)
        program = ProgramRun(self._rig, self._observer, self._teacher, self._run_settings, self._recording, start)
        self._missed_before = 0
        self._session_from = None
        self._odometry.invalidate()
        self._faults.program = program

        def on_tick(record: TickRecord) -> None:
            self._on_tick(program, record, on_progress)

        # A program that is ended while its disk fails says what it could not save; that is no loss to look for here.
        await program.run(
            on_tick,
            lambda: (self._cut_short or self._rig.time.now_s() >= until_s) and self._faults.acting is None,
        )
        expected = self._faults.may_end_program
        self._faults.program = None
        if program.ended_by and not expected:
            now_s = self._rig.time.now_s()
            self._unexpected.append(complaint(ComplaintCode.ENDED_UNEXPECTEDLY, now_s, error=program.ended_by))
        try:
            lost = program.close()
        except KnowledgeError as error:
            lost = complaint(ComplaintCode.NOT_SAVED, error=str(error))
        ledger = program.runtime.timer
        self._observer.ticks += ledger.ticks
        self._observer.missed_ticks += ledger.missed_ticks
        self._refused += program.refused
        self._unrecorded += program.recorder.dropped
        self._recorded += program.recorder.written
        if program.recorder.trouble and len(self._troubles) < 20:
            self._troubles.append(program.recorder.trouble)
        self._most_waiting = max(self._most_waiting, program.most_waiting)
        lasted_s = self._rig.time.now_s() - begun_s
        return SoakStart(begun_s, lasted_s, wire, program.ended_by, lost)

    def _on_tick(self, program: ProgramRun, record: TickRecord, on_progress: Callable[[float], None]) -> None:
        now_s = self._rig.time.now_s()
        ledger = program.runtime.timer
        missed = ledger.missed_ticks - self._missed_before
        self._missed_before = ledger.missed_ticks
        self._log.on_tick(record, self._observer.late_s, missed)
        self._odometry.on_tick(record.readings)
        if self._operator.on_tick(record):
            program.runtime.reposition()
            self._odometry.invalidate()
        if self._faults.acting is not None or program.wire == "lossy":
            self._odometry.invalidate()
        self._check_session(program, record)
        if now_s >= self._next_minute_s:
            self._next_minute_s += _MINUTE_S
            self._odometry.compare()
            self._log.end_minute(now_s, program, self._teacher.mood)
            on_progress(now_s)
            if len(self._log.minutes) % 60 == 0:
                self._sample_memory(len(self._log.minutes) // 60)

    def _check_session(self, program: ProgramRun, record: TickRecord) -> None:
        school = program.runtime.handler
        if school.session is None:
            return
        if self._session_from is None:
            self._session_from = record.tick - school.teaching_ticks(record.tick)
        if record.tick - self._session_from != school.teaching_ticks(record.tick):
            self._session_off += 1

    def _sample_memory(self, hour: int) -> None:
        if hour in (1, 6, 12, 18, 24):
            self._objects[str(hour)] = objects_by_type()
        if self._by_module and hour == 1:
            self._first_hour = tracemalloc.take_snapshot()

    def _result(self, simulated_s: float, took_s: float) -> SoakResult:
        observer = self._observer
        minutes, starts, faults = tuple(self._log.minutes), tuple(self._starts), tuple(self._faults.results)
        frames = observer.envelope.frames
        counted = {
            "set down": self._operator.set_down,
            "switched off and on": self._operator.switched_on,
            "controller crashes": self._rig.crashes,
            "collisions": self._rig.collisions,
            "refused commands": self._refused,
            "commands": self._teacher.sent,
            "old set points": observer.envelope.old_frames,
        }
        return SoakResult(
            name=self._soak.name,
            seed=self._seed,
            simulated_s=simulated_s,
            took_s=took_s,
            ticks=observer.ticks,
            missed_ticks=observer.missed_ticks,
            frames=frames,
            checks=self._checks(minutes, starts, faults),
            minutes=minutes,
            starts=starts,
            faults=faults,
            complaints=(*observer.complaints.stored, *self._unexpected),
            counted=counted,
            objects=self._objects,
            grown_kb=self._grown_kb(),
        )

    def _checks(
        self, minutes: tuple[SoakMinute, ...], starts: tuple[SoakStart, ...], faults: tuple[FaultResult, ...]
    ) -> tuple[SoakCheck, ...]:
        observer, limits = self._observer, self._soak.limits
        return (
            envelope_check(observer.complaints, observer.envelope.frames),
            fault_check(faults),
            starts_check(starts, self._unexpected),
            memory_check(minutes, limits),
            steady_check(minutes),
            SoakCheck(
                CheckCode.WAITING,
                self._most_waiting <= limits.waiting,
                {"commands": self._most_waiting, "allowed": limits.waiting},
            ),
            SoakCheck(
                CheckCode.ODOMETRY,
                self._odometry.worst_m <= limits.odometry_m,
                {"worst_mm": self._odometry.worst_m * 1000},
            ),
            SoakCheck(
                CheckCode.RECORDED,
                self._unrecorded == 0 and self._recorded == observer.ticks,
                {
                    "recorded": self._recorded,
                    "ticks": observer.ticks,
                    "lost": self._unrecorded,
                    "trouble": "".join(f"; {each}" for each in self._troubles[:1]),
                },
            ),
            SoakCheck(CheckCode.TEACHING_CLOCK, self._session_off == 0, {"ticks": self._session_off}),
        )

    def _grown_kb(self) -> dict[str, float]:
        if self._first_hour is None:
            return {}
        compared = tracemalloc.take_snapshot().compare_to(self._first_hour, "filename")
        tracemalloc.stop()
        return {
            str(Path(*Path(each.traceback[0].filename).parts[-3:])): round(each.size_diff / 1000, 1)
            for each in compared[:25]
        }
