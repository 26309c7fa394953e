"""What was asked, and what came."""

import pytest

from kurt2rt.experiments.phases.outcome import ExamOutcome
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
    assert told[0].startswith(f"by {1 - left / 20:.0%} (")
    assert told[0].endswith(f"), 2.00 to {left / 10:.2f} in 10 min")
    assert told[1] == word


INTACT_IN_A = "an intact set in phase 5, A: "


def intact(*after: ExamOutcome) -> dict[str, tuple[str, str]]:
    """The verdicts on 20 robots that were clean and alike before."""
    before = [stage(PHASE_2, taught=teaching()) for _ in range(20)]
    robots = [stage(INTACT, each, taught=teaching()) for each in after]
    told = words(phase_2=before, intact_autonomous=robots)
    return {what.removeprefix(INTACT_IN_A): came for what, came in told.items() if what.startswith(INTACT_IN_A)}


def test_an_intact_set_that_stays_as_it_is_is_not_worse_by_any_measure() -> None:
    told = intact(*[exam()] * 20)
    assert told["success"] == ("1.000 -> 1.000; robots no longer clean: 0", "met")
    assert told["progress"] == ("8.000 -> 8.000, at worst 0.0% better", "met")
    assert {word for _, word in told.values()} == {"met"}
    assert len(told) == 5


def test_one_robot_that_is_clean_no_more_is_worse_however_many_are() -> None:
    told = intact(exam(succeeded=False, collisions=1), *[exam()] * 19)
    assert told["success"] == ("1.000 -> 0.950; robots no longer clean: 1", "MISSED")
    assert told["collisions in 10 min"] == ("0.000 -> 0.100; robots no longer clean: 1", "MISSED")
    assert told["progress"][1] == "met"


def test_what_is_measured_may_be_worse_by_the_margin_at_the_bad_end_of_its_interval() -> None:
    assert intact(*[exam(progress=7.85)] * 20)["progress"] == ("8.000 -> 7.850, at worst 1.9% worse", "met")
    assert intact(*[exam(progress=7.83)] * 20)["progress"] == ("8.000 -> 7.830, at worst 2.1% worse", "MISSED")
    # On the mean it is better; what it may be is not known well enough.
    unsure = intact(*(exam(progress=8.1 + (n % 2 - 0.5) * 4) for n in range(20)))
    assert unsure["progress"][0].startswith("8.000 -> 8.100, at worst ")
    assert unsure["progress"][1] == "MISSED"


def test_whoever_has_to_come_is_an_intervention() -> None:
    robots = [
        stage(LONG_RUN, taught=teaching(1800.0, collisions=1, rescues=2, unknown_rescues=1)),
        stage(LONG_RUN, taught=teaching(1800.0)),
    ]
    told = study(2, long_run=robots)
    assert interventions(told).value == 3.0
    verdict = list(verdicts(told))[-1]
    assert verdict.word == "MISSED"
    assert verdict.came.endswith("; 2 robots of 30 min each, of which the worst had 3")


def test_of_a_task_that_asks_for_nothing_nothing_is_said() -> None:
    assert TASK.phases is not None
    asks_nothing = TASK.phases.model_copy(update={"asked": type(TASK.phases.asked)()})
    assert list(verdicts(study(2, TASK.model_copy(update={"phases": asks_nothing})))) == []
