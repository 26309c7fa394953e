"""A lesson: a scripted teacher teaches the robot, phases 1 and 2, in lockstep."""

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from hal.robot_settings import RobotSettings
from kurt2rt.experiments.arena import Arena, Position
from kurt2rt.experiments.courses.course import Findings
from kurt2rt.experiments.drive import Drive
from kurt2rt.experiments.refusals import require_carried_out
from kurt2rt.rla.rla import Phase, Rla, TeachingEvent
from kurt2rt.rla.statistics import StatisticsCounter
from kurt2rt.runtime import build_runtime
from kurt2rt.tasks.settings import TaskSettings
from kurt2rt.teaching.commands import DeleteRla
from kurt2rt.teaching.scripted_teacher import picture_of, teacher_of
from kurt2rt.tick import LessonKeeper, TickRecord
from kurt2rt.timing.clock import LockstepClock
from kurt2rt.timing.ledger import Ledger

TRAIL_STRIDE = 10
"""Ticks between two points of a trail."""


@dataclass(frozen=True, slots=True)
class LessonResult:
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
    ledger: Ledger = field(compare=False, repr=False)
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


async def teach(
    arena: Arena,
    settings: RobotSettings,
    task: TaskSettings,
    keeper: LessonKeeper,
    events: Sequence[TeachingEvent],
    *,
    seed: int,
    on_progress: Callable[[float], None],
    statistics: StatisticsCounter | None = None,
) -> LessonResult:
    """Teach the task for its whole duration; what was taught goes to `keeper`.

    `events`: what an earlier lesson taught, to go on from there; `statistics`: what was counted then, to count on.
    `on_progress` gets simulated seconds. Raises LessonLostError for a lesson that the robot refused.
    """
    period_s = settings.can.cycle_s
    clock = LockstepClock(arena.step)
    runtime = build_runtime(arena.robot, settings, task, events, keeper, clock, statistics=statistics)
    session = f"lesson-{seed}-after-{len(events)}"
    teacher = teacher_of(task, settings, tuple(runtime.level.repertoire), seed=seed, session=session)
    chance = random.Random(f"course of {session}")
    drive = Drive(arena, task, no_way_s=task.teaching.rescue_after_s, period_s=period_s, chance=chance)
    in_sight = task.teaching.reposition_to == "in_sight"
    reposition_every = round(task.teaching.reposition_every_s / period_s)
    ticks = round(task.teaching.duration_s / period_s)
    corrections_from = round(task.teaching.supervised_s / period_s)
    ticks_per_second = round(1 / period_s)
    growth: list[int] = []
    trail: list[Position] = []
    ask_positions: list[Position] = []
    asking = False
    rescues = alarms = latched_ticks = deletions = 0

    def after_tick(record: TickRecord) -> None:
        nonlocal asking, rescues, alarms, latched_ticks, deletions
        require_carried_out(record, task)
        if record.tick == corrections_from:
            runtime.inbox.put(teacher.enter(Phase.CORRECTIONS))
        command = teacher.watch(picture_of(record))
        if command is not None:
            runtime.inbox.put(command)
            deletions += isinstance(command, DeleteRla)
        latched_ticks = latched_ticks + 1 if record.grant.latched else 0
        if latched_ticks == ticks_per_second:  # he has seen what is wrong, and that it is over or not
            runtime.inbox.put(teacher.go())
            latched_ticks = 0
            alarms += 1
        if record.decision.asking and not asking:
            ask_positions.append(arena.position)
        asking = record.decision.asking
        drive.follow()
        if drive.makes_no_way(waits=asking):
            drive.rescue()
            rescues += 1
        if drive.course.stranded or (reposition_every and record.tick % reposition_every == 0):
            drive.reposition(in_sight=in_sight)
        if drive.course.behaviour != record.behaviour:
            runtime.inbox.put(teacher.pursue(drive.course.behaviour))
        if record.tick % TRAIL_STRIDE == 0:
            trail.append(arena.position)
        if record.tick % ticks_per_second == 0:
            growth.append(len(runtime.level.system))
            on_progress(record.now_s)

    if drive.course.behaviour != runtime.wanted.behaviour:
        runtime.inbox.put(teacher.pursue(drive.course.behaviour))
    await runtime.scheduler.run(ticks, after_tick)
    system = runtime.level.system
    return LessonResult(
        seed=seed,
        world=task.teaching.world,
        teaching_s=ticks * period_s,
        rlas=system.rlas,
        knowledge_hash=system.knowledge_hash(),
        asks=len(ask_positions),
        corrections=runtime.school.corrections,
        rescues=rescues,
        statistics=runtime.statistics,
        growth=tuple(growth),
        trail=tuple(trail),
        ask_positions=tuple(ask_positions),
        ledger=runtime.ledger,
        alarms=alarms,
        repositions=drive.repositions,
        deletions=deletions,
        progress=drive.course.progress,
        unit=drive.course.unit,
        findings=drive.course.findings,
    )
