"""Navigation study: a guided tour of each robot, then drives to goals; tables and a picture of each robot."""

import random
import statistics
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from behaviors.metrics.errands import ErrandsSettings
from behaviors.metrics.streets import ALONG
from behaviors.metrics.town import Street
from kurt2rt.core.rla.statistics import StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teacher_settings import SUPERHUMAN
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_row import Place, rounded_poses
from kurt2rt.experiments.lockstep.exam import ExamSetup, build_exam_runtime
from kurt2rt.experiments.lockstep.lesson_keeping import lessons_kept
from kurt2rt.experiments.lockstep.trails import draw_way, panels_of
from kurt2rt.experiments.navigation.exam import GoalOutcome, GoalsRun, choose_goals
from kurt2rt.experiments.navigation.guided_tour import (
    HOME,
    TourCounts,
    guided_tour,
    navigation_settings,
    street_tracker,
)
from kurt2rt.experiments.route.study import basic_task_of, streets_of
from kurt2rt.experiments.study.figures import SavedFigure
from kurt2rt.experiments.study.jobs import JobParts, Outcome, StudyJob, require_places
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.report import tell_with_report
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.experiments.study.table import (
    Table,
    Told,
    Verdict,
    collisions_text,
    needed_of,
    of_text,
    reasons_against_judging,
    share_text,
    table_of,
    targets_table,
)
from kurt2rt.knowledge.journal.loading import copy_knowledge, read_lessons
from kurt2rt.platform.drive_picture import START, draw_trail
from kurt2rt.platform.save_figure import save_figure
from kurt2rt.runtime import RuntimeOptions
from simbridge.contracts.simulation import Pose, SimulationFactory

_BESIDE_M = 0.15


class ErrandsOutcome(Outcome, TourCounts):
    """Stored outcome of one robot that was led through a town and then sent to goals."""

    ways_in_all: int
    """Number of ways of the town, taught or not."""
    named: dict[str, Place]
    """Position of each name: right of the middle of its street."""
    errands: tuple[GoalOutcome, ...]
    trail: tuple[Pose, ...]
    """Trail of the errands."""

    def good(self, detour_at_most: float) -> int:
        """Return the number of goals reached by a way of at most this ratio to the shortest one."""
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
            trail=rounded_poses(run.trail),
        )


def _shown_at(street: Street) -> Place:
    """Return the position right of the middle: the opposite direction is another place."""
    along_x, along_y = ALONG[street.way]
    return street.middle.x_m + _BESIDE_M * along_y, street.middle.y_m - _BESIDE_M * along_x


def make_plan(
    task: TaskSettings, seeds: Sequence[int], parts: JobParts, *, basic_folder: Path | None = None
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


SHARE = 18 / 20
"""Required ratio of goals reached by a way that is short enough, and of robots that reach this ratio."""
_LED = "#b0b0b0"
_BOX = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": _LED, "linewidth": 0.6}


def tell(plan: StudyPlan[TaskSettings], command: str) -> Told:
    """Draw each robot and write the report into the folder of the results; return the tables.

    `command`: typed words, without those that belong to the machine alone. Raises StudyError, OSError.
    """
    task, outcomes = plan.about, [job.results.read(job, ErrandsOutcome) for job in plan.of(NavigationJob)]
    pictures = [plan.results.folder / f"{task.name}-{outcome.seed}.png" for outcome in outcomes]
    for outcome, path in zip(outcomes, pictures, strict=True):
        _draw_errands(plan.jobs[0].factory, task.exam.worlds[0], outcome, path)
    tables = list(all_tables(outcomes, navigation_settings(task), task.teaching.profile.name))
    errands = [each for run in outcomes for each in run.errands]
    good = of_text(sum(run.good(navigation_settings(task).detour_at_most) for run in outcomes), len(errands))
    sentence = f"{good} goals were reached by a way that is short enough, and never demonstrated as a whole."
    told = Told(tables, sentence, short=tables[0], files={"pictures": plan.results.folder}, data={"pictures": pictures})
    first = SavedFigure(pictures[0], f"Robot {outcomes[0].seed}", "It is the first of the seeds, and was not chosen.")
    return tell_with_report(plan.results.folder, "KURT2: errands in a town", told, command, [first])


def all_tables(
    outcomes: Sequence[ErrandsOutcome], metric: ErrandsSettings, teacher: str = SUPERHUMAN
) -> Iterator[Table]:
    """Yield all tables of the outcomes, one outcome per robot.

    `metric`: settings of the errands. `teacher`: name of the scripted teacher.
    """
    reasons = list(reasons_against_judging([each.seed for each in outcomes]))
    found = [((), verdict) for verdict in verdicts(outcomes, metric)]
    yield targets_table(found, reasons, title="Errands: what was asked")
    yield _runs_table(outcomes, metric, teacher)
    yield _robots_table(outcomes, metric)


def verdicts(runs: Sequence[ErrandsOutcome], metric: ErrandsSettings) -> Iterator[Verdict]:
    """Yield the verdicts on the drives of all robots by a plan. `metric`: settings of the errands."""
    most, goals = metric.detour_at_most, sum(len(run.errands) for run in runs)
    good, needed = sum(run.good(most) for run in runs), needed_of(SHARE, goals)
    what = f"goals reached, way at most {most:g} times the shortest"
    yield Verdict(what, of_text(needed, goals), of_text(good, goals), good >= needed)
    robots = needed_of(SHARE, len(runs))
    enough = sum(bool(run.errands) and run.good(most) >= needed_of(SHARE, len(run.errands)) for run in runs)
    asked, came = of_text(robots, len(runs)), of_text(enough, len(runs))
    yield Verdict("robots that reach so 18 of 20 of their goals", asked, came, enough >= robots)
    mean = _mean(each.detour for run in runs for each in run.reached)
    asked = f"at most {most:g} times the shortest"
    yield Verdict("way to goals that were reached, mean", asked, f"{mean:.2f}", mean <= most)


def _runs_table(outcomes: Sequence[ErrandsOutcome], metric: ErrandsSettings, teacher: str) -> Table:
    errands = [each for run in outcomes for each in run.errands]
    good, detours = sum(run.good(metric.detour_at_most) for run in outcomes), [e.detour for e in errands if e.reached]
    led = [each.demonstrated for each in errands if each.demonstrated is not None]
    shown = f"mean {_mean(led):.1f}, least {min(led):.2f} times the shortest" if led else "none"
    return table_of(
        "Goals that were never demonstrated as a whole",
        [outcomes] if errands else [],
        ("reached in time", lambda _: of_text(good, len(errands))),
        ("95 %", lambda _: share_text(good, len(errands))),
        ("reached", lambda _: len(detours)),
        ("way / shortest", lambda _: f"{_mean(detours):.2f}" if detours else ""),
        ("most", lambda _: f"{max(detours):.2f}" if detours else ""),
        ("surprises", lambda _: sum(each.surprises for each in errands)),
        ("collisions", lambda _: sum(each.collisions for each in errands)),
        words=0,
        note=f"Reached in time: without touching anything, by a way of at most {metric.detour_at_most:g} times the "
        f"shortest. Who repeats the shortest piece of the lesson that leads from start to goal: {shown}; for "
        f"{len(errands) - len(led)} goals there is no such piece. Taught by the scripted teacher {teacher}.",
    )


def _robots_table(outcomes: Sequence[ErrandsOutcome], metric: ErrandsSettings) -> Table:

    def missed(each: ErrandsOutcome) -> str:
        failed = (done for done in each.errands if not done.reached)
        return (
            ", ".join(f"{done.goal}: {done.why_not or collisions_text(done.collisions)}" for done in failed) or "none"
        )

    return table_of(
        "Each robot",
        outcomes,
        ("robot", lambda each: each.seed),
        ("led, s", lambda each: f"{each.teaching_s:.0f}"),
        ("ways", lambda each: of_text(each.ways, each.ways_in_all)),
        ("mid-level RLAs", lambda each: each.mid_rlas),
        ("asks", lambda each: each.mid_asks),
        ("missed", lambda each: each.missed_junctions),
        ("rescues", lambda each: each.rescues),
        ("reached", lambda each: of_text(each.good(metric.detour_at_most), len(each.errands))),
        ("not reached", missed),
    )


def _mean(values: Iterable[float]) -> float:
    """Return the mean; infinite without values."""
    given = list(values)
    return statistics.fmean(given) if given else float("inf")


def _draw_errands(factory: SimulationFactory, world: str, outcome: ErrandsOutcome, path: Path) -> None:
    """Draw the tour and the drives of one robot in a world, and write the picture to `path`. Raises OSError."""
    figure, (axes,) = panels_of(1, 1, (7.2, 8.0))
    label = f"led about, {outcome.teaching_s:.0f} s"
    draw_trail(axes, outcome.led, label, colour=_LED, zorder=2)
    goals = len(outcome.errands)
    draw_way(axes, factory, world, outcome.trail, label=f"errands without a teacher, {goals} goals")
    meant = {each.goal: each.reached for each in outcome.errands}
    for name, (x_m, y_m) in outcome.named.items():
        if name == HOME:
            axes.plot([x_m], [y_m], "s", color=START, fillstyle="none", mew=2.0, ms=9, zorder=6, label=HOME)
        else:
            weight = "bold" if name in meant else "normal"
            number = name.rsplit(" ", 1)[-1]
            axes.annotate(
                number, (x_m, y_m), ha="center", va="center", fontsize="x-small", weight=weight, zorder=7, bbox=_BOX
            )
    axes.set_title(
        f"robot {outcome.seed}: {len(outcome.reached)} of {goals} goals reached\n"
        f"{outcome.ways} of {outcome.ways_in_all} ways taught in {outcome.teaching_s:.0f} s",
        fontsize="medium",
    )
    figure.legend(loc="outside lower center", ncols=3, fontsize="small", frameon=False)
    save_figure(figure, path)
