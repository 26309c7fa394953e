"""Tables of a comparison."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import sqrt
from statistics import mean, median, stdev

from scipy.stats import binomtest
from scipy.stats import t as students_t

from kurt2rt.experiments.compare.jobs import PupilOutcome
from kurt2rt.experiments.compare.plan import Comparison, Row
from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.study.table import Table


def all_tables(comparison: Comparison) -> Iterator[Table]:
    """Yield all tables: success by presses, pairs of robots, the effort, and failures if there are any."""
    yield success_table(comparison)
    yield paired_table(comparison)
    yield effort_table(comparison)
    if any(each.failure for row in comparison.rows for each in row.outcomes):
        yield failure_table(comparison)


def success_table(comparison: Comparison) -> Table:
    """Return the robots that pass in all worlds, by presses, with 95 % intervals."""
    plan = comparison.plan

    def cells(row: Row) -> Iterator[str]:
        robots = len(row.judged)
        for count in map(row.passed, range(len(plan.after) + 1)):
            low, high = wilson_interval(count, robots) if robots else (0.0, 1.0)
            yield f"{count} of {robots} ({low:.0%} to {high:.0%})" if robots else "none judged"

    lasting = ", ".join(f"{task.name} {task.exam.duration_s:.0f} s" for task in plan.tasks)
    return Table(
        "Robots that pass, by presses",
        ("task", "learner", *(f"after {presses}" for presses in plan.after), "at the end"),
        _rows(comparison, cells),
        words=2,
        note=f"A robot passes if it passes in every world of the task's exam, without a teacher ({lasting}), judged by "
        "the drive of the teacher's policy from the same start; a world in which the policy does not pass is left out. "
        "With 95 % intervals. A robot that gave cause for fewer presses has all that it was taught. All see the "
        "situation with the weights of the RLAs. The RLA system has the settings of its task, which were searched; "
        "learners have the defaults of their classes, unless a gate is given.",
    )


def paired_table(comparison: Comparison) -> Table:
    """Return the comparison of each learner with the RLA system, robot by robot, at the end of the lessons."""
    rows = []
    for task in comparison.plan.tasks:
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
    medians: Sequence[tuple[str, Callable[[PupilOutcome], float]]] = (
        ("presses", lambda each: each.presses),
        ("questions", lambda each: each.asks),
        ("corrections", lambda each: each.corrections),
    )

    def cells(row: Row) -> Iterator[str]:
        for _, value in medians:
            yield f"{median(map(value, row.outcomes)):.0f}"
        yield str(sum(each.collisions for each in row.outcomes))
        yield str(sum(each.alarms for each in row.outcomes))
        yield str(sum(each.rescues for each in row.outcomes))

    return Table(
        "Effort, and safety while it is taught",
        ("task", "learner", *(name for name, _ in medians), "collisions", "alarms", "rescues"),
        _rows(comparison, cells),
        words=2,
        note=f"Medians of {len(comparison.plan.seeds)} robots; collisions, alarms and rescues of all.",
    )


def failure_table(comparison: Comparison) -> Table:
    """Return the failures of learners, a row for each robot."""
    failures = (
        (*_heading(row), str(each.seed), each.failure)
        for row in comparison.rows
        for each in row.outcomes
        if each.failure
    )
    return Table("Failures of learners", ("task", "learner", "robot", "failure"), tuple(failures), words=4)


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
    fewer = [one.presses - other.presses for one, other in zip(first, second, strict=True)]
    if len(fewer) < 2:
        return "-"
    middle = mean(fewer)
    half = float(students_t.ppf(0.975, len(fewer) - 1)) * stdev(fewer) / sqrt(len(fewer))
    return f"{middle:.1f} ({middle - half:.1f} to {middle + half:.1f})"


def _heading(row: Row) -> tuple[str, str]:
    return row.entry.task, row.entry.pupil.title


def _rows(comparison: Comparison, cells: Callable[[Row], Iterable[str]]) -> tuple[tuple[str, ...], ...]:
    return tuple((*_heading(row), *cells(row)) for row in comparison.rows)
