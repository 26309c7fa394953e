"""Transfer study: presses until a robot that was taught at home is right in a new world."""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import ClassVar, NamedTuple

from matplotlib.figure import Figure

from config.settings import SettingsError
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.study.examination import Checkpoint, Examiner, run_checkpoints
from kurt2rt.experiments.study.figures import SavedFigure
from kurt2rt.experiments.study.intervals import wilson_interval
from kurt2rt.experiments.study.jobs import JobParts, StudyJob, TaughtOutcome, require_places, world_of
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.report import tell_with_report
from kurt2rt.experiments.study.study_plan import EngineRequest, Group, StudyPlan, read_groups
from kurt2rt.experiments.study.table import (
    Column,
    Table,
    Told,
    Verdict,
    collisions_text,
    middle,
    needed_of,
    of_text,
    reasons_against_judging,
    share,
    table_of,
    targets_table,
    total,
)
from kurt2rt.knowledge.journal.loading import copy_knowledge, read_lessons
from kurt2rt.platform.save_figure import save_figure

AFTER = (0, 2, 5, 10, 15, 20)
"""Numbers of presses after which a robot is examined."""
RIGHT_SHARE = 18 / 20
"""Share of the robots that are to be right in the new world."""
MOST_PRESSES = 10
"""Presses until right that half of the robots may need at most."""
PURPOSE = "new-world"
"""Purpose of the simulation in which a robot is taught on: another start and other noise than at home."""


class Transfer(NamedTuple):
    """Subject of a transfer study: the task of home, and the presses after which robots are examined."""

    task: TaskSettings
    places: tuple[str, ...]
    """Names of new worlds; SEED in a name stands for the robot's seed."""
    after: tuple[int, ...] = AFTER
    """Numbers of presses after which a robot is examined in the new world, ascending."""
    seconds: float | None = None
    """Longest time of teaching there in s; None: that of the lesson at home."""

    def task_in(self, world: str) -> TaskSettings:
        """Return the task to teach and examine in a new world."""
        teaching = self.task.teaching.model_copy(update={"world": world})
        exam = self.task.exam.model_copy(update={"worlds": (world,)})
        return self.task.model_copy(update={"teaching": teaching, "exam": exam})

    @property
    def lasts_s(self) -> float:
        """Longest time of teaching in a new world."""
        return self.seconds or self.task.teaching.duration_s


class HomeOutcome(TaughtOutcome):
    """Stored outcome of a robot taught and examined in its home world, with the policy's drive there."""

    lessons: int
    """Teaching events at home."""
    home: DriveRow
    """Exam at home."""
    policy: DriveRow
    """Policy's own drive there."""


class TransferOutcome(TaughtOutcome):
    """Stored outcome of a robot that was taught on in a new world after its lesson at home."""

    checkpoints: tuple[Checkpoint, ...]
    """Checkpoints in ascending order of presses."""
    policy: DriveRow
    """Policy's own drive in the new world."""
    home_when_right: DriveRow
    """Exam at home with the knowledge of the first exam passed in the new world, or without one of the end."""
    home: DriveRow
    """Exam at home at the end."""

    @property
    def judged(self) -> bool:
        """True if the exams in the new world have verdicts."""
        return self.checkpoints[0].judged

    @property
    def presses_until_right(self) -> float:
        """Smallest count of presses after which an exam in the new world was passed; infinite if none was."""
        return min((each.presses for each in self.checkpoints if each.passed), default=math.inf)

    @property
    def seconds_until_right(self) -> float:
        """Time of teaching up to that exam's knowledge, in s; infinite if no exam was passed, 0 without a press."""
        first = next((each for each in self.checkpoints if each.passed), None)
        return math.inf if first is None else first.teaching_s if first.presses else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeJob(StudyJob):
    """Job that teaches a robot at home and examines it there; the jobs of new worlds continue from it."""

    outcome = HomeOutcome
    gives_lesson: ClassVar[bool] = True
    gives_exams: ClassVar[bool] = True

    async def measure(self, knowledge: Path, report: Report) -> HomeOutcome:
        """Teach the robot at home into the file `knowledge`, examine it there and return the outcome."""
        lesson, events = await self.teach(knowledge, report)
        at_home = _examiner(self, self.task, report)
        policy = await at_home.drive_policy()
        return HomeOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=lesson.counts,
            lessons=len(events),
            home=await at_home.examine(policy, events),
            policy=policy,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferJob(StudyJob):
    """Job that teaches a robot on in a new world, and examines it there after some presses, and at home.

    The task is that of home.
    """

    outcome = TransferOutcome
    gives_exams: ClassVar[bool] = True
    about: Transfer
    place: str
    """Name of the new world, with SEED where it is another world for each robot."""
    home: HomeJob
    """Job of an earlier wave, which taught the robot at home; its knowledge is copied."""

    async def measure(self, knowledge: Path, report: Report) -> TransferOutcome:
        """Teach on in the new world into the file `knowledge`, examine the robot and return the outcome.

        Raises StudyError without the result of home, and the errors of all jobs.
        """
        task, after = self.about.task_in(world_of(self.place, self.seed)), self.about.after
        copy_knowledge(self.home.knowledge, knowledge)
        known = len(read_lessons(knowledge, self.robot, task))
        # It ends before another press; a robot with knowledge is corrected from the beginning.
        plan = LessonPlan(((Phase.CORRECTIONS, self.about.lasts_s),), purpose=PURPOSE, most_presses=max(after))
        given = await self.teach(knowledge, report, task, plan)
        lesson, events = given
        there = _examiner(self, task, report)
        policy = await there.drive_policy()

        async def examine(events: Sequence[TeachingEvent], _labels: object) -> tuple[DriveRow, ...]:
            return (await there.examine(policy, events),)

        checkpoints = await run_checkpoints(given, after, self.robot.cycle_s, examine, known=known)
        at_end = checkpoints[-1].lessons
        when_right = next((each.lessons for each in checkpoints if each.passed), at_end)
        homes = {n: await self._drive_at_home(events[: known + n], report) for n in {at_end, when_right}}
        return TransferOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=lesson.counts.model_copy(update={"presses": min(lesson.counts.presses, max(after))}),
            checkpoints=tuple(checkpoints),
            policy=policy,
            home_when_right=homes[when_right],
            home=homes[at_end],
        )

    async def _drive_at_home(self, events: Sequence[TeachingEvent], report: Report) -> DriveRow:
        """Examine the robot at home, unless it knows exactly what it knew when it was examined there."""
        before = self.results.read(self.home, HomeOutcome)
        if len(events) == before.lessons:
            return before.home
        return await _examiner(self, self.task, report).examine(before.policy, events)


def _examiner(job: StudyJob, task: TaskSettings, report: Report) -> Examiner:
    """Return the examiner of a robot in the world that a task is taught in."""
    return Examiner(job, task, task.teaching.world, report)


def make_plan(
    about: Transfer, seeds: Sequence[int], parts: JobParts, *, engine: EngineRequest = EngineRequest.CAN
) -> StudyPlan[Transfer]:
    """Check task and worlds, and return the jobs: each seed's robot at home, and in each new world on the CAN bus.

    Raises config.settings.SettingsError if the task and a world do not fit, or a new world is that of home.
    """
    task, home = about.task, about.task.teaching.world
    worlds = [world_of(place, seed) for place in about.places for seed in seeds]
    if home in worlds:
        raise SettingsError("is the world of home, not a new one", where=f"world {home}", do="name another one")
    require_places(parts["factory"], task, (home, *worlds))
    fingerprints, exam_s = Fingerprints(parts["factory"], parts["robot"]), task.exam.duration_s
    made_at_home = fingerprints.of(task, (home,))
    home_jobs = {
        seed: HomeJob(
            **parts,
            task=task,
            seed=seed,
            made_of=made_at_home,
            name=f"{task.name} at home, seed {seed}",
            stem=f"home/{task.name}-{seed}",
            robot_time_s=task.teaching.duration_s + 2 * exam_s,
        )
        for seed in seeds
    }

    def job(place: str, seed: int) -> TransferJob:
        world = world_of(place, seed)
        own = about.task_in(world).teaching.model_dump_json(serialize_as_any=True)
        file_name = re.sub(r"[^A-Za-z0-9_-]+", "-", Path(place).with_suffix("").as_posix()).strip("-")
        return TransferJob(
            **parts,
            task=task,
            seed=seed,
            made_of=fingerprints.of(task, (home, world), own, repr((about.after, about.lasts_s))),
            name=f"{task.name} in {world}, seed {seed}",
            stem=f"{file_name}/{task.name}-{seed}",
            robot_time_s=about.lasts_s + (len(about.after) + 3) * exam_s,
            wave=1,
            about=about,
            place=place,
            home=home_jobs[seed],
        )

    there = (job(place, seed) for place in dict.fromkeys(about.places) for seed in seeds)
    plan = StudyPlan(about, tuple(seeds), (*home_jobs.values(), *there))
    return plan.driven(engine, parts["robot"])


_COLOUR = "#1f6fb2"
There = Group[str, TransferOutcome]
"""Robots in one kind of new world."""


@dataclass(frozen=True, slots=True)
class TransferStudy:
    """Stored outcomes of a transfer study, at home and in each new world, with their plan."""

    plan: StudyPlan[Transfer]
    home: Group[str, HomeOutcome]
    """Robots at home, in the order of the seeds."""
    there: tuple[There, ...]


def read_study(plan: StudyPlan[Transfer]) -> TransferStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    (home,) = read_groups(plan.of(HomeJob), lambda job: job.task.teaching.world, HomeOutcome)
    return TransferStudy(plan, home, read_groups(plan.of(TransferJob), lambda job: job.place, TransferOutcome))


def tell(plan: StudyPlan[Transfer], command: str) -> Told:
    """Draw the curves and write the report into the folder of the results; return the tables.

    `command`: typed words, without those that belong to the machine alone. Raises StudyError, OSError.
    """
    study, figure = read_study(plan), plan.results.folder / "transfer.png"
    draw_curves(study, figure)
    tables, after = list(all_tables(study)), plan.about.after
    right = "; ".join(
        f"in {each.of} {_right_after(each, after[0])} after {after[0]} presses there, and after {after[-1]} "
        f"{of_text(_right_after(each, after[-1]), len(_judged_of(each)), interval=True)}"
        for each in study.there
    )
    reasons = list(reasons_against_judging(plan.seeds))
    told = Told(tables, f"Robots that are right: {right}.", (), tables[0], reasons, {"figure": figure})
    caption = "The band is the 95 % interval."
    picture = SavedFigure(figure, "Robots that are right in the new world, by presses there", caption)
    title = f"KURT2: {plan.about.task.name.replace('_', ' ')} in a new world"
    return tell_with_report(plan.results.folder, title, told, command, [picture])


def all_tables(study: TransferStudy) -> Iterator[Table]:
    """Yield all tables: what was asked, the curve, the teaching, and each robot."""
    found = [((each.of,), verdict) for each in study.there for verdict in verdicts(each, study)]
    yield targets_table(found, list(reasons_against_judging(study.plan.seeds)), headings=("new world",))
    yield _curve_table(study)
    yield _teaching_table(study)
    for each in study.there:
        yield _robots_table(each, study)


def _judged_of(group: There) -> tuple[TransferOutcome, ...]:
    return tuple(each for each in group.rows if each.judged)


def _right_after(group: There, presses: int) -> int:
    return sum(point.passed for each in _judged_of(group) for point in each.checkpoints if point.presses == presses)


def _right_by(group: There, presses: int) -> int:
    return sum(each.presses_until_right <= presses for each in _judged_of(group))


def verdicts(group: There, study: TransferStudy) -> Iterator[Verdict]:
    """Yield the verdicts on robots with the knowledge of home; none if no exam has a verdict."""
    judged, robots = _judged_of(group), len(group.rows)
    if not judged:
        return
    presses = study.plan.about.after[-1]
    right, needed = _right_by(group, presses), needed_of(RIGHT_SHARE, len(judged))
    asked, came = f"at least {of_text(needed, len(judged))}", of_text(right, len(judged))
    yield Verdict(f"right there by {presses} presses", asked, came, right >= needed)
    until = median(each.presses_until_right for each in judged)
    shown = f"{until:g}" if math.isfinite(until) else f"more than {presses}"
    yield Verdict("presses until right, median", f"at most {MOST_PRESSES}", shown, until <= MOST_PRESSES)
    after = sum(each.home_when_right.passed for each in group.rows)
    yield Verdict("right at home then, too", of_text(robots, robots), of_text(after, robots), after == robots)


def _curve_table(study: TransferStudy) -> Table:
    policy = share("", "policy.passed")[1]
    rows = [
        row
        for each in study.there
        for row in ((each, "taught on", policy(each), _right_after), (each, "until right", "", _right_by))
    ]

    def after(presses: int) -> Column:
        return f"after {presses}", lambda row: of_text(row[3](row[0], presses), len(_judged_of(row[0])), interval=True)

    return table_of(
        "Robots that are right in the new world, by presses there",
        rows,
        ("new world", lambda row: row[0].of),
        ("taught how", lambda row: row[1]),
        ("policy", lambda row: row[2]),
        *map(after, study.plan.about.after),
        words=2,
        note=f"Exams of {study.plan.about.task.exam.duration_s:.0f} s without a teacher, with 95 % intervals. "
        "Until right: as if teaching ended with the first exam that was passed; the best of several flatters. "
        "A robot that needed fewer presses has all that it was taught. Policy: own drives of the teacher's policy "
        "without collision or standstill, with enough junctions right. A robot whose policy fails there is not "
        "judged and not counted.",
    )


def _teaching_table(study: TransferStudy) -> Table:
    task, after, home = study.plan.about.task, study.plan.about.after, study.home.of

    def until(name: str, form: str, never: str) -> Callable[[There], str]:
        def cell(group: There) -> str:
            values = [getattr(robot, name) for robot in _judged_of(group)]
            return "" if not values else f"{median(values):{form}}" if math.isfinite(median(values)) else never

        return cell

    return table_of(
        "Presses until right, and home",
        study.there,
        ("new world", lambda each: each.of),
        ("presses until right", until("presses_until_right", "g", f"more than {after[-1]}")),
        ("seconds until right", until("seconds_until_right", ".0f", "never")),
        middle("presses", "lesson.presses"),
        middle("asks", "lesson.asks"),
        total("collisions meanwhile", "lesson.collisions"),
        (f"right in {home} before", lambda _: share("", "home.passed")[1](study.home)),
        share("when right there", "home_when_right.passed"),
        share("at the end", "home.passed"),
        note=f"Medians of {len(study.plan.seeds)} robots; collisions of all. Presses until right: the fewest of those "
        f"examined after which the exam was passed. Taught at home, in {home}, by the scripted teacher "
        f"{task.teaching.profile.name}, in {task.teaching.duration_s:.0f} s and "
        f"{middle('', 'lesson.presses')[1](study.home)} presses (median).",
    )


def _robots_table(group: There, study: TransferStudy) -> Table:
    before = {each.seed: each.home for each in study.home.rows}

    def after(place: int) -> Callable[[TransferOutcome], str]:
        return lambda robot: drive_text(robot.checkpoints[place].drives[0])

    return table_of(
        f"Each robot: {group.of}",
        group.rows,
        ("robot", lambda robot: robot.seed),
        ("new world", lambda robot: robot.lesson.world),
        ("presses", lambda robot: robot.lesson.presses),
        ("asks", lambda robot: robot.lesson.asks),
        ("policy", lambda robot: drive_text(robot.policy)),
        *((f"after {presses}", after(place)) for place, presses in enumerate(study.plan.about.after)),
        ("home before", lambda robot: drive_text(before[robot.seed])),
        ("when right there", lambda robot: drive_text(robot.home_when_right)),
        ("at the end", lambda robot: drive_text(robot.home)),
        words=2,
    )


def drive_text(drive: DriveRow) -> str:
    """Return one drive in few words: right, or why it is not."""
    if drive.passed:
        return "right"
    if not drive.judged:
        return "not judged"
    if drive.collisions:
        return collisions_text(drive.collisions)
    if drive.alarm:
        return drive.alarm
    if drive.stuck:
        return f"stuck at {drive.duration_s:.0f} s"
    return f"{drive.right_share:.0%} of junctions right" if 0.0 < drive.right_share < 1.0 else "slow"


def draw_curves(study: TransferStudy, path: Path) -> None:
    """Draw the curves, a panel for each new world, as a PNG to `path`. Raises OSError."""
    figure = Figure(figsize=(5.4 * len(study.there), 5.0), layout="constrained")
    panels = figure.subplots(1, len(study.there), squeeze=False, sharey=True).flatten().tolist()
    after = study.plan.about.after
    for axes, group in zip(panels, study.there, strict=True):
        if judged := len(_judged_of(group)):
            axes.plot(after, [_right_by(group, n) / judged for n in after], color=_COLOUR, linestyle=":", linewidth=1.2)
            counts = [_right_after(group, presses) for presses in after]
            low, high = zip(*(wilson_interval(count, judged) for count in counts), strict=True)
            axes.plot(after, [count / judged for count in counts], color=_COLOUR, marker="o", label=f"n = {judged}")
            axes.fill_between(after, low, high, color=_COLOUR, alpha=0.15)
            axes.legend(fontsize="small", loc="upper center", bbox_to_anchor=(0.5, -0.14), frameon=False)
        axes.set_title(f"new world: {Path(group.of).stem}", fontsize="medium")
        axes.set_xlabel("presses in the new world (dotted: taught until right)")
        axes.set_ylim(-0.03, 1.03)
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("share of robots that are right there")
    save_figure(figure, path)
