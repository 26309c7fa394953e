"""The steps of one robot: each behind what it needs, with the same time and the same start for all that is compared."""

import pytest

from config.settings import SettingsError
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.phases.steps import steps_of

TASK = load_task("wall_following")


@pytest.mark.parametrize("name", ["wall_following", "fleeing", "eight"])
def test_autonomous_steps_plan_no_repositioning(name: str) -> None:
    task = load_task(name)
    plans = [step.plan for step in steps_of(task) if step.plan and step.plan.phases[0][0] is Phase.AUTONOMOUS]
    assert len(plans) == 5
    assert {plan.reposition_every_s for plan in plans} == {0.0}  # what the task says of lessons does not count
    assert {plan.rescue_after_s for plan in plans} == {task.exam.stuck_after_s}


@pytest.mark.parametrize("key", ["phases", "judge"])
def test_a_task_that_says_nothing_of_these_phases_is_refused(key: str) -> None:
    with pytest.raises(SettingsError, match=f"wall_following: .*`{key}:`"):
        list(steps_of(TASK.model_copy(update={key: None})))
