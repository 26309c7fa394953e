import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import Why
from kurt2rt.core.learner.learner_team import LearnerTeam
from tests.core.learner.helpers import SETTING, Parrot, label

HERE = np.array([3.0])


def parrots(*behaviours: str) -> LearnerTeam:
    return LearnerTeam("parrot", Parrot, SETTING, behaviours or ("",))


def test_each_behaviour_has_a_learner_of_its_own() -> None:
    team = parrots("left", "right")
    team.teach(label(3.0, "a", "t-1", "left"))
    assert team.decide("left", HERE, taught=True) == "a"
    assert team.decide("right", HERE, taught=True) is None
    assert team.snapshot()["right"] == Parrot(SETTING).snapshot() != team.snapshot()["left"]


def test_undo_teaches_the_other_labels_again() -> None:
    team = parrots()
    team.teach_all(label(3.0, action, f"t-{action}") for action in "abc")
    team.undo("t-c")
    assert team.decide("", HERE, taught=True) == "b"
    assert [each.action for each in team.labels] == ["a", "b"]
    before = team.learner("")
    team.undo("of another knowledge")
    assert team.learner("") is before


def test_undo_hold_takes_back_all_of_its_labels() -> None:
    team = parrots()
    team.teach(label(3.0, "a", "t-1"))
    team.teach_all(label(3.0, "b", f"Ann-hold-4/{tick}", why=Why.HOLD) for tick in (10, 20, 30))
    team.teach(label(3.0, "c", "Ann-hold-5/40", why=Why.HOLD))
    team.undo_hold("Ann-hold-4")
    assert [each.command_id for each in team.labels] == ["t-1", "Ann-hold-5/40"]


class Careless(Parrot):
    """Learner that raises an error in a situation above 5, and names an unknown action below 0."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        if situation[0] > 5.0:
            raise ValueError("too\nfar")
        return "jump" if situation[0] < 0.0 else super().decide(situation, taught=taught)


def careless() -> LearnerTeam:
    team = LearnerTeam("careless", Careless, SETTING, ("",))
    team.teach(label(3.0, "a", "t-1"))
    assert (team.decide("", HERE, taught=True), team.failure) == ("a", "")
    return team


def test_error_ends_all_decisions_and_is_told_in_one_line() -> None:
    team = careless()
    assert team.decide("", np.array([6.0]), taught=True) is None
    assert team.failure == "careless: ValueError: too far"
    assert team.decide("", HERE, taught=True) is None  # also where it knew the answer


def test_unknown_action_is_a_failure() -> None:
    team = careless()
    assert team.decide("", np.array([-1.0]), taught=True) is None
    assert team.failure == "careless: ValueError: decided 'jump', which is none of a, b, c"


class Unteachable(Parrot):
    """Learner whose second lesson fails."""

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        if self.said:
            raise MemoryError
        super().lesson(situation, action, why)


def test_error_in_a_lesson_is_a_failure_until_it_is_undone() -> None:
    team = LearnerTeam("unteachable", Unteachable, SETTING, ("",))
    team.teach_all((label(3.0, "a", "t-1"), label(3.0, "b", "t-2")))
    assert team.failure.startswith("unteachable: MemoryError")
    assert team.decide("", HERE, taught=True) is None
    team.undo("t-2")
    assert (team.failure, team.decide("", HERE, taught=True)) == ("", "a")


class Vandal(Parrot):
    """Learner that writes into the situation that it is shown."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        situation[0] = 0.0
        return super().decide(situation, taught=taught)


def test_learner_cannot_change_the_robots_situation() -> None:
    team, there = LearnerTeam("vandal", Vandal, SETTING, ("",)), np.array([3.0])
    assert team.decide("", there, taught=True) is None
    assert "read-only" in team.failure
    assert there[0] == 3.0
    there[0] = 4.0  # the robot itself still writes to it
