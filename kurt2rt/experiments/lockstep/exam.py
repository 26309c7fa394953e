"""Exam: the robot drives in a world without its teacher, in lockstep."""

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from behaviors.metrics.task_metric import TaskMetric
from hal.robot_settings import RobotSettings
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.decision import ActiveBehaviour, Level
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Pursue
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.command_checks import require_carried_out
from kurt2rt.experiments.lockstep.drive_row import DriveRow, rounded_places, rounded_poses
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.faulty_sensor import SensorBreak
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime
from simbridge.contracts.simulation import Simulation


@dataclass(frozen=True, slots=True)
class ExamSetup:
    """Setup of one drive without a teacher: world, seed, and what decides, RLAs, learners or the policy."""

    world: str
    seed: int
    teacher_policy: bool = False
    """True if the teacher's own policy drives instead of the RLAs."""
    events: Sequence[TeachingEvent] = ()
    """Lessons of the robot; the policy's own drive does without them."""
    saved: Statistics | None = None
    """Values and counters of the RLAs; None: initial ones."""
    autonomous_values: Statistics | None = None
    """Values of phase 5, by which competitors on the same condition are chosen; None: those of `saved`."""
    stuck_ends: bool = True
    """False: a stuck robot is rescued and drives on, so that collisions are counted over the whole time."""
    broken: SensorBreak | None = None
    """Sensor that breaks; None: all sensors work."""
    learners: LearnerTeam | None = None
    """Taught learners that decide in place of the RLAs; None: RLAs decide."""
    appraises: bool = False
    """True if `on_tick` reads the features of the critic."""
    on_tick: Callable[[TickRecord, TaskMetric], None] = lambda _record, _metric: None
    """Called in every tick with the record and the updated metric."""

    @property
    def chance_seed(self) -> str:
        """Seed of the random choices of the course."""
        return f"course of the exam in world {self.world}, seed {self.seed}"


async def examine(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    setup: ExamSetup,
    on_progress: Callable[[float], None],
) -> DriveRow:
    """Drive for the exam's duration with the knowledge of the setup, or by the teacher's own policy.

    The mid level chooses the behaviours; without one the task's metric does.

    Args:
        on_progress: called once a second with the simulated seconds.

    Raises:
        LessonLostError: the robot refused a behaviour.
        UnknownActionError: policy or knowledge names an action that the repertoire lacks.
        UnknownBehaviourError: the knowledge names a behaviour that the task lacks.
        SettingsError: task and world do not fit.
    """
    exam = ExamRun(simulation, settings, task, setup, on_progress)
    await exam.drive()
    return exam.result()


class ExamRun(Episode):
    """Drive of one exam over the CAN bus, until its time is over, an alarm, or the robot is stuck."""

    def __init__(
        self,
        simulation: Simulation,
        settings: RobotSettings,
        task: TaskSettings,
        setup: ExamSetup,
        on_progress: Callable[[float], None],
    ) -> None:
        behaviour = ActiveBehaviour(task.behaviours)
        level: Level | None = None
        if setup.teacher_policy:
            task = task.model_copy(update={"mid": None})  # the policy chooses behaviours, too
            level = PolicyLevel(
                task.policy.build(settings.infrared),
                load_task_repertoire(task, settings),
                round(task.learning.minimum_action_s / settings.cycle_s),
                behaviour,
            )
        learners = None if setup.teacher_policy else setup.learners
        options = RuntimeOptions(
            level_override=level, active_behaviour=behaviour, learners=learners, appraises=setup.appraises
        )
        runtime = build_exam_runtime(simulation, settings, task, setup, options)
        # Learner and teacher get the same random choices; their drives diverge at the first different action.
        chance = random.Random(setup.chance_seed)
        super().__init__(simulation, runtime, chance, stuck_after_s=task.exam.stuck_after_s, on_progress=on_progress)
        if task.exam.start == "in_sight":
            self.reposition(in_sight=True)
        self._setup = setup
        self._action: str | None = None
        self._action_changes = self._stuck_times = self._first_question = self._first_collision = 0
        self._alarm = ""

    async def drive(self) -> None:
        """Drive until the end of the exam, a latched stop, or until the robot is stuck."""
        duration_s = self.task.exam.duration_s
        self._command_behaviour(self.runtime.active_behaviour.behaviour)
        await self.run(round(duration_s / self.period_s))
        self._on_progress(duration_s)
        if self._alarm or (self._stuck_times and self._setup.stuck_ends):
            self.metric.abort()

    def on_tick(self, record: TickRecord) -> None:
        """Measure the drive; end it at an alarm, and end it or rescue the robot if it is stuck.

        Raises LessonLostError if the robot refused a behaviour.
        """
        require_carried_out(record, self.task)
        if self.collided_at:
            self._first_collision = self._first_collision or record.tick
        if self.ask_positions:
            self._first_question = self._first_question or record.tick
        self._action_changes += record.decision.action != self._action
        self._action = record.decision.action
        self.measure()
        self._setup.on_tick(record, self.metric)
        if self.metric.needs_reset:
            self.reposition()
        self._command_behaviour(record.behaviour)
        if record.guard_result.latched:
            self._alarm = record.guard_result.reasons[0]
        elif stop := record.standing.stop:
            self._alarm = f"{stop.reason.value} {stop.name}".strip()
        if self._alarm:  # an exam has no teacher who could resume
            self.runtime.scheduler.end()
        elif self.is_stuck():
            self._stuck_times += 1
            if self._setup.stuck_ends:
                self.runtime.scheduler.end()
            else:
                self.rescue()

    def result(self) -> DriveRow:
        """Return the counters and measures of the drive so far."""
        simulation, metric, duration_s = self.simulation, self.metric, self.ticks * self.period_s
        return DriveRow(
            world=self._setup.world,
            seed=self._setup.seed,
            duration_s=duration_s,
            progress=metric.progress,
            unit=metric.unit,
            way_m=self.distance_travelled_m,
            collisions=simulation.collisions,
            stuck=self._stuck_times > 0,
            rescues=0 if self._setup.stuck_ends else self._stuck_times,
            share_unknown=self.unknown_ticks / self.ticks,
            questions=len(self.ask_positions),
            first_question_s=self._first_question * self.period_s,
            first_collision_s=self._first_collision * self.period_s,
            action_changes_per_s=self._action_changes / duration_s,
            trail=rounded_poses(self.trail),
            asked_at=rounded_places(self.ask_positions),
            alarm=self._alarm,
            findings={name: float(value) for name, value in metric.findings.items()},
            collided_at=rounded_places(self.collided_at),
            least_progress=self.task.metric.least_progress(simulation, self.task.exam.duration_s),
        )

    def _command_behaviour(self, current: str) -> None:
        if self.task.mid is None and self.metric.behaviour != current:
            self.send(Pursue(self.next_id("exam"), "examiner", self.metric.behaviour))


def build_exam_runtime(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    setup: ExamSetup,
    options: RuntimeOptions,
) -> Runtime:
    """Build the runtime of a robot without a teacher, with the values of `setup` and the levels of `options`.

    Raises:
        config.settings.SettingsError: settings do not fit each other.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
    """
    robot = simulation.robot
    runtime = build_runtime(
        robot if setup.broken is None else setup.broken.apply(robot, settings.infrared),
        settings,
        task,
        setup.events,
        NoTeachingAllowed(),
        LockstepClock(simulation.step),
        replace(options, checkpoint=setup.saved, teacher_available=False),
    )
    if setup.autonomous_values is not None:
        values = _values_in_phase_5(setup.autonomous_values, runtime.level.system.rlas, task)
        runtime.reinforcement.rule.restore(values)
    return runtime


def _values_in_phase_5(autonomous: Statistics, rlas: Sequence[Rla], task: TaskSettings) -> Statistics:
    """Return a value for every RLA; RLAs without a value of phase 5 get its initial value."""
    initial = task.reinforcement.alone.first_value
    return replace(autonomous, values={rla.rla_id: autonomous.values.get(rla.rla_id, initial) for rla in rlas})
