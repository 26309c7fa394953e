"""Listings of the sentences below the tables of lessons, exams and studies."""

from collections.abc import Iterator
from dataclasses import replace

from kurt2rt.experiments.lockstep.report import verdict_of
from kurt2rt.experiments.phases.steps import ASKS
from kurt2rt.experiments.phases.training_tables import words_of_controls
from kurt2rt.experiments.study.eligibility import reasons_against_judging
from tests.experiments.phases.outcomes import exam, stage, study, teaching
from tests.experiments.results import exam_result, world_result


def reasons() -> Iterator[tuple[str, str]]:
    """Yield the reasons against judging a study."""
    for label, seeds in (("one robot", (100,)), ("too few", range(100, 119)), ("known seeds", range(79, 99))):
        yield label, " ".join(reasons_against_judging(seeds))


def exams() -> Iterator[tuple[str, str]]:
    """Yield the line of an exam."""
    good = world_result(exam_result())
    for label, result in (
        ("passed", good),
        ("one collision", world_result(exam_result(collisions=1))),
        ("stuck", world_result(exam_result(collisions=2, stuck=True))),
        ("alarm", replace(good, learned=replace(good.learned, alarm="bus lost"))),
        ("teacher failed", replace(good, teacher=replace(good.teacher, stuck=True))),
        ("not judged", world_result(exam_result(), teachers_laps=0.0)),
    ):
        yield label, verdict_of(result)


def controls() -> Iterator[tuple[str, str]]:
    """Yield the sentences on controls without effect."""
    silent = [stage(ASKS, exam(progress=7.0), taught=teaching().model_copy(update={"asks": 0})) for _ in range(2)]
    for label, made in (("all equal", study(2)), ("no questions", study(2, asks_only=silent))):
        yield label, " ".join(words_of_controls(made))
