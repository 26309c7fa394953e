"""Leads a robot that knows the streets about in a town, in lockstep."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from behaviors.metrics.errands import Errands, ErrandsSettings
from behaviors.metrics.town import Street
from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from hal.simulation import Pose, Simulation, WorldPlan
from kurt2rt.core.rla.rla import MID, Phase, TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Correct
from kurt2rt.core.tick import EventStore, TickRecord
from kurt2rt.experiments.lockstep.command_checks import require_carried_out
from kurt2rt.experiments.lockstep.lesson_runtime import build_lesson_runtime
from kurt2rt.experiments.lockstep.stuck_detector import StuckDetector
from kurt2rt.experiments.navigation.guided_tour import TourGuide
from kurt2rt.experiments.navigation.outcome import Place
from kurt2rt.teacher.scripted.teacher import build_teacher, view_of_tick

TRAIL_STRIDE = 20
"""Ticks between two points of a trail."""


@dataclass(frozen=True, slots=True)
class TourResult:
    """What a lesson came to."""

    teaching_s: float
    home: Pose
    named: dict[str, Street]
    """Where each name was given."""
    streets: tuple[Street | None, ...]
    """All that the robot was led through, one after the other; None where it was set down anew."""
    ways: int
    """Ways from a street to the next that were taught."""
    mid_rlas: int
    basic_rlas: int
    mid_asks: int
    missed_junctions: int
    corrections: int
    """Of the basic level."""
    rescues: int
    trail: tuple[Place, ...]
    saved: Statistics
    knowledge_hash: str


def errands_of(task: TaskSettings) -> ErrandsSettings:
    """Settings of its errands. Raises hal.settings.SettingsError for a task that has none."""
    if isinstance(task.course, ErrandsSettings) and task.mid is not None:
        return task.course
    raise SettingsError(
        "to run errands it needs the course errands, and a mid level of places", where=f"task {task.name}"
    )


def places_of(positions: Iterable[tuple[float, float]]) -> tuple[Place, ...]:
    """As they are kept."""
    return tuple((round(x_m, 3), round(y_m, 3)) for x_m, y_m in positions)


def walk_in(plan: WorldPlan, task: TaskSettings) -> Errands:
    """Who follows the robot from street to street in a world. Raises hal.settings.SettingsError."""
    return errands_of(task).walk_in(plan, task.behaviours)


async def lead_about(
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
) -> TourResult:
    """Lead the robot about for the task's whole teaching time, from where it stands; that is its home.

    The basic level is answered and corrected meanwhile, as in its own lesson. Raises LessonLostError.
    """
    period_s = settings.can.cycle_s
    walk = walk_in(simulation.plan, task)
    runtime = build_lesson_runtime(simulation, settings, task, keeper, events, statistics=statistics, saved=saved)
    session = f"errands-{seed}-after-{len(events)}"
    teacher = build_teacher(task, settings, tuple(runtime.level.repertoire), seed=seed, session=session)
    guide = TourGuide(
        walk, errands_of(task).names, task.teaching.teacher, period_s=period_s, seed=seed, session=session
    )
    way = StuckDetector(task.teaching.rescue_after_s, period_s, least_m=task.exam.stuck_within_m)
    home = simulation.pose
    unanswered_ticks = round(task.teaching.rescue_after_s / period_s)
    ticks, per_second = round(task.teaching.duration_s / period_s), round(1 / period_s)
    trail: list[tuple[float, float]] = []
    rescues = corrections = mid_asks = latched_ticks = asked_ticks = 0
    asking = False

    def after_tick(record: TickRecord) -> None:
        nonlocal rescues, corrections, mid_asks, latched_ticks, asked_ticks, asking
        require_carried_out(record, task)
        decision = record.decision
        walk.follow(simulation.pose)
        said = guide.watch(record)
        if said is not None:
            runtime.inbox.put(said)
        lesson = teacher.update(view_of_tick(record))
        if lesson is not None:
            runtime.inbox.put(lesson)
            corrections += isinstance(lesson, Correct)
        latched_ticks = latched_ticks + 1 if record.guard_result.latched else 0
        if latched_ticks == per_second:
            runtime.inbox.put(teacher.resume())
            latched_ticks = 0
        mid_asks += decision.asking and decision.asks_at == MID and not asking
        asking = decision.asking
        asked_ticks = asked_ticks + 1 if asking else 0
        if asking and asked_ticks < unanswered_ticks:
            way.restart()
        elif way.none_since_window(simulation.position):
            simulation.put(home)
            runtime.reposition()
            walk.put(home)
            guide.set_down_at_home()
            way.restart()
            rescues += 1
        if record.tick % TRAIL_STRIDE == 0:
            trail.append(simulation.position)
        if record.tick % per_second == 0:
            on_progress(record.now_s)

    walk.put(home)
    guide.begin()
    runtime.inbox.put(teacher.begin_phase(Phase.CORRECTIONS))
    await runtime.scheduler.run(ticks, after_tick)
    system = runtime.level.system
    return TourResult(
        teaching_s=ticks * period_s,
        home=home,
        named=dict(guide.named),
        streets=tuple(walk.streets),
        ways=guide.ways,
        mid_rlas=len(system.rlas_at(MID)),
        basic_rlas=len(system),
        mid_asks=mid_asks,
        missed_junctions=guide.missed,
        corrections=corrections,
        rescues=rescues,
        trail=places_of(trail),
        saved=runtime.snapshot(),
        knowledge_hash=system.knowledge_hash(),
    )
