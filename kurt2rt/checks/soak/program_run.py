"""One start of the robot's program in simulated time, with the loop parts of `kurt2rt run`."""

import random
import traceback
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import NamedTuple

from hal.guard_reason import GuardReason
from kurt2rt.checks.faults.complaint import Complaint
from kurt2rt.checks.faults.failing_clock import SoakClock
from kurt2rt.checks.faults.failing_level import SoakLevel
from kurt2rt.checks.faults.fault_rig import RigDisturbance
from kurt2rt.checks.faults.table import Target
from kurt2rt.checks.faults.teacher_link import TEACHER, TeacherLink
from kurt2rt.checks.soak.failing_knowledge import SoakKnowledge, open_soak_knowledge
from kurt2rt.checks.soak.long_run_rig import SoakRig
from kurt2rt.checks.soak.observer import SoakObserver
from kurt2rt.checks.soak.teacher import NAME, SoakTeacher
from kurt2rt.core.decision.active_stop import STARTED
from kurt2rt.core.teaching.commands import Command, ReplaceAction, Take
from kurt2rt.core.teaching.inbox import InboxFullError
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.loading import OpenedKnowledge
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.runs.recording.recorder import RunRecorder
from kurt2rt.runs.recording.recording import Recording, RunContext
from kurt2rt.runtime import Runtime
from kurt2rt.service.assembly import RunSettings, assemble_service
from kurt2rt.service.post_tick import PostTick, ProgramConsole
from kurt2rt.teacher.client.manual_drive import BEAT_S

_READY_AFTER_S = 3.0
_FIRST_DAY = datetime(2000, 1, 1, tzinfo=UTC)
"""Origin of simulated time in the names of recordings."""
_WRITES_EVERY_TICKS = 10
_POLL_EVERY_TICKS = 1000
"""Period of the recorder's sync; the disk is not faster in simulated time."""


class ProgramStart(NamedTuple):
    """Number of a start, its wire by name, and the seed of the soak."""

    number: int
    wire: str
    seed: int


class ProgramRun:
    """Program from start to end: `run`, then `close`."""

    def __init__(
        self,
        rig: SoakRig,
        observer: SoakObserver,
        teacher: SoakTeacher,
        run_settings: RunSettings,
        recording: Recording,
        start: ProgramStart,
    ) -> None:
        """Open the knowledge and start the driver. Raises KnowledgeError, SettingsError."""
        settings, service = run_settings.robot, run_settings.service
        self.wire = start.wire
        self.refused = 0
        """Commands that the robot refused."""
        self.most_waiting = 0
        """Largest number of commands in the inbox at a tick."""
        self.ended_by = ""
        """Error that ended the program; empty without one."""
        self._rig, self._observer, self._teacher = rig, observer, teacher
        self._settings = settings
        self._time = rig.time
        self._number = start.number
        self._presses = 0
        self._lessons_sent = self._recorded_at = self._polled_at = 0
        self._chance = random.Random(f"life {start.number}, seed {start.seed}")
        self._started_s: float | None = None
        self._begun_s = 0.0
        self._checkpoint_ticks = round(service.checkpoint_period_s / settings.cycle_s)
        self._link: TeacherLink | None = None
        path = Path(service.knowledge)
        opened = open_soak_knowledge(path, settings, run_settings.task)
        self.knowledge = SoakKnowledge(path, opened, rig.time)
        observer.begin_program(rig.start_driver(start.wire), settings.cycle_s)
        teacher.program_started()
        self.clock = SoakClock(rig.time)
        self.level = SoakLevel(rig.time)
        self.runtime, self.recorder, self._post_tick = self._assemble(run_settings, opened, recording)

    def _assemble(
        self, run_settings: RunSettings, opened: OpenedKnowledge, recording: Recording
    ) -> tuple[Runtime, RunRecorder, PostTick]:
        context = RunContext(f"{self._number:016x}", run_settings.service.knowledge, attended=True, stopped=STARTED)
        service = assemble_service(
            self._observer, run_settings, opened, self.knowledge.writer, self.clock, context, self.level
        )
        self.level.inner = service.runtime.level
        started = _FIRST_DAY + timedelta(seconds=self._time.now_s())
        # Without its thread: the loop calls it, as far as simulated time has gone.
        recorder = recording.recorder(run_settings.robot, run_settings.task, opened, context, started=started)
        recorder.poll()
        console = ProgramConsole(
            status=lambda _: None, question=lambda _: None, acknowledged=self.knowledge.on_acknowledged
        )
        return service.runtime, recorder, PostTick(service, console, recorder=recorder)

    @property
    def ready(self) -> bool:
        """Return whether the program has run long enough for a fault."""
        return self._started_s is not None and self._time.now_s() - self._started_s > _READY_AFTER_S

    async def run(self, on_tick: Callable[[TickRecord], None], is_over: Callable[[], bool]) -> None:
        """Run the loop as kurt2rt.service.serve does, until `is_over` returns True or an error ends it.

        After any error the wheels stop first; `ended_by` tells the error, and nothing is raised. `on_tick` and
        `is_over` are called after each tick.
        """
        runtime = self.runtime
        self._started_s = self._time.now_s()
        self._begun_s = self.clock.now_s()

        def after_tick(record: TickRecord) -> None:
            self._after_tick(record)
            on_tick(record)
            if is_over():
                runtime.scheduler.end()

        with gc_frozen():
            try:
                await runtime.scheduler.run(None, after_tick)
            except Exception as error:  # noqa: BLE001  # whatever a fault raised ends the program, and is judged
                self.ended_by = _format_error(error)
            finally:
                self._observer.emergency_stop(GuardReason.SERVICE_ENDS)
        self._started_s = None

    def close(self) -> Complaint | None:
        """Save statistics, end the driver, close the file and compare it with the lessons.

        Returns None if no lesson was lost. Raises KnowledgeError.
        """
        self.runtime.scheduler.end()
        self._rig.end_driver()
        if not self.ended_by:
            self._post_tick.save_statistics()
        self.recorder.close()
        self.knowledge.clear()
        self.knowledge.close()
        return self.knowledge.lost_lessons()

    def take_manual_control(self, disturbance: RigDisturbance) -> None:
        """Let another teacher take the robot and drive it by hand, over a link with a scheduled fault."""
        link = self._link = TeacherLink(self._time, disturbance, self.runtime, self._chance)
        self._presses += 1
        for _ in range(self._presses):  # a press has a larger number than that of any press before
            link.press()
        self._lessons_sent += 1
        self._put(Take(f"hand-{self._number}-{self._lessons_sent}", TEACHER))
        self._beat(link)

    def repeat_known_lesson(self) -> None:
        """Teach the action of the oldest RLA once more, a lesson that changes nothing; without an RLA do nothing."""
        rla = next(iter(self.runtime.level.system.rlas), None)
        if rla is not None:
            self._lessons_sent += 1
            self._put(ReplaceAction(f"known-{self._number}-{self._lessons_sent}", NAME, rla.rla_id, rla.action))

    def stop(self) -> None:
        """Send the teacher's stop."""
        self._put(self._teacher.stop())

    def clear(self, target: Target) -> None:
        """End the fault of a target of the program: clock, tick, disk or teacher_link; ignore other targets."""
        match target:
            case "clock":
                self.clock.clear()
            case "tick":
                self.level.clear()
            case "disk":
                self.knowledge.clear()
            case "teacher_link":
                self._link = None

    def _after_tick(self, record: TickRecord) -> None:
        runtime = self.runtime
        self._observer.on_tick(record, runtime.timer, self._begun_s)
        self.most_waiting = max(self.most_waiting, len(record.commands))
        self.refused += sum(not result.accepted for result in record.results)
        self.knowledge.submitted += [event.origin.command_id for event in record.events]
        self._post_tick(record)
        if record.tick - self._recorded_at >= _WRITES_EVERY_TICKS:
            self._recorded_at = record.tick
            self.recorder.write_waiting()
        if record.tick - self._polled_at >= _POLL_EVERY_TICKS:
            self._polled_at = record.tick
            self.recorder.poll()
        self.knowledge.keep_in_step(with_statistics=(runtime.timer.ticks % self._checkpoint_ticks) == 0)
        authority = runtime.handler.authority
        if self._link is not None:
            self._link.set_displayed_tick(record.tick)
        taken = authority.teacher not in (None, NAME)
        for command in self._teacher.watch(record, hand=self._link is not None, taken=taken):
            self._put(command)

    def _beat(self, link: TeacherLink) -> None:
        """Send periodically until the link is replaced."""
        if self._link is link:
            link.beat()
            self._time.at(self._time.now_s() + BEAT_S, lambda: self._beat(link))

    def _put(self, command: Command) -> None:
        try:
            self.runtime.inbox.put(command)
        except InboxFullError:
            self.refused += 1  # a loop that hangs takes nothing; he says it again


def _format_error(error: Exception) -> str:
    """Return the error and its place in the program."""
    *_, where = traceback.extract_tb(error.__traceback__)
    return f"{error!r} in {Path(where.filename).name}, line {where.lineno}"
