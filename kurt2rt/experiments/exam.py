"""An exam: the robot drives in a world without its teacher, in lockstep."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from behaviors.policies.build import build_policy
from behaviors.repertoire import load_repertoire
from hal.robot_settings import RobotSettings
from kurt2rt.experiments.arena import Arena, Position
from kurt2rt.experiments.lesson import TRAIL_STRIDE
from kurt2rt.experiments.progress import WayMade
from kurt2rt.layers.level import Level
from kurt2rt.layers.policy_level import PolicyLevel
from kurt2rt.layers.wanted import Wanted
from kurt2rt.rla.rla import TeachingEvent
from kurt2rt.runtime import build_runtime
from kurt2rt.tasks.settings import TaskSettings
from kurt2rt.tick import TickRecord
from kurt2rt.timing.clock import LockstepClock


class NothingIsTaught:
    """The keeper of a run in which nobody teaches: an event that comes all the same is a defect."""

    trouble: str | None = None

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
    laps: float
    collisions: int
    stuck: bool
    share_unknown: float
    """Share of ticks in which the robot did not know the situation."""
    action_changes_per_s: float
    trail: tuple[Position, ...]
    unknown_positions: tuple[Position, ...]
    alarm: str = ""
    """Why the guard stopped the robot for good, which ends the exam; empty when it did not."""

    def succeeded(self, teachers_laps: float, laps_share: float) -> bool:
        """No collision, no alarm, not stuck, and enough of the laps that the teacher's own policy makes."""
        # Where the teacher gets nowhere either, standing still is no success.
        enough = self.laps > 0.0 and self.laps >= laps_share * teachers_laps
        return self.collisions == 0 and not self.stuck and not self.alarm and enough


async def examine(
    arena: Arena,
    settings: RobotSettings,
    task: TaskSettings,
    world: str,
    events: Sequence[TeachingEvent],
    *,
    seed: int,
    on_progress: Callable[[float], None],
    by_teacher: bool = False,
) -> ExamResult:
    """Drive for the exam's duration with what `events` have taught, or by the teacher's own policy."""
    period_s = settings.can.cycle_s
    wanted = Wanted(task.behaviours)
    level: Level | None = None
    if by_teacher:
        level = PolicyLevel(
            build_policy(task.policy, settings.infrared),
            load_repertoire(task.repertoire, settings),
            round(task.learning.minimum_action_s / period_s),
            wanted,
        )
    clock = LockstepClock(arena.step)
    runtime = build_runtime(
        arena.robot, settings, task, events, NothingIsTaught(), clock, level_override=level, wanted=wanted
    )
    way = WayMade(task.exam.stuck_after_s, period_s)
    trail: list[Position] = []
    unknown_positions: list[Position] = []
    unknown = changes = ticks = 0
    stuck = asking = False
    action: str | None = None
    alarm = ""

    def after_tick(record: TickRecord) -> None:
        nonlocal unknown, changes, ticks, stuck, asking, action, alarm
        decision = record.decision
        ticks = record.tick
        unknown += decision.asking
        if decision.asking and not asking:
            unknown_positions.append(arena.position)
        asking = decision.asking
        changes += decision.action != action
        action = decision.action
        if record.grant.latched:  # nobody is there to say Go
            alarm = record.grant.reasons[0]
            runtime.scheduler.end()
        elif way.none_since_window(arena.position):
            stuck = True
            runtime.scheduler.end()
        if record.tick % TRAIL_STRIDE == 0:
            trail.append(arena.position)
        if record.tick % 100 == 0:
            on_progress(record.now_s)

    await runtime.scheduler.run(round(task.exam.duration_s / period_s), after_tick)
    on_progress(task.exam.duration_s)
    return ExamResult(
        world=world,
        seed=seed,
        duration_s=ticks * period_s,
        laps=arena.laps,
        collisions=arena.collisions,
        stuck=stuck,
        share_unknown=unknown / ticks,
        action_changes_per_s=changes / (ticks * period_s),
        trail=tuple(trail),
        unknown_positions=tuple(unknown_positions),
        alarm=alarm,
    )
