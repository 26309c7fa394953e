"""Choice of the engines that drive a study."""

from dataclasses import replace

import pytest

from hal.robot_settings import load_robot
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.lockstep.engine import ON_BUS, Engine, Engines
from kurt2rt.experiments.paper.study import GrowthJob
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.experiments.study.seeds import make_plan
from kurt2rt.experiments.study.study_plan import ALL_ON_BUS, EngineRequest, RequestedEngine, choose_engines
from tests.experiments.helpers import ROBOT, short_task
from tests.experiments.rows import MADE_OF
from tests.experiments.study.here import parts_in

IN_BATCH = RequestedEngine(EngineRequest.COMPILED)
AUTO = RequestedEngine(EngineRequest.AUTO, compiled=True)
KNOWN, UNKNOWN = short_task(), taught_by_named(load_task("route"), "superhuman")
BOTH = Engines(Engine.COMPILED, Engine.COMPILED)


def jobs(robots: int, task: TaskSettings = KNOWN) -> tuple[StudyJob, ...]:
    return make_plan(task, range(robots), parts_in()).jobs


def test_known_task_is_driven_in_the_batch_with_three_witnesses() -> None:
    choice = choose_engines(jobs(20), IN_BATCH, ROBOT)
    assert {job.engines for job in choice.apply(jobs(20))} == {BOTH}
    assert len(choice.witnesses(jobs(20))) == len(choice.witnessed) == 3
    assert choice.refusals == ()


def test_witnesses_are_one_percent_of_a_large_study() -> None:
    one = GrowthJob(
        **parts_in(), task=KNOWN, seed=0, made_of=MADE_OF, name="", stem="", robot_time_s=15.0, reading="shipped"
    )
    many = [replace(one, seed=seed, stem=str(seed)) for seed in range(450)]
    choice = choose_engines(many, IN_BATCH, ROBOT)
    assert {each.exams for each in choice.engines.values()} == {Engine.CAN}  # a curve of growth has no exam
    assert len(choice.witnessed) == 5


def test_unknown_task_goes_to_the_bus_and_is_named() -> None:
    choice = choose_engines((*jobs(4), *jobs(4, UNKNOWN)), IN_BATCH, ROBOT)
    assert {job.engines for job in choice.apply(jobs(4, UNKNOWN))} == {ON_BUS}
    assert {job.engines for job in choice.apply(jobs(4))} == {BOTH}
    (refusal,) = choice.refusals
    assert refusal.startswith("route: lessons and exams on the CAN bus, because a batch does not know metric route")


def test_study_stays_on_the_bus_unless_a_batch_is_asked_for() -> None:
    assert {job.engines for job in choose_engines(jobs(4), ALL_ON_BUS, ROBOT).apply(jobs(4))} == {ON_BUS}


@pytest.mark.parametrize(
    ("exam_s", "robots", "compiled", "engines"),
    [
        (300.0, 20, True, BOTH),
        (300.0, 20, False, ON_BUS),
        (300.0, 3, True, ON_BUS),  # all have witnesses, so nothing is saved
        (1.0, 20, True, ON_BUS),
    ],
)
def test_auto_takes_a_compiled_batch_that_saves_time(
    exam_s: float, robots: int, compiled: bool, engines: Engines
) -> None:
    asked = RequestedEngine(EngineRequest.AUTO, compiled)
    given = jobs(robots, short_task(exam_s=exam_s))
    assert {job.engines for job in choose_engines(given, asked, ROBOT).apply(given)} == {engines}


def test_auto_names_no_task_if_nothing_is_driven_in_the_batch() -> None:
    choice = choose_engines((*jobs(4), *jobs(4, UNKNOWN)), AUTO, ROBOT)
    assert choice.engines == {}
    assert choice.refusals == ()


@pytest.mark.parametrize("asked", [AUTO, IN_BATCH])
def test_robot_of_another_kind_goes_to_its_link(asked: RequestedEngine) -> None:
    given = jobs(20)
    assert choose_engines(given, asked, load_robot("school")).apply(given) == given


def test_robot_of_another_kind_is_named() -> None:
    (refusal,) = choose_engines(jobs(3), IN_BATCH, load_robot("school")).refusals
    assert "because a batch does not know a robot of kind school" in refusal
