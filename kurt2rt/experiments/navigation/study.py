"""Navigation study: a guided tour of each robot, then drives to goals."""

import random
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from behaviors.metrics.streets import ALONG
from behaviors.metrics.town import Street
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_row import Place, rounded_places
from kurt2rt.experiments.lockstep.exam import ExamSetup, build_exam_runtime
from kurt2rt.experiments.lockstep.lesson_keeping import lessons_kept
from kurt2rt.experiments.navigation.exam import GoalOutcome, GoalsRun, choose_goals
from kurt2rt.experiments.navigation.guided_tour import TourCounts, guided_tour, navigation_settings, street_tracker
from kurt2rt.experiments.route.study import basic_task_of, streets_of
from kurt2rt.experiments.study.jobs import JobParts, StudyJob, require_places
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.results import Outcome
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.knowledge.journal.loading import copy_knowledge, read_lessons
from kurt2rt.runtime import RuntimeOptions

_BESIDE_M = 0.15


class ErrandsOutcome(Outcome, TourCounts):
    """Outcome of one robot: a tour and drives to goals."""

    ways_in_all: int
    """Number of ways of the town, taught or not."""
    named: dict[str, Place]
    """Position of each name: right of the middle of its street."""
    errands: tuple[GoalOutcome, ...]
    trail: tuple[Place, ...]
    """Trail of the errands."""

    def good(self, detour_at_most: float) -> int:
        """Return the number of goals reached at this ratio of distances or less."""
        return sum(each.reached and each.detour <= detour_at_most for each in self.errands)

    @property
    def reached(self) -> tuple[GoalOutcome, ...]:
        """Goals that were reached, however long the way."""
        return tuple(each for each in self.errands if each.reached)


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationJob(StudyJob):
    """Guided tour of one robot, and its drives to goals."""

    outcome = ErrandsOutcome
    basic: Path
    """Knowledge of the streets; the job copies it."""

    async def measure(self, knowledge: Path, report: Report) -> ErrandsOutcome:
        """Lead the robot through the town and send it to its goals; `knowledge`: path of the file to make."""
        copy_knowledge(self.basic, knowledge)
        factory, robot, task, seed = self.factory, self.robot, self.task, self.seed
        world, whole_s = task.teaching.world, task.teaching.duration_s
        with lessons_kept(knowledge, robot, task) as keeping:
            on_progress = keeping.telling(report, f"led about world {world}", whole_s)
            with closing(factory.open(world, seed, "errands")) as simulation:
                led = await guided_tour(simulation, robot, task, keeping.training, seed=seed, on_progress=on_progress)
            keeping.end(led.saved)
            report(f"led about world {world}", whole_s, whole_s)
        events = read_lessons(knowledge, robot, task)
        exam_world = task.exam.worlds[0]
        town = street_tracker(factory.plan_of(exam_world), task).town
        start = town.street_at(led.home)
        assert start is not None  # the tour began there
        chance = random.Random(f"errands of robot {seed}")
        goals = choose_goals(town, led.named, led.streets, start, navigation_settings(task), chance)
        whole_s = len(goals) * task.exam.duration_s
        with closing(factory.open(exam_world, seed, "errands without teacher")) as simulation:
            counted = StatisticsCounter(dict(led.saved.uses), dict(led.saved.transitions))
            setup = ExamSetup(exam_world, seed, events=events, saved=led.saved)
            runtime = build_exam_runtime(simulation, robot, task, setup, RuntimeOptions(statistics=counted))

            def on_goal(done: float) -> None:
                report("errands", done * task.exam.duration_s, whole_s)

            run = GoalsRun(simulation, runtime, goals, seed=seed, on_goal=on_goal)
            errands = await run.drive(led.home)
        return ErrandsOutcome(
            made_of=self.made_of,
            seed=seed,
            **led.counts.model_dump(),
            ways_in_all=sum(len(town.on_from(street)) for street in town.streets),
            named={name: _shown_at(street) for name, street in led.named.items()},
            errands=errands,
            trail=rounded_places(run.trail),
        )


def _shown_at(street: Street) -> Place:
    """Return the position right of the middle: the opposite direction is another place."""
    along_x, along_y = ALONG[street.way]
    return street.middle.x_m + _BESIDE_M * along_y, street.middle.y_m - _BESIDE_M * along_x


def make_plan(
    task: TaskSettings,
    seeds: Sequence[int],
    parts: JobParts,
    *,
    basic_folder: Path | None = None,
) -> StudyPlan[TaskSettings]:
    """Check task and worlds, and return the jobs, a robot for each seed.

    `basic_folder`: files of robots that were taught the streets; None: the streets are taught first. Raises
    config.settings.SettingsError, StudyError for a missing file, KnowledgeError.
    """
    basic = basic_task_of(task)
    worlds = (task.teaching.world, *task.exam.worlds[:1])
    goals = navigation_settings(task).goals
    parts["factory"].require_worlds(basic.teaching.world)
    require_places(parts["factory"], task, worlds)
    fingerprints = Fingerprints(parts["factory"], parts["robot"])
    streets = streets_of(basic, seeds, parts, fingerprints, basic_folder)
    jobs = (
        NavigationJob(
            **parts,
            task=task,
            seed=seed,
            made_of=fingerprints.of(task, worlds, streets.made_of[seed]),
            name=f"{task.name}, seed {seed}",
            stem=f"{task.name}-{seed}",
            # of the goals, if each takes the whole time
            robot_time_s=task.teaching.duration_s + goals * task.exam.duration_s,
            wave=1,
            basic=streets.files[seed],
        )
        for seed in seeds
    )
    return StudyPlan(task, tuple(seeds), (*streets.jobs, *jobs))
