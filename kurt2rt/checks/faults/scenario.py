"""Fault scenario: the robot drives, one part fails for a while and recovers."""

import random
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from hal.errors import UserError
from hal.guard_reason import GuardReason
from hal.robot_settings import RobotSettings
from kurt2rt.checks.faults.complaint import Complaint
from kurt2rt.checks.faults.envelope import Envelope
from kurt2rt.checks.faults.failing_clock import FaultyClock, RigClock
from kurt2rt.checks.faults.failing_disk import FailingDisk
from kurt2rt.checks.faults.failing_level import FaultyLevel
from kurt2rt.checks.faults.failing_recorder import FailingRecorder
from kurt2rt.checks.faults.fault_rig import FaultRig, RigFactory
from kurt2rt.checks.faults.observer import WheelObserver
from kurt2rt.checks.faults.outcome import LOST_FRAMES, FaultOutcome, Standstill
from kurt2rt.checks.faults.script import Script
from kurt2rt.checks.faults.table import FaultCase, FaultTable
from kurt2rt.checks.faults.teacher_link import TeacherLink
from kurt2rt.core.event_store import EventStore, InMemoryEventStore
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.clock import Clock
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime


class DidNotDriveError(UserError):
    """Robot that stood before the fault, which hides the fault's effect."""


class _Parts(NamedTuple):
    """Parts of a scenario that outlive the driver, and its randomness."""

    keeper: EventStore
    recorder: FailingRecorder | None
    chance: random.Random


class _Scenario:
    """One scenario on its rig."""

    def __init__(
        self,
        rig: FaultRig,
        case: FaultCase,
        table: FaultTable,
        settings: RobotSettings,
        task: TaskSettings,
        parts: _Parts,
    ) -> None:
        self._rig = rig
        self._case = case
        self._settings = settings
        self._task = task
        self._keeper, self._recorder, chance = parts
        self._time = rig.time
        self._script = Script(rig, case, table)
        self._observer = WheelObserver(
            rig, Envelope(table.envelope, case.must.slew_share), table.envelope.controller_watchdog_s
        )
        self._latched: str | None = None
        self._ended_by = ""
        # The ticks' phase against the controller's cycle.
        self._time.run_until(chance.uniform(0.1, 0.9) * settings.cycle_s)
        self._time.at(rig.disturbance.begin_s, self._require_driving)
        self._time.at(self._script.resume_at_s, self._note_the_end)
        self._level = FaultyLevel(self._time, rig.disturbance) if case.target == "tick" else None
        self._runtime = self._build(())
        if self._level is not None:
            self._level.inner = self._runtime.level
        self._link: TeacherLink | None = None
        if case.target == "teacher_link":
            self._link = TeacherLink(self._time, rig.disturbance, self._runtime, chance)
        if self._recorder is not None:
            rig.attach_tap(self._recorder)
        self._script.begin(self._runtime, self._link)

    async def run(self) -> None:
        """Run to the end, with a restart of the service if the fault ended it."""
        await self._serve()
        if self._time.now_s() < self._script.resume_at_s:  # the service has ended before its time
            self._time.run_until(self._script.resume_at_s)
            self._restart()
            await self._serve()

    def outcome(self, seed: int, problems: tuple[Complaint, ...]) -> FaultOutcome:
        """Return the outcome."""
        observer, resume_at_s = self._observer, self._script.resume_at_s
        begin_s, end_s = self._rig.disturbance.begin_s, self._rig.disturbance.end_s
        stands = observer.standstills(begin_s, end_s)
        standstills = [Standstill(each.from_s - begin_s, observer.causes_from(each.from_s)) for each in stands]
        health = self._rig.robot.health
        counted = {
            "junk frames": health.junk,
            "unintelligible commands": observer.envelope.unintelligible,
            "missed ticks": self._runtime.timer.missed_ticks,
            "refused messages": 0 if self._link is None else self._link.refused,
            LOST_FRAMES: 0 if self._recorder is None else self._recorder.lost,
        }
        return FaultOutcome(
            target=self._case.target,
            kind=self._case.kind,
            seed=seed,
            first=standstills[0] if stands else None,
            last=standstills[-1] if stands and stands[-1].to_s >= end_s else None,
            went_on=bool(stands) and stands[0].to_s < end_s,
            longest_stand_s=max((each.to_s - each.from_s for each in stands), default=0.0),
            latched=self._latched,
            latched_after_s=None if observer.latched is None else observer.latched[0] - begin_s,
            ended_by=self._ended_by,
            drove_by_itself=any(end_s < at_s <= resume_at_s for at_s in observer.drove_at_s),
            drove_when_told=any(at_s > resume_at_s for at_s in observer.drove_at_s),
            oldest_age_s=observer.envelope.oldest_age_s,
            old_frames=observer.envelope.old_frames,
            frames=observer.envelope.frames,
            counted=counted,
            problems=(*observer.envelope.violations, *problems),
        )

    def _build(self, events: tuple[TeachingEvent, ...]) -> Runtime:
        clock: Clock = RigClock(self._time)
        if self._case.target == "clock":
            clock = FaultyClock(self._time, self._rig.disturbance)
        return build_runtime(
            self._observer,
            self._settings,
            self._task,
            events,
            self._keeper,
            clock,
            RuntimeOptions(level_override=self._level, attended=self._case.target == "teacher_link"),
        )

    def _require_driving(self) -> None:
        begin_s = self._rig.disturbance.begin_s
        if self._observer.standstills(begin_s - self._settings.cycle_s, begin_s):
            raise DidNotDriveError(
                "the robot stands before anything fails", where=self._case, do="look at action and task"
            )

    def _note_the_end(self) -> None:
        self._latched = self._rig.robot.health.latched

    async def _serve(self) -> None:
        """Run the loop like kurt2rt.service.serve: after any error the wheels stop first."""
        try:
            await self._runtime.scheduler.run(None, self._after_tick)
        except DidNotDriveError:
            raise
        except Exception as error:  # noqa: BLE001  # whatever a fault raised ends the service
            self._rig.robot.emergency_stop(GuardReason.SERVICE_ENDS)
            self._ended_by = repr(error)

    def _restart(self) -> None:
        """Restart driver and runtime like a supervisor, and resume like a teacher."""
        events = tuple(self._keeper.events) if isinstance(self._keeper, InMemoryEventStore) else ()
        self._observer.attach(self._rig.restart_driver())
        self._level = None
        self._runtime = self._build(events)
        self._script.restart(self._runtime)

    def _after_tick(self, record: TickRecord) -> None:
        self._observer.on_tick(record)
        if isinstance(self._keeper, FailingDisk):
            self._keeper.keep_in_step()
        self._script.after_tick(record)
        if self._time.now_s() >= self._script.over_at_s:
            self._runtime.scheduler.end()


async def run_scenario(
    rigs: RigFactory,
    case: FaultCase,
    table: FaultTable,
    settings: RobotSettings,
    task: TaskSettings,
    *,
    seed: int,
    folder: Path,
) -> FaultOutcome:
    """Run one case and return its outcome.

    `folder`: empty, for a knowledge file. `seed`: noise. Raises DidNotDriveError if the robot does not drive before the
    fault, KnowledgeError, SettingsError.
    """
    schedule = table.schedule
    rig = rigs.open(
        case.target,
        case.kind,
        begin_s=schedule.begins_at_s,
        end_s=schedule.begins_at_s + (case.must.lasts_s or schedule.lasts_s),
        period_s=case.must.period_s,
        delay_s=case.must.delay_s,
        seed=seed,
    )
    chance = random.Random(f"drill {case} {seed}")
    with ExitStack() as stack:
        stack.callback(rig.close)
        keeper: EventStore = InMemoryEventStore()
        disk: FailingDisk | None = None
        if case.target == "disk":
            disk = FailingDisk(rig.time, rig.disturbance, folder / "drill.knowledge", settings, task)
            keeper = disk
            stack.callback(disk.close)
        recorder: FailingRecorder | None = None
        if case.target == "recorder":
            recorder = FailingRecorder(rig.time, rig.disturbance)
            stack.callback(recorder.close)
        running = _Scenario(rig, case, table, settings, task, _Parts(keeper, recorder, chance))
        await running.run()
        problems: list[Complaint | None] = []
        if disk is not None:
            disk.close()
            problems.append(disk.lost_lessons())
        if recorder is not None:
            recorder.close()
            problems.append(recorder.uncounted_frames())
        return running.outcome(seed, tuple(each for each in problems if each is not None))
