"""A drive without a teacher in which surprises are counted."""

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.rla.rla import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Pursue, Resume
from kurt2rt.core.tick import TickRecord
from kurt2rt.experiments.lockstep.drive import Drive
from kurt2rt.experiments.lockstep.exam import NoTeachingAllowed
from kurt2rt.experiments.surprise.stuck_sensor import StuckSensor
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import build_runtime

Different = Literal["nothing", "stuck sensor", "set down elsewhere", "another world"]
"""What is different from the drive that expectations were learned on."""

_WHO = "experimenter"
_STUCK_FROM_S = 5.0
_SET_DOWN_EVERY_S = 10.0


@dataclass(frozen=True, slots=True)
class Surprises:
    """What one drive came to."""

    different: Different
    ends: int
    """Of RLAs that had ended often enough before, so that it can be said how surprising this one is."""
    surprising: int
    new_follow_ups: int
    """Of these ends, those in which an RLA took over that never had."""
    first_ends: int
    """Of these ends, the first after each time the robot was set down elsewhere, unless it stood there asking."""
    surprising_first_ends: int
    share_unknown: float
    """Share of ticks in which the robot did not know the situation."""


async def drive(
    stage: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    events: Sequence[TeachingEvent],
    saved: Statistics,
    *,
    world: str,
    different: Different,
    seed: int,
    duration_s: float,
    purpose: str,
    on_progress: Callable[[float], None],
) -> tuple[Surprises, Statistics]:
    """Drive, learning what to expect on; returns the count, and what was learned, to go on from.

    `saved`: what was expected before.
    """
    period_s = settings.can.cycle_s
    simulation = stage.open(world, seed, purpose)
    try:
        chance = random.Random(f"surprise {purpose} {different} {seed}")
        sensor = chance.randrange(len(settings.infrared.names))
        robot = (
            StuckSensor(simulation.robot, sensor, _STUCK_FROM_S) if different == "stuck sensor" else simulation.robot
        )
        counter = StatisticsCounter(dict(saved.uses), dict(saved.transitions))
        runtime = build_runtime(
            robot,
            settings,
            task,
            events,
            NoTeachingAllowed(),
            LockstepClock(simulation.step),
            statistics=counter,
            checkpoint=saved,
            teacher_available=False,
        )
        on_course = Drive(simulation, task, no_way_s=task.exam.stuck_after_s, period_s=period_s, chance=chance)
        set_down_every = round(_SET_DOWN_EVERY_S / period_s)
        ends = surprising = new = firsts = surprising_firsts = unknown = ticks = said = 0
        just_set_down = False

        def say(what: str) -> str:
            nonlocal said
            said += 1
            return f"{what}-{said}"

        def after_tick(record: TickRecord) -> None:
            nonlocal ends, surprising, new, firsts, surprising_firsts, unknown, ticks, just_set_down
            ticks += 1
            unknown += record.decision.asking
            surprise = record.surprise
            if surprise is not None:
                ends += 1
                surprising += surprise.surprising
                new += surprise.new_follow_up
                firsts += just_set_down
                surprising_firsts += just_set_down and surprise.surprising
            if surprise is not None or record.decision.asking:
                just_set_down = False
            if record.guard_result.latched:
                simulation.rescue()
                runtime.inbox.put(Resume(say("go"), _WHO))
            on_course.follow()
            if on_course.course.stranded:
                on_course.reposition()
            elif on_course.makes_no_way(waits=False):
                on_course.rescue()
            if on_course.course.behaviour != record.behaviour:
                runtime.inbox.put(Pursue(say("wanted"), _WHO, on_course.course.behaviour))
            if different == "set down elsewhere" and record.tick % set_down_every == 1:
                on_course.reposition(in_sight=True)
                just_set_down = True
            if record.tick % 100 == 0:
                on_progress(record.now_s)

        await runtime.scheduler.run(round(duration_s / period_s), after_tick)
        counted = Surprises(different, ends, surprising, new, firsts, surprising_firsts, unknown / max(ticks, 1))
        return counted, runtime.snapshot()
    finally:
        simulation.close()
