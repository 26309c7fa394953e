"""What was asked, and what came."""

import pytest

from kurt2rt.experiments.phases.steps import CORRUPTED, CRITIC_ALONE, INTACT, LONG_RUN, PHASE_2, REWARDS
from kurt2rt.experiments.phases.verdict import interventions, verdicts
from tests.experiments.phases.outcomes import TASK, exam, stage, study, teaching


def words(**changed: object) -> dict[str, tuple[str, str]]:
    told = study(20, **changed)  # type: ignore[arg-type]
    return {each.what: (each.came, each.word) for each in verdicts(told)}


def test_a_repair_needs_as_many_robots_as_the_share_says() -> None:
    def came(wrong_in_a: int, wrong_in_c: int) -> dict[str, tuple[str, str]]:
        robots = [
            stage(REWARDS, exam(succeeded=n >= wrong_in_a), exam("c", succeeded=n >= wrong_in_c), taught=teaching())
            for n in range(20)
        ]
        return words(rewards=robots)

    told = came(1, 2)
    assert told["repaired by phase 3, A"] == ("19 of 20", "met")
    assert told["repaired by phase 3, C"] == ("18 of 20", "met")
    told = came(2, 3)
    assert told["repaired by phase 3, A"] == ("18 of 20", "MISSED")
    assert told["repaired by phase 3, C"] == ("17 of 20", "MISSED")


@pytest.mark.parametrize(("most", "word"), [(100, "met"), (101, "MISSED")])
def test_the_robot_that_took_most_blame_counts(most: int, word: str) -> None:
    robots = [stage(REWARDS, taught=teaching(blame=most if n == 7 else 1)) for n in range(20)]
    assert words(rewards=robots)["blame in phase 3, most of all robots"] == (f"{most}", word)


@pytest.mark.parametrize(("left", "word"), [(2, "met"), (3, "MISSED")])
def test_collisions_fall_by_those_that_are_no_more(left: int, word: str) -> None:
    before = [stage(CORRUPTED, exam(collisions=1)) for _ in range(20)]
    after = [stage(CRITIC_ALONE, exam(collisions=int(n < left)), taught=teaching()) for n in range(20)]
    told = words(corrupted=before, critic_alone=after)["collisions fall by the critic alone"]
    assert told == (f"by {1 - left / 20:.0%}, 2.00 to {left / 10:.2f} in 10 min", word)


def test_an_intact_set_is_worse_where_the_interval_says_so() -> None:
    before = [stage(PHASE_2, taught=teaching()) for _ in range(20)]
    same = [stage(INTACT, taught=teaching()) for _ in range(20)]
    told = words(phase_2=before, intact_autonomous=same)
    assert told["an intact set in phase 5"] == ("nothing surely worse", "met")
    slower = [stage(INTACT, exam(progress=7.0 + 0.01 * n), taught=teaching()) for n in range(20)]
    told = words(phase_2=before, intact_autonomous=slower)
    assert told["an intact set in phase 5"] == ("progress in A", "MISSED")


def test_whoever_has_to_come_is_an_intervention() -> None:
    robots = [
        stage(LONG_RUN, taught=teaching(1800.0, collisions=1, rescues=2, unknown_rescues=1)),
        stage(LONG_RUN, taught=teaching(1800.0)),
    ]
    told = study(2, long_run=robots)
    assert interventions(told).value == 3.0
    assert list(verdicts(told))[-1].word == "MISSED"


def test_of_a_task_that_asks_for_nothing_nothing_is_said() -> None:
    assert TASK.phases is not None
    asks_nothing = TASK.phases.model_copy(update={"asked": type(TASK.phases.asked)()})
    assert list(verdicts(study(2, TASK.model_copy(update={"phases": asks_nothing})))) == []
