"""The steps of one robot: each behind what it needs, with the same time and the same start for all that is compared."""

import pytest

from config.settings import SettingsError
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.phases.steps import (
    ASKS,
    BLAME_BY_CHANCE,
    BRANCHES,
    CORRUPTED,
    CRITIC_ALONE,
    INTACT,
    JUDGED,
    PATH,
    PHASE_2,
    PHASE_4,
    REWARDS,
    SHUFFLED,
    TITLES,
    UNKNOWN_BAD,
    steps_of,
)

TASK = load_task("wall_following")
STEPS = {step.name: step for step in steps_of(TASK)}


def test_each_step_stands_behind_those_it_needs() -> None:
    done = {PHASE_2}
    for step in steps_of(TASK):
        assert done.issuperset(step.needs)
        done.add(step.name)
    assert done > set(BRANCHES) | set(PATH[2:])
    assert done <= set(TITLES)


def test_repairs_share_set_place_and_time() -> None:
    repairs = [STEPS[name] for name in (ASKS, UNKNOWN_BAD, BLAME_BY_CHANCE, REWARDS)]
    for step in (*repairs, STEPS[CORRUPTED], STEPS[CRITIC_ALONE], STEPS[SHUFFLED]):
        assert (step.after, step.corrupted) == (PHASE_2, 0.18)
        assert step.worlds == STEPS[CORRUPTED].worlds
    plans = [step.plan for step in repairs if step.plan]
    assert {(plan.duration_s, plan.purpose, plan.reposition_every_s) for plan in plans} == {
        (plans[0].duration_s, "repair", 15.0)
    }
    assert {(plan.rescues_who_asks, plan.rescue_after_s) for plan in plans} == {(True, None)}
    assert STEPS[CRITIC_ALONE].plan == STEPS[SHUFFLED].plan == STEPS[INTACT].plan


def test_a_critic_is_taken_from_this_robot_s_phase_4() -> None:
    assert {name for name, step in STEPS.items() if step.critic != "own"} == {*(JUDGED, CRITIC_ALONE, SHUFFLED, INTACT)}
    assert STEPS[JUDGED].plan is None
    assert (STEPS[JUDGED].corrupted, STEPS[JUDGED].mistakes) == (STEPS[REWARDS].corrupted, STEPS[REWARDS].mistakes)
    assert all(PHASE_4 in STEPS[name].needs for name in (CRITIC_ALONE, SHUFFLED, INTACT))


def test_blame_by_chance_waits_for_what_it_is_to_be_as_often_as() -> None:
    chance, rewards = STEPS[BLAME_BY_CHANCE], STEPS[REWARDS]
    assert chance.needs == (PHASE_2, REWARDS)
    assert chance.plan is not None
    assert rewards.plan is not None
    assert chance.plan.times == rewards.plan.times  # the most that he may blame, too
    assert chance.plan.signs == "chance"


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
