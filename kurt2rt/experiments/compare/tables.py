"""Tables and figure of a comparison."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle
from math import sqrt
from pathlib import Path
from statistics import mean, median, stdev

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import binomtest
from scipy.stats import t as students_t

from kurt2rt.experiments.compare.pupil import SHIPPED, Pupil
from kurt2rt.experiments.compare.study import Compared, PupilJob, PupilOutcome
from kurt2rt.experiments.study.figures import save
from kurt2rt.experiments.study.intervals import wilson_interval
from kurt2rt.experiments.study.study_plan import Group, StudyPlan, read_groups
from kurt2rt.experiments.study.table import Table, of_text, table_of

_STYLES = ("-", "--", ":", "-.")
Row = Group[tuple[str, Pupil], PupilOutcome]
"""Robots that are one pupil in one task."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """Plan and outcomes of a comparison."""

    plan: StudyPlan[Compared]
    rows: tuple[Row, ...]

    def of_task(self, task: str) -> tuple[Row, tuple[Row, ...]]:
        """Return the row of the RLA system as shipped, which is the first of each task, and the task's other rows.

        `task`: name of a task of the plan; ValueError for any other.
        """
        shipped, *others = (row for row in self.rows if row.of[0] == task)
        return shipped, tuple(others)


def read_comparison(plan: StudyPlan[Compared]) -> Comparison:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    return Comparison(plan, read_groups(plan.of(PupilJob), lambda job: (job.task.name, job.pupil), PupilOutcome))


def judged_of(row: Row) -> tuple[PupilOutcome, ...]:
    """Return the outcomes of the robots that the policy's own drives can judge."""
    return tuple(each for each in row.outcomes if each.checkpoints[-1].judged)


def passed_at(row: Row, place: int) -> int:
    """Return the number of judged robots that pass at the checkpoint of an index."""
    return sum(each.checkpoints[place].passed for each in judged_of(row))


def all_tables(comparison: Comparison) -> Iterator[Table]:
    """Yield all tables: success by presses, pairs of robots, the effort, and failures if there are any."""
    yield success_table(comparison)
    yield paired_table(comparison)
    yield effort_table(comparison)
    failures = [(row, each) for row in comparison.rows for each in row.outcomes if each.failure]
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


def success_table(comparison: Comparison) -> Table:
    """Return the robots that pass in all worlds, by presses, with 95 % intervals."""
    tasks, after = comparison.plan.about
    rows = []
    for row in comparison.rows:
        passed = (passed_at(row, place) for place in range(len(after) + 1))
        rows.append((*_heading(row), *(of_text(count, len(judged_of(row)), interval=True) for count in passed)))
    lasting = ", ".join(f"{task.name} {task.exam.duration_s:.0f} s" for task in tasks)
    return Table(
        "Robots that pass, by presses",
        ("task", "learner", *(f"after {presses}" for presses in after), "at the end"),
        tuple(rows),
        words=2,
        note=f"A robot passes if it passes in every world of the task's exam, without a teacher ({lasting}). The drive "
        "of the teacher's policy from the same start is the measure. A world in which it fails is left out. With 95 % "
        "intervals. A robot that needed fewer presses has all that it was taught. All see the situation with the "
        "weights of the RLAs. The RLA system has the searched settings of its task. Learners have the defaults of "
        "their classes, unless a gate is given.",
    )


def paired_table(comparison: Comparison) -> Table:
    """Return the comparison of each learner with the RLA system, robot by robot, at the end of the lessons."""
    rows = []
    for task in comparison.plan.about.tasks:
        shipped, others = comparison.of_task(task.name)
        pairs = [pairs_of(shipped.outcomes, row.outcomes) for row in others]
        p_values = [mcnemar_p(*each) for each in pairs]
        for row, pair, p_value, corrected in zip(others, pairs, p_values, holm(p_values), strict=True):
            saved = _saving_text(shipped.outcomes, row.outcomes)
            rows.append((*_heading(row), *map(str, pair), f"{p_value:.3f}", f"{corrected:.3f}", saved))
    return Table(
        "Compared with the RLA system as shipped, robot by robot",
        (
            *("task", "learner", "only the RLA system passes", "only the learner passes", "p", "p by Holm"),
            "presses fewer, mean (95 %)",
        ),
        tuple(rows),
        words=2,
        note="At the end of the lessons, on the same robots. p: McNemar's exact test, two-sided; by Holm: corrected "
        "for the number of rows of the task. Presses fewer than the RLA system's: mean of the differences robot by "
        "robot, with Student's interval; below 0 the learner takes more.",
    )


def effort_table(comparison: Comparison) -> Table:
    """Return the effort of the teacher, and collisions and alarms while the robots were taught."""

    def middle(row: Row, name: str) -> str:
        return f"{median(getattr(each.lesson, name) for each in row.outcomes):.0f}"

    return table_of(
        "Effort, and safety while it is taught",
        comparison.rows,
        ("task", lambda row: row.of[0]),
        ("learner", lambda row: row.of[1].title),
        ("presses", lambda row: middle(row, "presses")),
        ("questions", lambda row: middle(row, "asks")),
        ("corrections", lambda row: middle(row, "corrections")),
        ("collisions", lambda row: sum(each.lesson.collisions for each in row.outcomes)),
        ("alarms", lambda row: sum(each.lesson.alarms for each in row.outcomes)),
        ("rescues", lambda row: sum(each.lesson.rescues for each in row.outcomes)),
        words=2,
        note=f"Medians of {len(comparison.plan.seeds)} robots; collisions, alarms and rescues of all.",
    )


def pairs_of(first: Sequence[PupilOutcome], second: Sequence[PupilOutcome]) -> tuple[int, int]:
    """Return how many robots pass with the first of two pupils only, and with the second only.

    Robots of equal seeds are compared at the end of their lessons; those that are not judged do not count.
    """
    ends = [(one.checkpoints[-1], other.checkpoints[-1]) for one, other in zip(first, second, strict=True)]
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


def _heading(row: Row) -> tuple[str, str]:
    return row.of[0], row.of[1].title


def draw_curves(comparison: Comparison, path: Path) -> None:
    """Draw a panel for each task, with a line for each pupil, as a PNG to `path`. Raises OSError.

    The last point of a line is the end of the lesson. The band is the 95 % interval of the RLA system.
    """
    tasks = comparison.plan.about.tasks
    figure = Figure(figsize=(9.6, 4.8 * len(tasks)), layout="constrained")
    panels = figure.subplots(len(tasks), 1, squeeze=False).flatten().tolist()
    for axes, task in zip(panels, tasks, strict=True):
        styles = cycle(_STYLES)
        for row in comparison.rows:
            if row.of[0] == task.name and judged_of(row):
                _draw(axes, comparison.plan.about.after, row, next(styles))
        axes.set_ylim(-0.03, 1.03)
        axes.grid(alpha=0.3)
        axes.set_title(task.name, loc="left")
        axes.set_ylabel("share of robots that pass")
        axes.set_xlabel("presses; the last point is the end of the lesson")
        if axes.lines:
            axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    save(figure, path)


def _draw(axes: Axes, after: tuple[int, ...], row: Row, style: str) -> None:
    robots, pupil = len(judged_of(row)), row.of[1]
    shipped = pupil.name == SHIPPED
    end = median(each.lesson.presses for each in row.outcomes)
    # A median robot that never got so many presses has its point of the end there.
    reached = [presses for presses in after if presses < end]
    counts = [passed_at(row, place) for place in (*range(len(reached)), len(after))]
    at, width = [*reached, end], 2.6 if shipped else 1.3
    axes.plot(at, [n / robots for n in counts], style, marker="o", markersize=4, linewidth=width, label=pupil.title)
    if shipped:
        low, high = zip(*(wilson_interval(each, robots) for each in counts), strict=True)
        axes.fill_between(at, low, high, alpha=0.15)
