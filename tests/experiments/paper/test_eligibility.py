"""Conditions for judging the paper study."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.paper.eligibility import reasons_not_to_judge
from kurt2rt.experiments.paper.extent import QUICK, WHOLE
from kurt2rt.experiments.paper.jobs import TaughtJob
from kurt2rt.experiments.paper.plan import PaperExperiment, PaperPlan, unseen_of
from kurt2rt.experiments.paper.settings import ExperimentSettings, load_paper
from kurt2rt.experiments.study.results import Results
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.paper.outcomes import MADE_OF, settings_of

TASK = load_task("wall_following")
NOT_SEEN = range(100, 120)


def plan(seeds: range | tuple[int, ...], settings: ExperimentSettings) -> PaperPlan:
    jobs = tuple(
        TaughtJob(
            factory=STAGE,
            robot=ROBOT,
            task=TASK,
            reading="shipped",
            seed=seed,
            unseen=unseen_of(seed, settings),
            made_of=MADE_OF,
            results=Results(Path("never-made")),
        )
        for seed in seeds
    )
    experiment = PaperExperiment(settings, "shipped", TASK, jobs)
    return PaperPlan(load_paper(), WHOLE, tuple(seeds), (experiment,), ())


SETTINGS = settings_of("wall_following")


def test_twenty_robots_that_nobody_has_seen_are_judged() -> None:
    assert list(reasons_not_to_judge(plan(NOT_SEEN, SETTINGS))) == []


@pytest.mark.parametrize(
    ("seeds", "numbers"),
    [
        (range(100, 119), ["19", "20"]),
        ((100,), ["1", "20"]),
        (range(79, 99), ["1", "0", "79"]),
        (range(100, 140, 2), ["15", "30", "20"]),
    ],
)
def test_others_are_not_and_the_reason_has_its_numbers(seeds: range | tuple[int, ...], numbers: list[str]) -> None:
    (reason,) = reasons_not_to_judge(plan(seeds, SETTINGS))
    assert re.findall(r"\d+", reason) == numbers


def test_a_part_is_not_judged() -> None:
    (reason,) = reasons_not_to_judge(replace(plan(NOT_SEEN, SETTINGS), extent=QUICK))
    assert not re.findall(r"\d", reason)


def test_rooms_on_which_settings_were_chosen_judge_nothing() -> None:
    assert SETTINGS.unseen is not None
    known = SETTINGS.model_copy(update={"unseen": SETTINGS.unseen.model_copy(update={"first": 59})})
    (reason,) = reasons_not_to_judge(plan(NOT_SEEN, known))
    assert re.findall(r"rooms-\d+", reason) == ["rooms-0", "rooms-59"]
