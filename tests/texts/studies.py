"""Listings of the sentences below the tables of lessons, exams and studies."""

from collections.abc import Iterator

from kurt2rt.experiments.lockstep.drive_row import ExamVerdict
from kurt2rt.experiments.navigation.study import all_tables as navigation_tables
from kurt2rt.experiments.paper.tables import paper_targets_table
from kurt2rt.experiments.phases.steps import Step
from kurt2rt.experiments.phases.tables import phases_targets_table, words_of_controls
from kurt2rt.experiments.study.exam_tables import verdict_text
from kurt2rt.experiments.study.table import reasons_against_judging
from kurt2rt.experiments.transfer import all_tables as transfer_tables
from tests.experiments.navigation import test_tables as navigation
from tests.experiments.navigation.test_goals import settings
from tests.experiments.paper import test_tables as paper
from tests.experiments.phases.outcomes import exam, stage, study, teaching
from tests.experiments.route import test_tables as route
from tests.experiments.rows import judged, row
from tests.experiments.transfer import test_tables as transfer


def targets() -> Iterator[tuple[str, str]]:
    """Yield name, requirement, measured value and result of each target."""
    found = {"junctions": 100.0, "junctions right": 95.0}
    streets = paper.summary_of("streets", [paper.robot(1, 92, paper.drive("manhattan", findings=found))])
    walls = paper.summary_of("wall_following", [paper.robot(1, 92, paper.drive("a"), paper.drive("b", judged=False))])
    for label, table in (
        ("paper", paper_targets_table([streets, walls], "targets")),
        ("phases", phases_targets_table(study(2), [])),
        ("route", route.study([route.outcome(seed) for seed in range(100, 120)])[0]),
        ("errands", next(navigation_tables([navigation.robot(1, *navigation.GOOD)], settings()))),
        ("transfer", next(transfer_tables(transfer.robots(*[transfer.RIGHT_AT_ONCE] * 20)))),
    ):
        yield from ((f"{label} {number}", " | ".join(row)) for number, row in enumerate(table.rows, 1))


def results() -> Iterator[tuple[str, str]]:
    """Yield the texts of verdicts on exams."""
    yield from ((f"exam {verdict}", verdict.text) for verdict in ExamVerdict)


def reasons() -> Iterator[tuple[str, str]]:
    """Yield the reasons against judging a study."""
    for label, seeds in (("one robot", (100,)), ("too few", range(100, 119)), ("known seeds", range(79, 99))):
        yield label, " ".join(reasons_against_judging(seeds))


def exams() -> Iterator[tuple[str, str]]:
    """Yield the line of an exam."""
    good, stuck = judged(), {"stuck": True, "duration_s": 123.0}
    for label, result in (
        ("passed", good),
        ("one collision", judged(collisions=1)),
        ("stuck", judged(collisions=2, **stuck)),
        ("alarm", good.model_copy(update={"alarm": "bus lost"})),
        ("teacher failed", good.model_copy(update={"teacher": row(progress=9.0, stuck=True)})),
        ("not judged", judged(0.0)),
    ):
        yield label, verdict_text(result)


def controls() -> Iterator[tuple[str, str]]:
    """Yield the sentences on controls without effect."""
    silent = [stage(Step.ASKS, exam(progress=7.0), taught=teaching(asks=0)) for _ in range(2)]
    for label, made in (("all equal", study(2)), ("no questions", study(2, asks=silent))):
        yield label, " ".join(words_of_controls(made))
