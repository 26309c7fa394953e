import pytest

from kurt2rt.core.mid.settings import MidSettings
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.route.variants import CONTROLS, TAUGHT, Variant
from tests.experiments.helpers import ROBOT


def route(supervised_s: float = 100.0, corrections_s: float = 300.0) -> TaskSettings:
    task = load_task("route")
    times = {"supervised_s": supervised_s, "corrections_s": corrections_s}
    return task.model_copy(update={"teaching": task.teaching.model_copy(update=times)})


def named(name: str) -> Variant:
    return next(each for each in CONTROLS if each.name == name)


def mid_of(task: TaskSettings) -> MidSettings:
    assert isinstance(task.mid, MidSettings)
    return task.mid


@pytest.mark.parametrize("variant", [TAUGHT, *CONTROLS], ids=lambda each: each.name)
def test_every_way_to_teach_can_be_built(variant: Variant) -> None:
    task = variant.task(load_task("route"))
    assert task.mid is None or mid_of(task).build(ROBOT).dimensions == 12
    plans = variant.plans(task, 2)
    assert sum(plan.duration_s for plan in plans) == pytest.approx(797.0)
    assert len({plan.purpose for plan in plans}) == len(plans)


def test_each_changes_what_it_says_and_nothing_else() -> None:
    shipped = mid_of(TAUGHT.task(route()))
    assert (shipped.learning.radius, shipped.situation.metric) == (6.0, "hamming")
    assert mid_of(named("radius-2").task(route())).learning.radius == 2.0
    assert named("commanded").task(route()).mid is None


def test_begun_anew_the_phases_go_on() -> None:
    first, second = TAUGHT.plans(route(), 2)
    assert first.phases == ((Phase.SUPERVISED, 100.0), (Phase.CORRECTIONS, 100.0))
    assert second.phases == ((Phase.CORRECTIONS, 200.0),)
    (once,) = named("one-start").plans(route(), 2)
    assert once.phases == ((Phase.SUPERVISED, 100.0), (Phase.CORRECTIONS, 300.0))


def test_only_answers_plan_stays_in_phase_1() -> None:
    assert {phase for plan in named("only-answers").plans(route(), 2) for phase, _ in plan.phases} == {Phase.SUPERVISED}
    assert [plan.corrects_basic for plan in named("basic-not-corrected").plans(route(), 2)] == [False, False]
