"""One start of the robot's program in simulated time, with the loop parts of `kurt2rt run`."""

import random
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path

from hal.guard_reason import GuardReason
from hal.kurt2_settings import Kurt2Settings
from kurt2rt.core.decision.standing import STARTED
from kurt2rt.core.rla.rla import SCRIPTED
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teaching.commands import Command, ReplaceAction, Stop, Take
from kurt2rt.core.teaching.inbox import InboxFullError
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.loading import open_for_teaching
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.runs.recording.recording import Recording, RunContext
from kurt2rt.runs.recording.run_folder import budget_of
from kurt2rt.service.assembly import RunSettings, assemble_service
from kurt2rt.service.post_tick import PostTick, ProgramConsole
from kurt2rt.service.settings import load_service
from tests.faults.cable import SOUND, CableFaults
from tests.faults.can_log import FaultyCanLog
from tests.faults.clock import FaultyClock
from tests.faults.disk import KnowledgeFile
from tests.faults.fault import Fault
from tests.faults.hand import DRIVER, Hand
from tests.faults.level import FaultyLevel
from tests.faults.rig import ROBOT, Rig
from tests.faults.table import TABLE, Case
from tests.faults.witness import Witness

TASK: TaskSettings = load_task("wall_following")
TEACHER = SCRIPTED
Teaches = Callable[[TickRecord], Sequence[Command]]
"""Gets the record of each tick, and returns a teacher's commands."""

_FIRST_DAY = datetime(2000, 1, 1, tzinfo=UTC)
"""Origin of simulated time in the names of recordings."""
_RECORDINGS_MB = 50
_CHECKPOINT_S = 10.0
_LESSON_EVERY_S = 0.25
_WRITES_EVERY_TICKS = 10
_POLL_EVERY_TICKS = 1000
"""Period of the recorder's sync; the disk is not faster in simulated time."""


class Program:
    """Program from start to end: `run`, then `close`. It stands until a teacher resumes it."""

    def __init__(
        self,
        rig: Rig,
        witness: Witness,
        folder: Path,
        number: int,
        chance: random.Random,
        settings: Kurt2Settings = ROBOT,
        cable: CableFaults = SOUND,
    ) -> None:
        """Open the knowledge in `folder` and start the driver; `number`: of the start."""
        self.ended_by = ""
        """Error that ended the program; empty without one."""
        self.hand: Hand | None = None
        self.log: FaultyCanLog | None = None
        self._rig, self._witness, self._time = rig, witness, rig.time
        self._number, self._chance, self._period_s = number, chance, settings.cycle_s
        self._commands = 0
        path = folder / "drill.knowledge"
        opened = open_for_teaching(path, settings, TASK)
        opened.journal.close()
        self.knowledge = KnowledgeFile(path, opened, rig.injection)
        witness.begin_program(rig.start_driver(cable))
        self._clock = FaultyClock(rig.injection)
        self.level = FaultyLevel(rig.injection)
        service = load_service().model_copy(update={"knowledge": str(path), "checkpoint_period_s": _CHECKPOINT_S})
        context = RunContext(f"{number:016x}", str(path), attended=True, stopped=STARTED)
        run_settings = RunSettings(settings, TASK, service)
        self.service = assemble_service(witness, run_settings, opened, self.knowledge.writer, self._clock, context)
        self.runtime = self.service.runtime
        self.level.inner = self.runtime.level
        self.runtime.tick._level = self.level
        # Without its thread: the loop calls it, as far as simulated time has gone.
        self._recorder = Recording(folder / "runs", budget_of(_RECORDINGS_MB), "sim").recorder(
            settings, TASK, opened, context, started=_FIRST_DAY + timedelta(seconds=self._time.now_s())
        )
        self._recorder.poll()
        console = ProgramConsole(
            status=lambda _: None, question=lambda _: None, acknowledged=self.knowledge.on_acknowledged
        )
        self._post_tick = PostTick(self.service, console, recorder=self._recorder)
        self._checkpoint_ticks = round(_CHECKPOINT_S / self._period_s)
        self._begun_s = 0.0

    async def run(self, teaches: Teaches, is_over: Callable[[], bool]) -> None:
        """Run the loop as kurt2rt.service.serve does, until `is_over` returns True or an error ends it.

        After any error the wheels stop first; `ended_by` tells the error, and nothing is raised.
        """
        runtime = self.runtime
        self._begun_s = self._clock.now_s()

        def after_tick(record: TickRecord) -> None:
            self._after_tick(record)
            for command in teaches(record):
                self.put(command)
            if is_over():
                runtime.scheduler.end()

        with gc_frozen():
            try:
                await runtime.scheduler.run(None, after_tick)
            except Exception as error:  # noqa: BLE001  # whatever a fault raised ends the program, and is judged
                *_, where = traceback.extract_tb(error.__traceback__)
                self.ended_by = f"{error!r} in {Path(where.filename).name}, line {where.lineno}"
            finally:
                self._witness.emergency_stop(GuardReason.SERVICE_ENDS)

    def close(self) -> list[str]:
        """End driver and files; return complaints about lost lessons and ticks. Raises KnowledgeError."""
        self._rig.end_driver()
        if not self.ended_by:
            self._post_tick.save_statistics()
        recorder, ticks = self._recorder, self.runtime.timer.ticks
        recorder.close()
        complaints = list(self.knowledge.close())
        if recorder.dropped or recorder.written != ticks:
            complaints.append(f"of {ticks} ticks {recorder.written} are recorded{recorder.trouble}")
        return complaints

    def plan_fault(self, case: Case, begin_s: float) -> Fault:
        """Plan the fault of a case, with what belongs to it: lessons, a stop, a hand that drives, a log."""
        self._witness.watch()
        self.knowledge.keep_in_step(with_statistics=True)
        fault = self._rig.injection.plan(case, begin_s, TABLE.schedule.lasts_s)
        match case.target:
            case "disk":
                self.knowledge.prepare(fault)
                for number in range(int((fault.end_s - begin_s) / _LESSON_EVERY_S)):
                    self._time.at(begin_s + number * _LESSON_EVERY_S, self._repeat_known_lesson)
            case "recorder":
                self.log = FaultyCanLog(self._rig.injection)
                self._rig.attach_tap(self.log)
            case "teacher_link":
                self.put(Take(self.next_id(), DRIVER))
                press_id = self.runtime.timer.ticks + 1
                self.hand = Hand(self.service, self._rig.injection, self._chance, press_id)
        if case.must.stop_said_after_s is not None:
            stop = Stop(self.next_id(), TEACHER)
            self._time.at(begin_s + case.must.stop_said_after_s, lambda: self.put(stop))
        return fault

    def end_fault(self) -> list[str]:
        """End a fault that is over; return complaints about its log."""
        self._clock.repair()
        self._rig.injection.end()
        self._witness.rest()
        complaints: list[str] = []
        if self.log is not None:
            self._rig.attach_tap(None)
            complaints += self.log.close()
        if self.hand is not None:
            self.hand.let_go()
        self.log = self.hand = None
        return complaints

    def put(self, command: Command) -> None:
        with suppress(InboxFullError):  # a loop that hangs takes nothing; the teacher says it again
            self.runtime.inbox.put(command)

    def next_id(self) -> str:
        self._commands += 1
        return f"{self._number}-{self._commands}"

    def _after_tick(self, record: TickRecord) -> None:
        runtime, ticks = self.runtime, self.runtime.timer.ticks
        self._witness.on_tick(record, runtime.timer, self._begun_s, self._period_s)
        self.knowledge.submitted += [event.origin.command_id for event in record.events]
        self._post_tick(record)
        if ticks % _WRITES_EVERY_TICKS == 0:
            self._recorder.write_waiting()
        if ticks % _POLL_EVERY_TICKS == 0:
            self._recorder.poll()
        self.knowledge.keep_in_step(with_statistics=ticks % self._checkpoint_ticks == 0)
        if self.hand is not None:
            self.hand.see(record.tick)

    def _repeat_known_lesson(self) -> None:
        """Teach the action of the oldest RLA once more: what the robot does then is for the disk's sake alone."""
        rla = next(iter(self.runtime.level.system.rlas), None)
        if rla is not None:
            self.put(ReplaceAction(self.next_id(), TEACHER, rla.rla_id, rla.action))
