"""Comparison of learners: every pupil is taught as every robot, task by task, and examined after some presses."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from itertools import cycle
from math import sqrt
from pathlib import Path
from statistics import mean, median, stdev
from typing import ClassVar, NamedTuple

from matplotlib.axes import Axes
from scipy.stats import binomtest
from scipy.stats import t as students_t

from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner import Label
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.learner.learners import NoLearnerError, find_learner, source_of_learner
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import ON_BUS
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.lockstep.trails import panels_of
from kurt2rt.experiments.study.examination import Checkpoint, Examiner, run_checkpoints
from kurt2rt.experiments.study.figures import SavedFigure
from kurt2rt.experiments.study.intervals import wilson_interval
from kurt2rt.experiments.study.jobs import JobParts, StudyJob, TaughtOutcome, require_places
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.report import tell_with_report
from kurt2rt.experiments.study.study_plan import EngineRequest, Group, StudyPlan, group_by, read_groups
from kurt2rt.experiments.study.table import (
    Column,
    Table,
    Told,
    middle,
    of_text,
    reasons_against_judging,
    table_of,
    total,
)
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.platform.save_figure import save_figure
from simbridge.contracts.batch import BatchRefusedError

SHIPPED = "rla"
"""Name of the RLA system with the task's own settings, with which all others are compared."""
PUPILS = (SHIPPED, "1-nn", "k-nn", "weighted-vote", "svm", "tree")
"""Names of those that are compared unless others are named."""
_TITLES = {
    SHIPPED: "RLA, as shipped",
    "rla-door": "RLA through the door",
    "1-nn": "1-NN without R",
    "k-nn": "5-NN with R",
    "weighted-vote": "locally weighted vote with R",
    "svm": "RBF-SVM, margin gate",
    "tree": "decision tree, refitted",
}


@dataclass(frozen=True, slots=True)
class Pupil:
    """Learner that a study compares: the RLA system, or another one by name, with its gate."""

    name: str
    """`SHIPPED`, or the name of a learner."""
    gate: float | None = None
    """Number by which a learner asks, of its own unit; None: its default."""

    @classmethod
    def parse(cls, text: str) -> "Pupil":
        """Return the pupil of a text: a name, or NAME=GATE. Raises NoLearnerError."""
        name, equals, gate = text.partition("=")
        try:
            pupil = cls(name, float(gate) if equals else None)
        except ValueError as error:
            raise NoLearnerError(
                f"{gate!r} is not a number", where=f"learner {name}", do="give NAME=GATE, such as k-nn=0.8"
            ) from error
        if pupil.is_learner:
            find_learner(name)
        elif equals:
            raise NoLearnerError("has no gate", where=f"learner {name}", do="give its name alone")
        return pupil

    @property
    def is_learner(self) -> bool:
        """Return whether it is taught through the door, and not by the RLA level of the robot."""
        return self.name != SHIPPED

    @property
    def title(self) -> str:
        """Name in tables, with a gate that is not the default."""
        title = _TITLES.get(self.name, self.name)
        return title if self.gate is None else f"{title} ({self.gate:g})"

    @property
    def label(self) -> str:
        """Name that file names can hold, such as k-nn-gate-0.8."""
        name = self.name.replace(":", ".")
        return name if self.gate is None else f"{name}-gate-{self.gate:g}"

    @property
    def source(self) -> str:
        """Text that changes with all that decides its results, besides the program. Raises NoLearnerError."""
        if not self.is_learner:
            return self.label
        return f"{self.label} {source_of_learner(self.name)} scikit-learn {version('scikit-learn')}"

    def new_team(self, task: TaskSettings, robot: RobotSettings, seed: int) -> LearnerTeam | None:
        """Return learners of all behaviours of the task that know nothing; None for the RLA system.

        Raises NoLearnerError, and config.settings.SettingsError for settings that do not fit each other.
        """
        if not self.is_learner:
            return None
        setting = learner_setting(task, robot, seed=seed, gate=self.gate)
        return LearnerTeam(self.name, find_learner(self.name), setting, task.behaviours)


class PupilOutcome(TaughtOutcome):
    """Result of one robot with one learner: its lesson, and its exams at the checkpoints."""

    failure: str
    """Failure of the learner in the lesson or an exam; empty without one."""
    checkpoints: tuple[Checkpoint, ...]
    """Checkpoints after the numbers of presses asked for, ascending; the last one is at the end of the lesson."""

    @property
    def end(self) -> Checkpoint:
        """Checkpoint at the end of the lesson."""
        return self.checkpoints[-1]


@dataclass(frozen=True, slots=True, kw_only=True)
class PupilJob(StudyJob):
    """Job that teaches one robot with one learner, and examines it after some presses and at the end."""

    outcome = PupilOutcome
    keeps_knowledge: ClassVar[bool] = False
    gives_lesson: ClassVar[bool] = True
    gives_exams: ClassVar[bool] = True
    pupil: Pupil
    after: tuple[int, ...]
    """Numbers of presses after which the robot is examined, ascending."""

    async def measure(self, knowledge: Path, report: Report) -> PupilOutcome:
        """Teach and examine the robot, and return the outcome; `knowledge` is the file to teach into.

        Raises NoLearnerError, SettingsError, LessonLostError.
        """
        try:
            return await self._measure(knowledge, report)
        except BatchRefusedError:  # it does not know the task, or a learner failed
            archive_existing(knowledge)
            return await replace(self, engines=ON_BUS)._measure(knowledge, report)

    async def _measure(self, knowledge: Path, report: Report) -> PupilOutcome:
        team = self.pupil.new_team(self.task, self.robot, self.seed)
        given = await self.teach(knowledge, report, learners=team)
        failures = [team.failure if team is not None else ""]
        examiners = [Examiner(self, self.task, world, report) for world in self.task.exam.worlds]
        policies = [await each.drive_policy() for each in examiners]

        async def examine(events: Sequence[TeachingEvent], labels: Sequence[Label]) -> tuple[DriveRow, ...]:
            """Return the drives in each world, up to the first that failed: one failure decides the success."""
            team = self.pupil.new_team(self.task, self.robot, self.seed)
            if team is not None:
                team.teach_all(labels)
            drives: list[DriveRow] = []
            for examiner, policy in zip(examiners, policies, strict=True):
                drives.append(await examiner.examine(policy, events, team))
                if team is not None:
                    failures.append(team.failure)
                if drives[-1].judged and not drives[-1].passed:
                    break
            return tuple(drives)

        after = (*self.after, given.result.counts.presses)
        return PupilOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=given.result.counts,
            checkpoints=tuple(await run_checkpoints(given, after, self.robot.cycle_s, examine)),
            failure=next(filter(None, failures), ""),
        )


class Compared(NamedTuple):
    """Subject of a comparison of learners: the tasks, and the presses after which robots are examined."""

    tasks: tuple[TaskSettings, ...]
    after: tuple[int, ...]
    """Numbers of presses after which the robots are examined, besides the end, ascending."""


def make_plan(
    tasks: Sequence[TaskSettings],
    pupils: Sequence[Pupil],
    seeds: Sequence[int],
    after: Sequence[int],
    parts: JobParts,
    *,
    engine: EngineRequest = EngineRequest.CAN,
) -> StudyPlan[Compared]:
    """Check tasks and worlds, and return the jobs, a robot for each seed, task and pupil.

    The RLA system as shipped is added to `pupils`, because all others are compared with it. `after`: numbers of presses
    after which the robots are examined, ascending. Raises config.settings.SettingsError, NoLearnerError.
    """
    about = Compared(tuple(tasks), tuple(after))
    fingerprints = Fingerprints(parts["factory"], parts["robot"])
    jobs = []
    for task in tasks:
        worlds = (task.teaching.world, *task.exam.worlds)
        require_places(parts["factory"], task, worlds)
        exams = (len(after) + 2) * len(task.exam.worlds)
        for pupil in dict.fromkeys((Pupil(SHIPPED), *pupils)):
            made = fingerprints.of(task, worlds, repr(about.after), learner=pupil.source)
            jobs += [
                PupilJob(
                    **parts,
                    task=task,
                    seed=seed,
                    made_of=made,
                    name=f"{task.name}, {pupil.title}, seed {seed}",
                    stem=f"{pupil.label}/{task.name}-{seed}",
                    robot_time_s=task.teaching.duration_s + exams * task.exam.duration_s,
                    pupil=pupil,
                    after=about.after,
                )
                for seed in seeds
            ]
    return StudyPlan(about, tuple(seeds), tuple(jobs)).driven(engine, parts["robot"])


_STYLES = ("-", "--", ":", "-.")
Row = Group[tuple[str, Pupil], PupilOutcome]
"""Robots that are one pupil in one task."""


def tell(plan: StudyPlan[Compared], command: str) -> Told:
    """Draw the curves and write the report into the folder of the results; return the tables.

    `command`: typed words, without those that belong to the machine alone. Raises StudyError, OSError.
    """
    rows, figure = read_rows(plan), plan.results.folder / "compare.png"
    draw_curves(rows, plan.about, figure)
    short = table_of(
        "At the end of the lessons",
        rows,
        *_TASK,
        ("pass", _passed_text),
        middle("presses", "lesson.presses", ".0f"),
        total("collisions", "lesson.collisions"),
        words=2,
    )
    tables, reasons = list(all_tables(rows, plan)), list(reasons_against_judging(plan.seeds))
    told = Told(tables, sentence_of(rows), (), short, reasons, {"figure": figure})
    picture = SavedFigure(figure, "Robots that pass, by presses", "The band is the 95 % interval of the RLA system.")
    return tell_with_report(plan.results.folder, "KURT2: learners compared", told, command, [picture])


def sentence_of(rows: Sequence[Row]) -> str:
    """Return how many robots pass at the end of the lessons, with the RLA system and with the best other learner."""
    found = []
    for task, (shipped, *others) in group_by(rows, lambda row: row.of[0]):
        best = max(others, key=lambda row: _passed_at(row, -1), default=None)
        other = f" and {_passed_text(best)} with the best other, {best.of[1].title}" if best else ""
        found.append(f"{task}: {_passed_text(shipped)} with the RLA system{other}")
    return f"Robots that pass: {'; '.join(found)}."


def read_rows(plan: StudyPlan[Compared]) -> tuple[Row, ...]:
    """Return the results of all jobs by task and pupil. Raises StudyError if a result is missing or damaged."""
    return read_groups(plan.of(PupilJob), lambda job: (job.task.name, job.pupil), PupilOutcome)


def _judged_of(row: Row) -> tuple[PupilOutcome, ...]:
    """Return the outcomes of the robots that the policy's own drives can judge."""
    return tuple(each for each in row.rows if each.end.judged)


def _passed_at(row: Row, place: int) -> int:
    """Return the number of judged robots that pass at the checkpoint of an index."""
    return sum(each.checkpoints[place].passed for each in _judged_of(row))


def _passed_text(row: Row) -> str:
    return of_text(_passed_at(row, -1), len(_judged_of(row)))


_TASK: tuple[Column, ...] = (("task", lambda row: row.of[0]), ("learner", lambda row: row.of[1].title))


def all_tables(rows: Sequence[Row], plan: StudyPlan[Compared]) -> Iterator[Table]:
    """Yield all tables: success by presses, pairs of robots, the effort, and failures if there are any."""
    yield _success_table(rows, plan.about)
    yield paired_table(rows)
    yield table_of(
        "Effort, and safety while it is taught",
        rows,
        *_TASK,
        middle("presses", "lesson.presses", ".0f"),
        middle("questions", "lesson.asks", ".0f"),
        middle("corrections", "lesson.corrections", ".0f"),
        *(total(name, f"lesson.{name}") for name in ("collisions", "alarms", "rescues")),
        words=2,
        note=f"Medians of {len(plan.seeds)} robots; collisions, alarms and rescues of all.",
    )
    failures = [(row, each) for row in rows for each in row.rows if each.failure]
    if failures:
        yield table_of(
            "Failures of learners",
            failures,
            ("task", lambda each: each[0].of[0]),
            ("learner", lambda each: each[0].of[1].title),
            ("robot", lambda each: each[1].seed),
            ("failure", lambda each: each[1].failure),
            words=4,
        )


def _success_table(rows: Sequence[Row], about: Compared) -> Table:
    def after(heading: str, place: int) -> Column:
        return heading, lambda row: of_text(_passed_at(row, place), len(_judged_of(row)), interval=True)

    lasting = ", ".join(f"{task.name} {task.exam.duration_s:.0f} s" for task in about.tasks)
    return table_of(
        "Robots that pass, by presses",
        rows,
        *_TASK,
        *(after(f"after {presses}", place) for place, presses in enumerate(about.after)),
        after("at the end", -1),
        words=2,
        note=f"A robot passes if it passes in every world of the task's exam, without a teacher ({lasting}). The drive "
        "of the teacher's policy from the same start is the measure. A world in which it fails is left out. With 95 % "
        "intervals. A robot that needed fewer presses has all that it was taught. All see the situation with the "
        "weights of the RLAs. The RLA system has the searched settings of its task. Learners have the defaults of "
        "their classes, unless a gate is given.",
    )


def paired_table(rows: Sequence[Row]) -> Table:
    """Return the comparison of each learner with the RLA system, robot by robot, at the end of the lessons."""
    cells: list[tuple[Row, tuple[int, int], float, float, str]] = []
    for _, (shipped, *others) in group_by(rows, lambda row: row.of[0]):
        pairs = [_pairs_of(shipped.rows, row.rows) for row in others]
        p_values = [mcnemar_p(*each) for each in pairs]
        saved = [_saving_text(shipped.rows, row.rows) for row in others]
        cells += zip(others, pairs, p_values, holm(p_values), saved, strict=True)
    return table_of(
        "Compared with the RLA system as shipped, robot by robot",
        cells,
        ("task", lambda each: each[0].of[0]),
        ("learner", lambda each: each[0].of[1].title),
        ("only the RLA system passes", lambda each: each[1][0]),
        ("only the learner passes", lambda each: each[1][1]),
        ("p", lambda each: f"{each[2]:.3f}"),
        ("p by Holm", lambda each: f"{each[3]:.3f}"),
        ("presses fewer, mean (95 %)", lambda each: each[4]),
        words=2,
        note="At the end of the lessons, on the same robots. p: McNemar's exact test, two-sided; by Holm: corrected "
        "for the number of rows of the task. Presses fewer than the RLA system's: mean of the differences robot by "
        "robot, with Student's interval; below 0 the learner takes more.",
    )


def _pairs_of(first: Sequence[PupilOutcome], second: Sequence[PupilOutcome]) -> tuple[int, int]:
    """Return how many robots pass with the first of two pupils only, and with the second only.

    Robots of equal seeds are compared at the end of their lessons; those that are not judged do not count.
    """
    ends = [(one.end, other.end) for one, other in zip(first, second, strict=True)]
    judged = [(one.passed, other.passed) for one, other in ends if one.judged and other.judged]
    return judged.count((True, False)), judged.count((False, True))


def mcnemar_p(only_first: int, only_second: int) -> float:
    """Return the two-sided exact p of McNemar's test, a probability: of 1 without a robot that tells them apart."""
    apart = only_first + only_second
    return float(binomtest(only_first, apart).pvalue) if apart else 1.0


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p values corrected for their number (Holm 1979), probabilities in the order given."""
    corrected, largest = [0.0] * len(p_values), 0.0
    for rank, place in enumerate(sorted(range(len(p_values)), key=p_values.__getitem__)):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[place]))
        corrected[place] = largest
    return corrected


def _saving_text(first: Sequence[PupilOutcome], second: Sequence[PupilOutcome]) -> str:
    """Return the presses that the second of two pupils saves on robots of equal seeds; none for a single robot."""
    fewer = [one.lesson.presses - other.lesson.presses for one, other in zip(first, second, strict=True)]
    if len(fewer) < 2:
        return "-"
    middle = mean(fewer)
    half = float(students_t.ppf(0.975, len(fewer) - 1)) * stdev(fewer) / sqrt(len(fewer))
    return f"{middle:.1f} ({middle - half:.1f} to {middle + half:.1f})"


def draw_curves(rows: Sequence[Row], about: Compared, path: Path) -> None:
    """Draw a panel for each task, with a line for each pupil, as a PNG to `path`. Raises OSError.

    The last point of a line is the end of the lesson. The band is the 95 % interval of the RLA system.
    """
    tasks = about.tasks
    figure, panels = panels_of(len(tasks), 1, (9.6, 4.8))
    for axes, task in zip(panels, tasks, strict=True):
        styles = cycle(_STYLES)
        for row in rows:
            if row.of[0] == task.name and _judged_of(row):
                _draw(axes, about.after, row, next(styles))
        axes.set_ylim(-0.03, 1.03)
        axes.grid(alpha=0.3)
        axes.set_title(task.name, loc="left")
        axes.set_ylabel("share of robots that pass")
        axes.set_xlabel("presses; the last point is the end of the lesson")
        if axes.lines:
            axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    save_figure(figure, path)


def _draw(axes: Axes, after: tuple[int, ...], row: Row, style: str) -> None:
    robots, pupil = len(_judged_of(row)), row.of[1]
    shipped = pupil.name == SHIPPED
    end = median(each.lesson.presses for each in row.rows)
    # A median robot that never got so many presses has its point of the end there.
    reached = [presses for presses in after if presses < end]
    counts = [_passed_at(row, place) for place in (*range(len(reached)), len(after))]
    at, width = [*reached, end], 2.6 if shipped else 1.3
    axes.plot(at, [n / robots for n in counts], style, marker="o", markersize=4, linewidth=width, label=pupil.title)
    if shipped:
        low, high = zip(*(wilson_interval(each, robots) for each in counts), strict=True)
        axes.fill_between(at, low, high, alpha=0.15)
