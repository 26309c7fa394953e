"""Questions of the robot: "I don't know this situation, teach me"."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.basic.doubt import NewObstacle
from kurt2rt.core.message_fields import Finite, Word
from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.rla import ASK, MID, rla_title

_MOST_DIFFERING = 5
"""Features in a question."""


class FeatureDifference(NamedTuple):
    """Feature by which a question explains itself: its value here, and in the nearest RLA's condition."""

    name: Word
    here: Finite
    in_condition: Finite


@dataclass(frozen=True, slots=True)
class Question:
    """Message to the teacher: no RLA is near enough, or the robot doubts its action (paper, section IV.A).

    It names the nearest RLA and the features that differ most, such as "front left: 13 cm, was 46 cm". Page, terminal
    and log show its text.
    """

    nearest_rla: int | None
    """None before the first lesson."""
    action: str | None
    """Action of the nearest RLA."""
    distance: float
    radius: float
    differing: tuple[FeatureDifference, ...]
    """Features that differ most, in descending order."""
    behaviour: str = ""
    """Active behaviour; empty if the task has a single one."""
    words: SensorWords = field(default=NO_WORDS, compare=False, repr=False)
    """Words for the features that differ."""
    worth: float | None = None
    """Value of the nearest RLA if its action was withdrawn; None if unknown."""
    touches: str = ""
    """Question of a robot at a bumper; empty for an unknown situation."""
    doubts: bool = False
    """True if the situation is known, but the robot doubts the action."""
    image: str = ""
    """Image in which the nearest RLA is near, and which `action` is of."""

    def __str__(self) -> str:
        if self.nearest_rla is None:
            of = f" of {self.behaviour}" if self.behaviour else ""
            return f"I know nothing{of} yet, teach me"
        features = "; ".join(
            self.words.difference(each.name, each.here, each.in_condition)
            for each in self.differing
            if self.words.differs(each.name, each.here, each.in_condition)
        )
        nearest = rla_title(self.nearest_rla, self.behaviour, image=self.image)
        if self.touches:
            return f"{self.touches} {nearest} says {self.action}"
        if self.doubts:
            return f"I doubt {nearest}, which says {self.action} here, teach me{'; ' if features else ''}{features}"
        if self.action == ASK and self.distance <= self.radius:
            value = "" if self.worth is None else f" (value {self.worth:.2f})"
            return f"{nearest} was marked wrong{value}, teach me again"
        if self.action != ASK and self.distance <= self.radius:
            # The action is a taught system itself, and none of its RLAs is near enough.
            return f"{nearest} says {self.action}, which does not know how to go on here; teach me another action"
        action = "its action was withdrawn" if self.action == ASK else self.action
        return (
            f"I don't know this situation, teach me: nearest is {nearest} ({action}) "
            f"at {self.distance:.0f} of {self.radius:.0f}{'; ' if features else ''}{features}"
        )


@dataclass(frozen=True, slots=True)
class MidQuestion:
    """Question of the mid level to the teacher: which taught behaviour to follow from here."""

    nearest_rla: int | None
    """None before the first lesson of the mid level."""
    behaviour: str | None
    """Behaviour that the nearest RLA commands."""
    distance: float
    """Distance of the nearest RLA; infinite without one and at an unknown place."""
    radius: float
    here: tuple[str, ...]
    """Mid level's situation in words, newest first."""

    def __str__(self) -> str:
        came_by = f"; I came by {', '.join(self.here)}" if self.here else ""
        if self.nearest_rla is None:
            return f"I don't know any way yet, teach me which behaviour to follow{came_by}"
        if math.isinf(self.distance):
            return "I don't know where I am: set me down at a place with a name, and give me the name"
        nearest = rla_title(self.nearest_rla, "", MID)
        action = "its action was withdrawn" if self.behaviour == ASK else self.behaviour
        return (
            f"I don't know the way from here, teach me which behaviour to follow: nearest is {nearest} ({action}) "
            f"at {self.distance:.3g} of {self.radius:.3g}{came_by}"
        )


def ask_the_way(match: Match | None, words: Iterable[str]) -> MidQuestion:
    """Return the mid level's question with nearest RLA `match`; None: nothing was taught.

    `words`: texts of the situation's features; empty ones are left out.
    """
    here = tuple(word for word in words if word)
    if match is None:
        return MidQuestion(None, None, float("inf"), 0.0, here)
    return MidQuestion(match.rla.rla_id, match.rla.action, match.distance, match.radius, here)


def ask(
    match: Match | None,
    situation: NDArray[np.float64],
    weights: NDArray[np.float64],
    feature_names: tuple[str, ...],
    behaviour: str = "",
    words: SensorWords = NO_WORDS,
) -> Question:
    """Return the basic level's question about a situation whose nearest RLA of `behaviour` is `match`.

    Args:
        match: nearest RLA; None if nothing was taught.
        situation: vector, shape (d,).
        weights: shape (d,), with which the match was found.
        feature_names: name of each of the d features.
        behaviour: active taught behaviour.
        words: texts for features.
    """
    if match is None:
        return Question(None, None, float("inf"), 0.0, (), behaviour, words)
    condition = np.array(match.rla.condition)
    differences = np.abs(situation - condition) * weights
    order = np.argsort(-differences, kind="stable")[:_MOST_DIFFERING]
    differing = tuple(
        FeatureDifference(feature_names[i], float(situation[i]), float(condition[i]))
        for i in order
        if differences[i] > 0.0
    )
    rla = match.rla
    return Question(rla.rla_id, rla.action, match.distance, match.radius, differing, behaviour, words, image=rla.image)


def ask_in_doubt(question: Question, obstacle: NewObstacle | None, feature_names: tuple[str, ...]) -> Question:
    """Return the question of a robot that doubts, changed from a `question` about the same situation.

    The new obstacle comes first among the differing features; None: only the distance makes the robot doubt.
    """
    if obstacle is None:
        return replace(question, doubts=True)
    name = feature_names[obstacle.feature]
    others = (each for each in question.differing if each.name != name)
    first = FeatureDifference(name, obstacle.here, obstacle.taught)
    return replace(question, doubts=True, differing=(first, *others)[: max(1, len(question.differing))])
