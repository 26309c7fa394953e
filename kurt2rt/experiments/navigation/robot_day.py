"""Guided tour of one robot, then its drives to goals."""

import random
from collections.abc import Iterable, Sequence
from contextlib import closing
from pathlib import Path

from behaviors.metrics.streets import ALONG
from behaviors.metrics.town import Street, Town
from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.lesson_keeping import lessons_kept
from kurt2rt.experiments.lockstep.runtimes import build_unattended_runtime
from kurt2rt.experiments.navigation.exam import GoalsRun
from kurt2rt.experiments.navigation.goals import choose_goals
from kurt2rt.experiments.navigation.guided_tour import TourResult, guided_tour, navigation_settings, street_tracker
from kurt2rt.experiments.navigation.outcome import ErrandsOutcome, ErrandsRun, Place, Strategy
from kurt2rt.knowledge.journal.loading import read_lessons

PLANNING: tuple[Strategy, ...] = ("planning",)
CONTROLS: tuple[Strategy, ...] = ("chance", "first taught")
_BESIDE_M = 0.15


async def teach_and_send(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    knowledge: Path,
    *,
    seed: int,
    strategies: Sequence[Strategy],
    report: Report,
) -> ErrandsOutcome:
    """Teach into a file that holds the streets, and send the robot to its goals once by each strategy.

    Args:
        factory: opens the simulations.
        task: with errands.
        knowledge: path of the file.
        seed: of robot, guide and teacher.
        strategies: ways to choose the next street.
        report: progress callback.

    Raises:
        KnowledgeError: the file cannot be read.
        hal.settings.SettingsError: the task has no goals, or the world no streets.
        LessonLostError: the robot refused a command, or a lesson was not stored.
    """
    world, whole_s = task.teaching.world, task.teaching.duration_s
    with lessons_kept(knowledge, settings, task) as keeping:
        on_progress = keeping.telling(report, f"led about world {world}", whole_s)
        with closing(factory.open(world, seed, "errands")) as simulation:
            led = await guided_tour(simulation, settings, task, keeping.training, seed=seed, on_progress=on_progress)
        keeping.end(led.saved)
        report(f"led about world {world}", whole_s, whole_s)
    events = read_lessons(knowledge, settings, task)
    exam_world = task.exam.worlds[0]
    town = street_tracker(factory.plan_of(exam_world), task).town
    start = town.street_at(led.home)
    assert start is not None  # the tour began there
    chance = random.Random(f"errands of robot {seed}")
    goals = choose_goals(town, led.named, led.streets, start, navigation_settings(task), chance)
    runs = []
    for how in strategies:
        with closing(factory.open(exam_world, seed, "errands without teacher")) as simulation:
            runtime = build_unattended_runtime(simulation, settings, task, events, led.saved)

            def on_goal(done: float, how: Strategy = how) -> None:
                report(f"errands by {how}", done * task.exam.duration_s, len(goals) * task.exam.duration_s)

            run = GoalsRun(simulation, runtime, goals, how=how, seed=seed, on_goal=on_goal)
            runs.append(await run.drive(led.home))
    return _outcome(seed, led, town, runs)


def _outcome(seed: int, led: TourResult, town: Town, runs: Iterable[ErrandsRun]) -> ErrandsOutcome:
    return ErrandsOutcome(
        seed=seed,
        teaching_s=led.teaching_s,
        ways=led.ways,
        ways_in_all=sum(len(town.on_from(street)) for street in town.streets),
        mid_rlas=led.mid_rlas,
        basic_rlas=led.basic_rlas,
        mid_asks=led.mid_asks,
        missed_junctions=led.missed_junctions,
        corrections=led.corrections,
        rescues=led.rescues,
        named={name: _shown_at(street) for name, street in led.named.items()},
        led=led.trail,
        knowledge_hash=led.knowledge_hash,
        runs=tuple(runs),
    )


def _shown_at(street: Street) -> Place:
    """Return the position right of the middle: the opposite direction is another place."""
    along_x, along_y = ALONG[street.way]
    return street.middle.x_m + _BESIDE_M * along_y, street.middle.y_m - _BESIDE_M * along_x
