"""Small learners over a situation of one number, and their setting."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.label_learner import pack, unpack
from kurt2rt.core.learner.learner import Label, LearnerSetting, Why

SETTING = LearnerSetting(
    dimensions=1,
    weights=np.ones(1),
    radius=10.0,
    ask_radius_fraction=0.5,
    insert_radius_fraction=0.2,
    actions=("a", "b", "c"),
    seed=1,
)


class Parrot:
    """Learner that says the last action that it was taught, everywhere."""

    def __init__(self, setting: LearnerSetting) -> None:
        self.setting = setting
        self.said: list[str] = []

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:  # noqa: ARG002 - it looks at nothing
        return self.said[-1] if self.said else None

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:  # noqa: ARG002 - as above
        self.said.append(action)

    def snapshot(self) -> bytes:
        return pack(np.zeros((len(self.said), 1)), self.said)

    def restore(self, data: bytes) -> None:
        self.said = unpack(data, 1)[1]


def label(place: float, action: str, command_id: str, behaviour: str = "", why: Why = Why.ANSWER) -> Label:
    return Label(np.array([place]), behaviour, action, why, command_id)
