"""Verdicts on the phases of a task."""

import pytest

from kurt2rt.experiments.phases.outcome import ExamOutcome
from kurt2rt.experiments.phases.steps import CORRUPTED, CRITIC_ALONE, INTACT, LONG_RUN, PHASE_2, REWARDS
from kurt2rt.experiments.phases.verdicts import interventions, verdicts
from kurt2rt.experiments.study.verdict import Result, Target, Verdict
from tests.experiments.phases.outcomes import TASK, exam, stage, study, teaching


def found(**changed: object) -> dict[tuple[Target, str], Verdict]:
    """Return the verdicts by target and world."""
    told = study(20, **changed)  # type: ignore[arg-type]
    return {(each.target, str(each.values.get("world", ""))): each for each in verdicts(told)}


def test_a_repair_needs_as_many_robots_as_the_share_says() -> None:
    def results(wrong_in_a: int, wrong_in_c: int) -> list[tuple[object, Result]]:
        robots = [
            stage(REWARDS, exam(succeeded=n >= wrong_in_a), exam("c", succeeded=n >= wrong_in_c), taught=teaching())
            for n in range(20)
        ]
        told = found(rewards=robots)
        repaired = [told[Target.REPAIRED_BY_REWARDS, world] for world in "AC"]
        return [(each.values["succeeded"], each.result) for each in repaired]

    assert results(1, 2) == [(19, Result.MET), (18, Result.MET)]
    assert results(2, 3) == [(18, Result.MISSED), (17, Result.MISSED)]


@pytest.mark.parametrize(("most", "result"), [(100, Result.MET), (101, Result.MISSED)])
def test_the_robot_that_took_most_blame_counts(most: int, result: Result) -> None:
    robots = [stage(REWARDS, taught=teaching(blame=most if n == 7 else 1)) for n in range(20)]
    verdict = found(rewards=robots)[Target.NEGATIVE_REWARDS, ""]
    assert (verdict.values["most"], verdict.result) == (most, result)


@pytest.mark.parametrize(("left", "result"), [(2, Result.MET), (3, Result.MISSED)])
def test_collisions_fall_by_those_that_are_no_more(left: int, result: Result) -> None:
    before = [stage(CORRUPTED, exam(collisions=1)) for _ in range(20)]
    after = [stage(CRITIC_ALONE, exam(collisions=int(n < left)), taught=teaching()) for n in range(20)]
    verdict = found(corrupted=before, critic_alone=after)[Target.FEWER_COLLISIONS, ""]
    values = [verdict.values[name] for name in ("fall", "before", "after")]
    assert values == pytest.approx([1 - left / 20, 2.0, left / 10])
    assert verdict.result is result


def intact(*after: ExamOutcome) -> dict[str, Verdict]:
    """Return the verdicts in world A, by measure, on 20 robots that were clean and alike before."""
    before = [stage(PHASE_2, taught=teaching()) for _ in range(20)]
    robots = [stage(INTACT, each, taught=teaching()) for each in after]
    judged = verdicts(study(20, phase_2=before, intact_autonomous=robots))
    targets = (Target.INTACT_STAYS_CLEAN, Target.INTACT_NOT_WORSE)
    return {
        str(each.values["measure"]): each for each in judged if each.target in targets and each.values["world"] == "A"
    }


def test_intact_unchanged_set_is_not_worse() -> None:
    told = intact(*[exam()] * 20)
    assert (told["success"].values["after"], told["success"].values["no_longer_clean"]) == (1.0, 0)
    assert (told["progress"].values["after"], told["progress"].values["worst"]) == (8.0, 0.0)
    assert {each.result for each in told.values()} == {Result.MET}
    assert len(told) == 5


def test_intact_one_robot_no_longer_clean_is_worse() -> None:
    told = intact(exam(succeeded=False, collisions=1), *[exam()] * 19)
    for measure, mean in (("success", 0.95), ("collisions in 10 min", 0.1)):
        assert told[measure].result is Result.MISSED
        assert told[measure].values["no_longer_clean"] == 1
        assert told[measure].values["after"] == pytest.approx(mean)
    assert told["progress"].met


def test_intact_measure_may_be_worse_by_the_margin() -> None:
    for progress, result in ((7.85, Result.MET), (7.83, Result.MISSED)):
        verdict = intact(*[exam(progress=progress)] * 20)["progress"]
        assert verdict.result is result
        assert verdict.values["worst"] == pytest.approx(1 - progress / 8.0)
    # On the mean it is better; what it may be is not known well enough.
    unsure = intact(*(exam(progress=8.1 + (n % 2 - 0.5) * 4) for n in range(20)))
    assert unsure["progress"].values["after"] == pytest.approx(8.1)
    assert unsure["progress"].result is Result.MISSED


def test_intervention_counts_each_cause_that_needs_a_person() -> None:
    robots = [
        stage(LONG_RUN, taught=teaching(1800.0, collisions=1, rescues=2, unknown_rescues=1)),
        stage(LONG_RUN, taught=teaching(1800.0)),
    ]
    told = study(2, long_run=robots)
    assert interventions(told).value == 3.0
    verdict = list(verdicts(told))[-1]
    assert (verdict.target, verdict.result) == (Target.INTERVENTIONS, Result.MISSED)
    assert str(verdict.values["robots"]).endswith("3")


def test_of_a_task_that_asks_for_nothing_nothing_is_said() -> None:
    assert TASK.phases is not None
    asks_nothing = TASK.phases.model_copy(update={"asked": type(TASK.phases.asked)()})
    assert list(verdicts(study(2, TASK.model_copy(update={"phases": asks_nothing})))) == []
