import numpy as np
from numpy.typing import NDArray

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


def test_unknown_action_is_a_failure() -> None:
    team = careless()
    assert team.decide("", np.array([-1.0]), taught=True) is None
    assert team.failure == "careless: ValueError: decided 'jump', which is none of a, b, c"
