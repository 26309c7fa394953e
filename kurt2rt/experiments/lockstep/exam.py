"""An exam: the robot drives in a world without its teacher, in lockstep."""

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT, Findings, TaskMetric
from hal.robot_settings import RobotSettings
from hal.simulation import Position, Simulation
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.decision.level import Level
from kurt2rt.core.rla.rla import Rla, TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import SuccessSettings, TaskSettings
from kurt2rt.core.teaching.commands import Pursue
from kurt2rt.core.tick import TickRecord
from kurt2rt.experiments.lockstep.command_checks import require_carried_out
from kurt2rt.experiments.lockstep.drive import Drive
from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.lockstep.lesson import TRAIL_STRIDE
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import build_runtime


class NoTeachingAllowed:
    """The keeper of a run in which nobody teaches: an event that comes all the same is a defect."""

    error: str | None = None

    def submit(self, event: TeachingEvent) -> None:
        """Refuse it, loudly."""
        raise RuntimeError(f"a lesson was given in an exam: {event}")


@dataclass(frozen=True, slots=True)
class ExamResult:
    """How one drive went."""

    world: str
    seed: int
    duration_s: float
    """Of the drive, to its end or to where the robot was stuck."""
    progress: float
    unit: str
    """What progress is counted in."""
    way_m: float
    collisions: int
    stuck: bool
    share_unknown: float
    """Share of ticks in which the robot did not know the situation."""
    action_changes_per_s: float
    trail: tuple[Position, ...]
    unknown_positions: tuple[Position, ...]
    alarm: str = ""
    """Why the guard stopped the robot for good, which ends the exam; empty when it did not."""
    findings: Findings = field(default_factory=dict)
    """What the course measured besides."""
    collision_positions: tuple[Position, ...] = ()
    rescues: int = 0
    """How often it was stuck and set down elsewhere, where that does not end the exam."""
    least_progress: float = 0.0
    """A drive that comes no farther gets nowhere: no other drive is measured by it."""

    def verdict(self, teachers_progress: float, success: SuccessSettings) -> ExamVerdict:
        """Return the verdict on this drive, measured by the progress of the teacher's own policy from the same start.

        A drive passes with no more collisions than allowed, no alarm, not stuck, and with enough progress.
        """
        if teachers_progress <= self.least_progress:
            return ExamVerdict.NOT_JUDGED
        enough = self.progress > 0.0 and self.progress >= success.progress_share * teachers_progress
        right = self.right_share >= success.right_at_least
        clean = self.collisions <= success.collisions_at_most and not self.stuck and not self.alarm
        return ExamVerdict.PASSED if clean and enough and right else ExamVerdict.FAILED

    @property
    def failed(self) -> bool:
        """Whether it collided, got stuck or was stopped by the guard for good."""
        return self.collisions > 0 or self.stuck or bool(self.alarm)

    @property
    def got_nowhere(self) -> bool:
        """Whether the progress is too small to measure another drive by."""
        return self.progress <= self.least_progress

    @property
    def right_share(self) -> float:
        """Share of the junctions that were left as asked; 0 where there were none."""
        junctions = self.findings.get(JUNCTIONS, 0.0)
        return self.findings.get(RIGHT, 0.0) / junctions if junctions else 0.0


async def examine(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    world: str,
    events: Sequence[TeachingEvent],
    *,
    seed: int,
    on_progress: Callable[[float], None],
    by_teacher: bool = False,
    saved: Statistics | None = None,
    alone: Statistics | None = None,
    stuck_ends: bool = True,
    on_record: Callable[[TickRecord], None] = lambda _: None,
    on_course: Callable[[TickRecord, TaskMetric], None] = lambda _record, _course: None,
) -> ExamResult:
    """Drive for the exam's duration with what `events` have taught, or by the teacher's own policy.

    `saved`: what rewards had made of that. `alone`: what phase 5 held RLAs to be worth, where the exam follows it: of
    several on the very same condition the best by this one answers, as it would there.
    `stuck_ends`: else a robot that is stuck is set down at the nearest start pose and goes on, so that collisions are
    those of the whole time; it has got stuck all the same. `on_record` sees every tick,
    `on_course` also how the course stands after it.
    What is wanted is the examiner's to say, or the mid level's where there is one.
    Raises LessonLostError when the robot refuses what the course asks of it, and UnknownActionError for a policy that
    names an action which the repertoire lacks.
    """
    period_s = settings.can.cycle_s
    wanted = ActiveBehaviour(task.behaviours)
    level: Level | None = None
    if by_teacher:
        task = task.model_copy(update={"mid": None})  # its place is the teacher's, too
        level = PolicyLevel(
            task.policy.build(settings.infrared),
            load_task_repertoire(task, settings),
            round(task.learning.minimum_action_s / period_s),
            wanted,
        )
    clock = LockstepClock(simulation.step)
    runtime = build_runtime(
        simulation.robot,
        settings,
        task,
        events,
        NoTeachingAllowed(),
        clock,
        level_override=level,
        active_behaviour=wanted,
        checkpoint=saved,
        teacher_available=False,
    )
    if alone is not None:
        runtime.reinforcement.rule.restore(_worths_in_phase_5(alone, runtime.level.system.rlas, task))
    # Learner and teacher are given the same chance; what is asked of them parts when their ways do.
    chance = random.Random(f"course of the exam in world {world}, seed {seed}")
    drive = Drive(simulation, task, no_way_s=task.exam.stuck_after_s, period_s=period_s, chance=chance)
    if task.exam.start == "in_sight":
        drive.reposition(in_sight=True)
    trail: list[Position] = []
    unknown_positions: list[Position] = []
    collision_positions: list[Position] = []
    unknown = changes = ticks = stuck = 0
    asking = False
    action: str | None = None
    alarm = ""
    said = 0

    def say_what_is_wanted(now: str) -> None:
        nonlocal said
        if task.mid is None and drive.course.behaviour != now:
            said += 1
            runtime.inbox.put(Pursue(f"exam-{said}", "examiner", drive.course.behaviour))

    def after_tick(record: TickRecord) -> None:
        nonlocal unknown, changes, ticks, stuck, asking, action, alarm
        require_carried_out(record, task)
        on_record(record)
        decision = record.decision
        ticks = record.tick
        unknown += decision.asking
        if decision.asking and not asking:
            unknown_positions.append(simulation.position)
        asking = decision.asking
        collision_positions.extend([simulation.position] * (simulation.collisions - len(collision_positions)))
        changes += decision.action != action
        action = decision.action
        drive.follow()
        on_course(record, drive.course)
        if drive.course.stranded:
            drive.reposition()
        say_what_is_wanted(record.behaviour)
        if record.guard_result.latched:  # nobody is there to say Go
            alarm = record.guard_result.reasons[0]
            runtime.scheduler.end()
        elif drive.makes_no_way(waits=False):
            stuck += 1
            if stuck_ends:
                runtime.scheduler.end()
            else:
                drive.rescue()
        if record.tick % TRAIL_STRIDE == 0:
            trail.append(simulation.position)
        if record.tick % 100 == 0:
            on_progress(record.now_s)

    say_what_is_wanted(wanted.behaviour)
    await runtime.scheduler.run(round(task.exam.duration_s / period_s), after_tick)
    on_progress(task.exam.duration_s)
    if alarm or (stuck and stuck_ends):
        drive.course.end_early()
    return ExamResult(
        world=world,
        seed=seed,
        duration_s=ticks * period_s,
        progress=drive.course.progress,
        unit=drive.course.unit,
        way_m=drive.way_m,
        collisions=simulation.collisions,
        stuck=stuck > 0,
        rescues=0 if stuck_ends else stuck,
        share_unknown=unknown / ticks,
        action_changes_per_s=changes / (ticks * period_s),
        trail=tuple(trail),
        unknown_positions=tuple(unknown_positions),
        alarm=alarm,
        findings=drive.course.findings,
        collision_positions=tuple(collision_positions),
        least_progress=task.course.least_progress(simulation, task.exam.duration_s),
    )


def _worths_in_phase_5(alone: Statistics, rlas: Sequence[Rla], task: TaskSettings) -> Statistics:
    """Of every RLA: those that phase 5 has said nothing of are worth there what they began with."""
    began_with = task.reinforcement.alone.first_value
    return replace(alone, values={rla.rla_id: alone.values.get(rla.rla_id, began_with) for rla in rlas})
