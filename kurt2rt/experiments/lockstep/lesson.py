"""Training run: a scripted teacher teaches the robot in lockstep."""

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import accumulate
from typing import NamedTuple

from behaviors.metrics.task_metric import Metrics
from config.settings import Settings
from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner import Label
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import BASIC, MID, Phase, Rla
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Command, DeleteRla, Resume, Reward
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.command_checks import require_carried_out
from kurt2rt.experiments.lockstep.compatibility import route_of
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime
from kurt2rt.experiments.lockstep.sensor_stop import SensorStopAct, SensorStopTimer
from kurt2rt.experiments.lockstep.teacher_of_plan import teacher_of
from kurt2rt.experiments.lockstep.teacher_workload import TeacherWorkload, WorkloadMinute
from kurt2rt.platform.tick_timer import TickTimer
from kurt2rt.runtime import Runtime
from kurt2rt.teacher.scripted.build import build_teacher
from kurt2rt.teacher.scripted.dispatcher import ScriptedDispatcher
from simbridge.contracts.simulation import Pose, Position, Simulation

_AGREEMENT_EVERY_S = 10


class LessonCounts(Settings):
    """Counts of one training run, which studies store as part of an outcome."""

    seed: int
    world: str
    teacher: str
    """Name of the scripted teacher."""
    teaching_s: float
    rlas: int
    """RLAs of the basic level."""
    knowledge_hash: str
    asks: int
    corrections: int
    """Corrections of the basic level."""
    presses: int
    """Presses of the teacher (`WorkloadMinute.presses`)."""
    rescues: int
    repositions: int
    """Planned repositionings, without rescues."""
    deletions: int
    """RLAs that the teacher deleted."""
    alarms: int
    """Latched stops of the guard and stops for a broken sensor, each ended by the teacher."""
    collisions: int
    workload: tuple[WorkloadMinute, ...] = ()
    """Commands and manual acts of the teacher, minute by minute."""
    positive_rewards: int = 0
    negative_rewards: int = 0
    refused_signals: int = 0
    """Rewards that came after their RLA was deleted, and late lessons of a person."""
    unknown_rescues: int = 0
    """Rescues of a robot that stood in an unknown situation without an answer."""
    share_unknown: float = 0.0
    """Ratio of ticks in unknown situations, 0 to 1."""
    agreement: tuple[float | None, ...] = ()
    """Agreement of critic and teacher after each 10 s, 0 to 1; None: too few signals."""
    share_trusted: float = 0.0
    """Ratio of ticks with a trusted critic, 0 to 1."""
    mid_rlas: int = 0
    """RLAs of the mid level."""
    mid_asks: int = 0
    """Questions of the mid level among `asks`."""
    mid_corrections: int = 0
    missed_junctions: int = 0
    """Junctions that the mid level did not notice."""


@dataclass(frozen=True, slots=True)
class TrainingResult:
    """Counts and knowledge of a training run: a simulated session with a teacher.

    The seed decides all of it, bit for bit.
    """

    counts: LessonCounts
    rlas: tuple[Rla, ...]
    """RLAs of the basic level."""
    growth: tuple[int, ...]
    """Number of RLAs after each second of teaching."""
    trail: tuple[Pose, ...]
    ask_positions: tuple[Position, ...]
    collided_at: tuple[Position, ...]
    timer: TickTimer = field(compare=False, repr=False)
    """Durations of the last ticks on the machine of the run."""
    progress: float = 0.0
    """Progress by the task's metric, in `unit`."""
    unit: str = ""
    findings: Metrics = field(default_factory=dict)
    """Further measures of the metric."""
    press_ticks: tuple[int, ...] = ()
    """Tick in which each press was sent."""
    labels: tuple[tuple[Label, ...], ...] = field(default=(), compare=False, repr=False)
    """Standing labels of the learners before each press, and at the end; empty if RLAs decide."""
    saved: Statistics = field(default_factory=Statistics, compare=False, repr=False)
    """Counters and values of the RLAs at the end."""
    mid_rlas: tuple[Rla, ...] = ()
    """RLAs of the mid level."""
    autonomous_values: Statistics | None = field(default=None, compare=False, repr=False)
    """Values of the RLAs in phase 5; None if the run ended in another phase."""


class GivenLesson(NamedTuple):
    """Training run that was given: its result, and its teaching events, from which exams make the robot."""

    result: TrainingResult
    events: list[TeachingEvent]


async def teach(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    training: TrainingStore,
    *,
    seed: int,
    on_progress: Callable[[float], None],
    plan: LessonPlan | None = None,
) -> TrainingResult:
    """Teach the task with the scripted teacher, for the duration of the plan; return counters and knowledge.

    Args:
        simulation: that the robot drives in.
        settings: of the robot.
        task: to teach.
        training: destination of the lessons, and the knowledge to continue from.
        seed: random choices of the teacher.
        on_progress: called once a second with the simulated seconds.
        plan: None: the task's own, phases 1 and 2.

    Raises:
        LessonLostError: the robot refused a command.
        config.settings.SettingsError: task and world do not fit.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
    """
    plan = plan or plan_of(task)
    runtime = build_training_runtime(simulation, settings, task, training, appraises=plan.appraises)
    session = f"{plan.purpose}-{seed}-after-{len(training.events)}"
    run = TrainingRun(simulation, runtime, plan, seed=seed, session=session, on_progress=on_progress)
    await run.drive()
    return run.result()


class TrainingRun(Episode):
    """Drive in which a scripted teacher teaches the robot over the CAN bus, phase by phase of a plan."""

    def __init__(
        self,
        simulation: Simulation,
        runtime: Runtime,
        plan: LessonPlan,
        *,
        seed: int,
        session: str,
        on_progress: Callable[[float], None],
    ) -> None:
        task, settings, period_s = runtime.task, runtime.robot, runtime.robot.cycle_s
        teaching = task.teaching
        answering = build_teacher(task, settings, tuple(runtime.level.repertoire), seed=seed, session=session)
        self._teacher = teacher_of(plan, task, settings, answering, seed=seed, session=session)
        self._dispatcher = None
        if task.mid is not None:
            self._dispatcher = ScriptedDispatcher(
                task.behaviours, self._teacher.times, period_s=period_s, seed=seed, session=session
            )
        super().__init__(
            simulation,
            runtime,
            random.Random(f"course of {session}"),
            stuck_after_s=teaching.slow_rescue_after_s if plan.rescue_after_s is None else plan.rescue_after_s,
            on_progress=on_progress,
        )
        self._plan = plan
        self._seed = seed
        self._agreement = runtime.handler.agreement
        reposition_s = teaching.reposition_every_s if plan.reposition_every_s is None else plan.reposition_every_s
        self._reposition_every = round(reposition_s / period_s)
        self._show_every = round(plan.set_down_every_s / period_s)
        self._shown_ticks = round(plan.shown_s / period_s)
        self._planned_ticks = round(plan.duration_s / period_s)
        self._phase_starts = _phase_starts(plan, period_s)
        self._clean_ticks = None if plan.clean_drive_s is None else round(plan.clean_drive_s / period_s)
        self._unclean_at = max(self._phase_starts, default=0)
        """Last tick with a press, a question, a touch or a rescue, or before the last phase."""
        self._workload = TeacherWorkload(self._planned_ticks, period_s)
        self._growth: list[int] = []
        self._labels: list[tuple[Label, ...]] = []
        self._agreements: list[float | None] = []
        self._sensor_stop = SensorStopTimer(self.ticks_per_second)
        self._rescues = self._unknown_rescues = self._alarms = self._deletions = self._refused = 0
        self._trusted_ticks = self._positive_rewards = self._negative_rewards = 0

    @property
    def presses(self) -> int:
        """Number of presses that the teacher has sent."""
        return len(self._workload.press_ticks)

    async def drive(self) -> None:
        """Teach all phases of the plan."""
        first = self._plan.phases[0][0]
        self._command_behaviour(self.runtime.active_behaviour.behaviour)
        if first is not self._teacher.phase:
            self._begin_phase(first)
        await self.run(self._planned_ticks)

    def on_tick(self, record: TickRecord) -> None:
        """Let the teacher react, and rescue or reposition the robot as planned; end before a press too many.

        Raises LessonLostError if the robot refused a command.
        """
        self._refused += require_carried_out(record, self.task, may_be_late=self._teacher.may_be_refused)
        if record.tick in self._phase_starts:
            self._begin_phase(self._phase_starts[record.tick])
        self._send_lessons(record)
        self._trusted_ticks += self._agreement is not None and self._agreement.trusted
        self.measure()
        self._look_after(record.tick)
        self._command_behaviour(record.behaviour)
        self._note_labels()
        if self._clean_ticks is not None and (self.asking or self.simulation.touching):
            self._note_unclean(record.tick)
        most = self._plan.most_presses
        if self._is_right or (most is not None and self.presses > most):
            self.runtime.scheduler.end()  # a press waits in the inbox, which no further tick reads

    @property
    def _clean_end(self) -> int | None:
        """Tick in which the lesson ends if the robot needs no help until then; None: it ends by the clock."""
        return None if self._clean_ticks is None else self._unclean_at + self._clean_ticks

    @property
    def _is_right(self) -> bool:
        """Return whether the robot has driven for so long without help that the lesson may end."""
        return self._clean_end is not None and self.ticks >= self._clean_end

    def _note_unclean(self, tick: int) -> None:
        self._unclean_at = max(self._unclean_at, tick)

    def on_second(self, record: TickRecord) -> None:
        """Record the growth of the RLA system and the agreement of the critic."""
        self._note_second(record.tick, len(self.runtime.level.system))
        super().on_second(record)

    def result(self) -> TrainingResult:
        """Return the counters and the knowledge."""
        runtime, system = self.runtime, self.runtime.level.system
        autonomous = self._teacher.phase is Phase.AUTONOMOUS
        minutes, ticks, mid_rlas = self._workload.minutes, max(self.ticks, 1), system.rlas_at(MID)
        counts = LessonCounts(
            seed=self._seed,
            world=self.task.teaching.world,
            teacher=self.task.teaching.profile.name,
            teaching_s=self.ticks * self.period_s,
            rlas=len(system.rlas),
            knowledge_hash=system.knowledge_hash(),
            asks=len(self.ask_positions),
            corrections=runtime.handler.corrections_at[BASIC],
            presses=sum(minute.presses for minute in minutes),
            rescues=self._rescues,
            repositions=self.repositions,
            deletions=self._deletions,
            alarms=self._alarms,
            collisions=self.simulation.collisions,
            workload=minutes,
            positive_rewards=self._positive_rewards,
            negative_rewards=self._negative_rewards,
            refused_signals=self._refused,
            unknown_rescues=self._unknown_rescues,
            share_unknown=self.unknown_ticks / ticks,
            agreement=tuple(self._agreements),
            share_trusted=self._trusted_ticks / ticks,
            mid_rlas=len(mid_rlas),
            mid_asks=self.mid_asks,
            mid_corrections=runtime.handler.corrections_at[MID],
            missed_junctions=0 if self._dispatcher is None else self._dispatcher.missed,
        )
        return TrainingResult(
            counts=counts,
            rlas=system.rlas,
            growth=tuple(self._growth),
            trail=tuple(self.trail),
            ask_positions=tuple(self.ask_positions),
            collided_at=tuple(self.collided_at),
            timer=runtime.timer,
            progress=self.metric.progress,
            unit=self.metric.unit,
            findings=self.metric.findings,
            press_ticks=tuple(self._workload.press_ticks),
            labels=() if runtime.learner is None else (*self._labels, runtime.learner.team.labels),
            saved=runtime.snapshot(),
            mid_rlas=mid_rlas,
            autonomous_values=runtime.reinforcement.autonomous_values() if autonomous else None,
        )

    def _note_labels(self) -> None:
        """Note the labels that stand before each press of this tick, which a later tick applies."""
        if self.runtime.learner is not None:
            while len(self._labels) < self.presses:
                self._labels.append(self.runtime.learner.team.labels)

    def _note_second(self, tick: int, rlas: int) -> None:
        """Record the number of RLAs after a tick at the end of a second, and the critic's agreement."""
        self._growth.append(rlas)
        if tick % (_AGREEMENT_EVERY_S * self.ticks_per_second) == 0:
            self._agreements.append(None if self._agreement is None else self._agreement.share)

    def _begin_phase(self, phase: Phase) -> None:
        self.send(self._teacher.begin_phase(phase))
        if self._dispatcher is not None:
            self._dispatcher.phase = phase

    def _send_lessons(self, record: TickRecord) -> None:
        """Send the teacher's and the dispatcher's commands, and resume a second after the guard latched."""
        for command in self._teacher.on_tick(record, touching=self.simulation.touching):
            self._send_lesson(command, record.tick)
            if isinstance(command, Resume) and record.guard_result.latched:  # the action shown ended in an alarm
                self._count_alarm(record.tick)
        if self._dispatcher is not None:
            command_for_mid = self._dispatcher.on_tick(record, route_of(self.metric, self.task).ahead)
            if command_for_mid is not None:
                self._send_lesson(command_for_mid, record.tick)
        if self.latched_ticks == self.ticks_per_second:
            self.send(self._teacher.resume())
            self._count_alarm(record.tick)

    def _send_lesson(self, command: Command, tick: int) -> None:
        self.send(command)
        self._note_unclean(tick)
        self._workload.count(tick, command)
        self._deletions += isinstance(command, DeleteRla)
        if isinstance(command, Reward):
            self._positive_rewards += command.value > 0
            self._negative_rewards += command.value < 0

    def _count_alarm(self, tick: int) -> None:
        self._workload.count_manual(tick, "go")
        self.latched_ticks = 0
        self._alarms += 1

    def _look_after(self, tick: int) -> None:
        """Let the person next to the robot resume, rescue or reposition it."""
        self._end_sensor_stop(tick)
        self._rescue_if_stuck(tick)
        self._reposition_as_planned(tick)

    def _end_sensor_stop(self, tick: int) -> None:
        act = self._sensor_stop.update(self.runtime.handler.stops.active)
        if act is SensorStopAct.CARRY_AWAY:
            self._rescue(tick)
        elif act is SensorStopAct.RESUME:
            self.send(self._teacher.resume())
            self._count_alarm(tick)

    def _rescue_if_stuck(self, tick: int) -> None:
        if self.runtime.handler.stops.active is not None:
            return  # the teacher looks back; the time of the stuck detector stands still with the robot
        waiting = self.asking and self._teacher.available
        # A robot that asks again and again while it touches a wall does not get away either.
        if not (waiting and self._plan.rescues_who_asks) and self.is_stuck(waiting=waiting):
            self._rescue(tick)
            self._unknown_rescues += self.asking

    def _rescue(self, tick: int) -> None:
        self.rescue()
        self._note_unclean(tick)
        self._workload.count_manual(tick, "rescued")
        self._rescues += 1

    def _reposition_as_planned(self, tick: int) -> None:
        if self.metric.needs_reset or (self._reposition_every and tick % self._reposition_every == 0):
            self.reposition(in_sight=self.task.teaching.reposition_to == "in_sight")
            self._workload.count_manual(tick, "set_down")
        if self._show_every and self._teacher.phase is Phase.CRITIC and tick % self._show_every == 0:
            self.reposition(in_sight=True, close=True)
            self._workload.count_manual(tick, "set_down")
            for command in self._teacher.demonstrate(tick, self._shown_ticks, self._plan.shown_share):
                self.send(command)
                self._workload.count_manual(tick, "shown")

    def _command_behaviour(self, current: str) -> None:
        """Send the behaviour that the metric requires, if no mid level chooses it."""
        if self._dispatcher is None and self.metric.behaviour != current:
            self.send(self._teacher.select_behaviour(self.metric.behaviour))


def _phase_starts(plan: LessonPlan, period_s: float) -> dict[int, Phase]:
    """Return the phases by the tick in which they begin, without the first."""
    ends = accumulate(lasts_s for _, lasts_s in plan.phases)
    return {round(end_s / period_s): phase for end_s, (phase, _) in zip(ends, plan.phases[1:], strict=False)}
