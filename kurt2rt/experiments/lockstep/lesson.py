"""A lesson: a scripted teacher teaches the robot in lockstep."""

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import accumulate

from behaviors.metrics.task_metric import Findings
from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from hal.simulation import Position, Simulation
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.rla.rla import MID, Phase, Rla, TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Command, DeleteRla, Resume, Reward
from kurt2rt.core.tick import EventStore, TickRecord
from kurt2rt.experiments.lockstep.command_checks import require_carried_out
from kurt2rt.experiments.lockstep.compatibility import route_of
from kurt2rt.experiments.lockstep.drive import Drive
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.experiments.lockstep.lesson_runtime import build_lesson_runtime
from kurt2rt.experiments.lockstep.primitives import primitives
from kurt2rt.experiments.lockstep.teacher_workload import TeacherWorkload, WorkloadMinute
from kurt2rt.platform.ledger import TickTimer
from kurt2rt.teacher.scripted.appraiser import (
    FeedbackTiming,
    JudgeReward,
    RandomPenalty,
    RewardSource,
    ScriptedAppraiser,
    UnknownPenalty,
)
from kurt2rt.teacher.scripted.dispatcher import ScriptedDispatcher
from kurt2rt.teacher.scripted.teacher import build_teacher

TRAIL_STRIDE = 10
"""Ticks between two points of a trail."""
_AGREEMENT_EVERY_S = 10


@dataclass(frozen=True, slots=True)
class TrainingResult:
    """What a lesson came to."""

    seed: int
    world: str
    teaching_s: float
    rlas: tuple[Rla, ...]
    knowledge_hash: str
    asks: int
    corrections: int
    rescues: int
    statistics: StatisticsCounter
    growth: tuple[int, ...]
    """Number of RLAs after each second of teaching."""
    trail: tuple[Position, ...]
    ask_positions: tuple[Position, ...]
    ledger: TickTimer = field(compare=False, repr=False)
    """Where the time of its last ticks went, on the machine that ran it."""
    alarms: int = 0
    """How often the guard stopped the robot for good, and its teacher said Go."""
    repositions: int = 0
    """How often the robot was set down elsewhere, rescues left out."""
    deletions: int = 0
    """RLAs that the teacher deleted."""
    progress: float = 0.0
    unit: str = ""
    """What progress is counted in."""
    findings: Findings = field(default_factory=dict)
    """What the course measured besides."""
    load: tuple[WorkloadMinute, ...] = ()
    """What the teacher said, minute by minute."""
    praise: int = 0
    blame: int = 0
    refused_signals: int = 0
    """Praise and blame that came too late, when nothing was there any more that it could be about."""
    collisions: int = 0
    unknown_rescues: int = 0
    """Of the rescues, those of a robot that stood in a situation it did not know, and nobody was there to be asked."""
    share_unknown: float = 0.0
    """Share of ticks in which the robot did not know the situation."""
    agreement: tuple[float | None, ...] = ()
    """How far the critic agrees with its teacher, after each ten seconds; None while too little was heard."""
    share_trusted: float = 0.0
    """Share of ticks in which the critic was trusted."""
    saved: Statistics = field(default_factory=Statistics, compare=False, repr=False)
    """All that was counted and valued, as it is saved."""
    mid_rlas: tuple[Rla, ...] = ()
    """Of the mid level; `rlas` are those of the basic one."""
    mid_asks: int = 0
    """Of the asks, those of the mid level."""
    mid_corrections: int = 0
    """`corrections` are those of the basic level."""
    missed_junctions: int = 0
    """Those that the mid level did not notice."""
    alone: Statistics | None = field(default=None, compare=False, repr=False)
    """What phase 5 held RLAs to be worth at its end; None where the lesson ended in another phase."""


async def teach(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    keeper: EventStore,
    events: Sequence[TeachingEvent],
    *,
    seed: int,
    on_progress: Callable[[float], None],
    statistics: StatisticsCounter | None = None,
    saved: Statistics | None = None,
    plan: LessonPlan | None = None,
) -> TrainingResult:
    """Teach the task for its whole duration; what was taught goes to `keeper`.

    `events`: what an earlier lesson taught, to go on from there; `statistics`: what was counted then, to count on;
    `saved`: what rewards had made of it. `plan`: None: the task's own, phases 1 and 2.
    `on_progress` gets simulated seconds. Raises LessonLostError for a lesson that the robot refused.
    """
    plan = plan or plan_of(task)
    period_s = settings.can.cycle_s
    runtime = build_lesson_runtime(simulation, settings, task, keeper, events, statistics=statistics, saved=saved)
    session = f"{plan.purpose}-{seed}-after-{len(events)}"
    teacher = _teacher_of(plan, task, settings, tuple(runtime.level.repertoire), seed=seed, session=session)
    dispatcher = None
    if task.mid is not None:
        dispatcher = ScriptedDispatcher(
            task.behaviours, task.teaching.teacher, period_s=period_s, seed=seed, session=session
        )
    critics = runtime.handler.agreement
    chance = random.Random(f"course of {session}")
    rescue_s = task.teaching.rescue_after_s if plan.rescue_after_s is None else plan.rescue_after_s
    drive = Drive(simulation, task, no_way_s=rescue_s, period_s=period_s, chance=chance)
    in_sight = task.teaching.reposition_to == "in_sight"
    reposition_s = task.teaching.reposition_every_s if plan.reposition_every_s is None else plan.reposition_every_s
    reposition_every = round(reposition_s / period_s)
    set_down_every = round(plan.set_down_every_s / period_s)
    shown = round(plan.shown_s / period_s)
    ticks = round(plan.duration_s / period_s)
    begins = _begins(plan, period_s)
    ticks_per_second = round(1 / period_s)
    load = TeacherWorkload(ticks, period_s)
    growth: list[int] = []
    trail: list[Position] = []
    ask_positions: list[Position] = []
    agreement: list[float | None] = []
    asking = False
    rescues = unknown_rescues = alarms = latched_ticks = deletions = refused = unknown = trusted = praise = blame = 0
    mid_asks = 0

    def say(command: Command, tick: int) -> None:
        nonlocal deletions, praise, blame
        runtime.inbox.put(command)
        load.note(tick, command)
        deletions += isinstance(command, DeleteRla)
        if isinstance(command, Reward):
            praise += command.value > 0
            blame += command.value < 0

    def lift_alarm(tick: int) -> None:
        nonlocal alarms, latched_ticks
        load.note_hands(tick, "go")
        latched_ticks = 0
        alarms += 1

    def enter(phase: Phase) -> None:
        runtime.inbox.put(teacher.begin_phase(phase))
        if dispatcher is not None:
            dispatcher.phase = phase
            if not plan.corrects_basic:
                teacher.stop_correcting()

    def after_tick(record: TickRecord) -> None:
        nonlocal asking, mid_asks, rescues, unknown_rescues, latched_ticks, refused, unknown, trusted
        refused += require_carried_out(record, task, may_be_late=teacher.is_signal)
        if record.tick in begins:
            enter(begins[record.tick])
        latched_ticks = latched_ticks + 1 if record.guard_result.latched else 0
        for command in teacher.on_tick(record):
            say(command, record.tick)
            if isinstance(command, Resume) and record.guard_result.latched:  # what he had shown ended in an alarm
                lift_alarm(record.tick)
        if dispatcher is not None:
            said = dispatcher.on_tick(record, route_of(drive.course, task).ahead)
            if said is not None:
                say(said, record.tick)
        if latched_ticks == ticks_per_second:  # he has seen what is wrong, and that it is over or not
            runtime.inbox.put(teacher.resume())
            lift_alarm(record.tick)
        if record.decision.asking and not asking:
            ask_positions.append(simulation.position)
            mid_asks += record.decision.asks_at == MID
        asking = record.decision.asking
        unknown += asking
        trusted += critics is not None and critics.trusted
        drive.follow()
        waits = asking and teacher.available
        # A robot that is pressed to a wall and asks again and again is no nearer to getting away.
        if not (waits and plan.rescues_who_asks) and drive.makes_no_way(waits=waits):
            drive.rescue()
            load.note_hands(record.tick, "rescued")
            rescues += 1
            unknown_rescues += asking
        if drive.course.stranded or (reposition_every and record.tick % reposition_every == 0):
            drive.reposition(in_sight=in_sight)
            load.note_hands(record.tick, "set_down")
        if set_down_every and teacher.phase is Phase.CRITIC and record.tick % set_down_every == 0:
            drive.reposition(in_sight=True, close=True)
            load.note_hands(record.tick, "set_down")
            for command in teacher.demonstrate(record.tick, shown, plan.shown_share):
                runtime.inbox.put(command)
                load.note_hands(record.tick, "shown")
        if dispatcher is None and drive.course.behaviour != record.behaviour:
            runtime.inbox.put(teacher.select_behaviour(drive.course.behaviour))
        if record.tick % TRAIL_STRIDE == 0:
            trail.append(simulation.position)
        if record.tick % ticks_per_second == 0:
            growth.append(len(runtime.level.system))
            on_progress(record.now_s)
        if record.tick % (_AGREEMENT_EVERY_S * ticks_per_second) == 0:
            agreement.append(None if critics is None else critics.share)

    if dispatcher is None and drive.course.behaviour != runtime.active_behaviour.behaviour:
        runtime.inbox.put(teacher.select_behaviour(drive.course.behaviour))
    if plan.phases[0][0] is not teacher.phase:
        enter(plan.phases[0][0])
    await runtime.scheduler.run(ticks, after_tick)
    system = runtime.level.system
    return TrainingResult(
        seed=seed,
        world=task.teaching.world,
        teaching_s=ticks * period_s,
        rlas=system.rlas,
        knowledge_hash=system.knowledge_hash(),
        asks=len(ask_positions),
        corrections=runtime.handler.corrections,
        rescues=rescues,
        statistics=runtime.statistics,
        growth=tuple(growth),
        trail=tuple(trail),
        ask_positions=tuple(ask_positions),
        ledger=runtime.timer,
        alarms=alarms,
        repositions=drive.repositions,
        deletions=deletions,
        progress=drive.course.progress,
        unit=drive.course.unit,
        findings=drive.course.findings,
        load=load.minutes,
        praise=praise,
        blame=blame,
        refused_signals=refused,
        collisions=simulation.collisions,
        unknown_rescues=unknown_rescues,
        share_unknown=unknown / max(ticks, 1),
        agreement=tuple(agreement),
        share_trusted=trusted / max(ticks, 1),
        saved=runtime.snapshot(),
        mid_rlas=system.rlas_at(MID),
        mid_asks=mid_asks,
        mid_corrections=runtime.handler.corrections_at(MID),
        missed_junctions=0 if dispatcher is None else dispatcher.missed,
        alone=runtime.reinforcement.worths_alone() if teacher.phase is Phase.AUTONOMOUS else None,
    )


def _begins(plan: LessonPlan, period_s: float) -> dict[int, Phase]:
    """The tick in which each phase but the first is told to begin."""
    ends = accumulate(lasts_s for _, lasts_s in plan.phases)
    return {round(end_s / period_s): phase for end_s, (phase, _) in zip(ends, plan.phases[1:], strict=False)}


def _teacher_of(
    plan: LessonPlan,
    task: TaskSettings,
    settings: RobotSettings,
    actions: tuple[str, ...],
    *,
    seed: int,
    session: str,
) -> ScriptedAppraiser:
    period_s, times = settings.can.cycle_s, plan.times
    rewards: RewardSource | None = None
    if plan.signs == "unknown":
        rewards = UnknownPenalty()
    elif plan.signs == "chance":
        # What is meant in the last second would be said when the lesson is over.
        last_s = plan.duration_s - task.teaching.teacher.reaction_s
        rewards = RandomPenalty(
            plan.blame_by_chance, round(last_s / period_s), round(times.bad_every_s / period_s), seed
        )
    elif plan.signs == "judge":
        if task.judge is None:
            raise SettingsError(
                "there is no judge, so nobody can praise or blame", where=f"task {task.name}", do="add `judge:`"
            )
        rewards = JudgeReward(task.judge.build(), round(times.patience_s / period_s))
    every_s = {-1: times.bad_every_s, 0: times.neutral_every_s, 1: times.good_every_s}
    timing = FeedbackTiming(
        reaction=round(task.teaching.teacher.reaction_s / period_s),
        every={value: round(each_s / period_s) for value, each_s in every_s.items()},
        gap=round(times.gap_s / period_s),
        max_punishments=times.most_blame,
    )
    # Where several opinions are worth the same, the first one says it.
    named = {value: name for name, value in reversed(load_critic(task.critic).values.items())} if rewards else {}
    answering = build_teacher(task, settings, actions, seed=seed, session=session)
    return ScriptedAppraiser(
        answering, timing, rewards, named, session=session, seed=seed, demonstrated=primitives(task.repertoire)
    )
