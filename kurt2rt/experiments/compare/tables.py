"""Tables and figure of a comparison."""

from collections.abc import Iterator, Sequence
from itertools import cycle
from math import sqrt
from pathlib import Path
from statistics import mean, median, stdev

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import binomtest
from scipy.stats import t as students_t

from kurt2rt.experiments.compare.study import SHIPPED, Compared, Pupil, PupilJob, PupilOutcome
from kurt2rt.experiments.study.figures import save
from kurt2rt.experiments.study.intervals import wilson_interval
from kurt2rt.experiments.study.study_plan import Group, StudyPlan, group_by, read_groups
from kurt2rt.experiments.study.table import Column, Table, Told, middle, of_text, table_of, total
from kurt2rt.experiments.study.targets import reasons_against_judging

_STYLES = ("-", "--", ":", "-.")
Row = Group[tuple[str, Pupil], PupilOutcome]
"""Robots that are one pupil in one task."""


def tell(plan: StudyPlan[Compared]) -> Told:
    """Draw the curves into the folder of the results; return the tables. Raises StudyError, OSError."""
    rows, figure = read_rows(plan), plan.results.folder / "compare.png"
    draw_curves(rows, plan.about, figure)
    return Told(list(all_tables(rows, plan)), list(reasons_against_judging(plan.seeds)), {"figure": figure})


def read_rows(plan: StudyPlan[Compared]) -> tuple[Row, ...]:
    """Return the results of all jobs by task and pupil. Raises StudyError if a result is missing or damaged."""
    return read_groups(plan.of(PupilJob), lambda job: (job.task.name, job.pupil), PupilOutcome)


def _judged_of(row: Row) -> tuple[PupilOutcome, ...]:
    """Return the outcomes of the robots that the policy's own drives can judge."""
    return tuple(each for each in row.rows if each.end.judged)


def passed_at(row: Row, place: int) -> int:
    """Return the number of judged robots that pass at the checkpoint of an index."""
    return sum(each.checkpoints[place].passed for each in _judged_of(row))


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
        return heading, lambda row: of_text(passed_at(row, place), len(_judged_of(row)), interval=True)

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
        pairs = [pairs_of(shipped.rows, row.rows) for row in others]
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


def pairs_of(first: Sequence[PupilOutcome], second: Sequence[PupilOutcome]) -> tuple[int, int]:
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
    figure = Figure(figsize=(9.6, 4.8 * len(tasks)), layout="constrained")
    panels = figure.subplots(len(tasks), 1, squeeze=False).flatten().tolist()
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
    save(figure, path)


def _draw(axes: Axes, after: tuple[int, ...], row: Row, style: str) -> None:
    robots, pupil = len(_judged_of(row)), row.of[1]
    shipped = pupil.name == SHIPPED
    end = median(each.lesson.presses for each in row.rows)
    # A median robot that never got so many presses has its point of the end there.
    reached = [presses for presses in after if presses < end]
    counts = [passed_at(row, place) for place in (*range(len(reached)), len(after))]
    at, width = [*reached, end], 2.6 if shipped else 1.3
    axes.plot(at, [n / robots for n in counts], style, marker="o", markersize=4, linewidth=width, label=pupil.title)
    if shipped:
        low, high = zip(*(wilson_interval(each, robots) for each in counts), strict=True)
        axes.fill_between(at, low, high, alpha=0.15)
