"""Choice of the engines that drive a study."""

from collections.abc import Sequence

import pytest

from hal.robot_settings import RobotSettings, load_robot
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.lockstep.engine import ON_BUS, Engine, Engines
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.experiments.study.seeds import make_plan
from kurt2rt.experiments.study.study_plan import EngineRequest, StudyPlan
from tests.experiments.helpers import ROBOT, short_task
from tests.experiments.study.here import parts_in

IN_BATCH, AUTO = EngineRequest.COMPILED, EngineRequest.AUTO
KNOWN, UNKNOWN = short_task(), taught_by_named(load_task("route"), "superhuman")
BOTH = Engines(Engine.COMPILED, Engine.COMPILED)


def jobs(robots: int, task: TaskSettings = KNOWN) -> tuple[StudyJob, ...]:
    return make_plan(task, range(robots), parts_in()).jobs


def driven(jobs: Sequence[StudyJob], asked: EngineRequest, robot: RobotSettings = ROBOT) -> StudyPlan[None]:
    return StudyPlan(None, (), tuple(jobs)).driven(asked, robot)


def test_known_task_is_driven_in_the_batch_with_three_witnesses() -> None:
    plan = driven(jobs(20), IN_BATCH)
    assert {job.engines for job in plan.jobs} == {BOTH}
    assert (len(plan.witnesses), plan.refusals) == (3, ())


def test_unknown_task_goes_to_the_bus_and_is_named() -> None:
    plan = driven((*jobs(4), *jobs(4, UNKNOWN)), IN_BATCH)
    assert [job.engines for job in plan.jobs] == [BOTH] * 4 + [ON_BUS] * 4
    (refusal,) = plan.refusals
    assert refusal.startswith("route: lessons and exams on the CAN bus, because a batch does not know metric route")


@pytest.mark.parametrize(
    ("exam_s", "robots", "asked", "engines"),
    [
        (300.0, 20, AUTO, BOTH),
        (300.0, 20, EngineRequest.CAN, ON_BUS),
        (300.0, 3, AUTO, ON_BUS),  # all have witnesses, so nothing is saved
        (1.0, 20, AUTO, ON_BUS),
    ],
)
def test_auto_takes_a_batch_that_saves_time(exam_s: float, robots: int, asked: EngineRequest, engines: Engines) -> None:
    plan = driven(jobs(robots, short_task(exam_s=exam_s)), asked)
    assert {job.engines for job in plan.jobs} == {engines}


def test_robot_of_another_kind_goes_to_its_link_and_is_named() -> None:
    plan = driven(jobs(3), IN_BATCH, load_robot("school"))
    assert {job.engines for job in plan.jobs} == {ON_BUS}
    assert "because a batch does not know a robot of kind school" in plan.refusals[0]
