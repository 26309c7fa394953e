"""Open question: one question of the robot, from its first tick until it is answered, overtaken or left behind."""

from kurt2rt.core.decision.decision import BY_KNOWLEDGE, Decision, DecisionCause, StandReason
from kurt2rt.core.decision.standing import Standing
from simbridge.contracts.shared_rules import SURE_SHARE, question_ticks

_KNOWN = BY_KNOWLEDGE | {DecisionCause.UNATTENDED}
_TEACHER = DecisionCause.TEACHER
_FLICKERS = frozenset(
    (
        *(StandReason.DRIVES, StandReason.ASKS, StandReason.DOUBTS, StandReason.ASKS_THE_WAY, StandReason.UNATTENDED),
        *(StandReason.FRONT_BUMPER, StandReason.REAR_BUMPER, StandReason.BOTH_BUMPERS),
    )
)
"""Reasons that noise brings and ends again while a question is open."""


def is_sure(decision: Decision) -> bool:
    """Return whether a decision knows its situation, inside R with a margin; a learner without R is sure of its own."""
    match = decision.match
    return decision.cause in _KNOWN and (match is None or match.distance <= SURE_SHARE * match.radius)


class OpenQuestion:
    """One question from its first tick to its end, so that noise does not make many of it (debouncing).

    It only counts, and changes no decision.

    A question ends by an answer, by a press, by another behaviour, after 0.5 s inside R with a margin, after 1 s of
    driving without asking, and when the robot is put elsewhere.
    """

    def __init__(self) -> None:
        self._left = 0
        self._behaviour = ""
        self._standing = Standing()
        self.begins = False
        """True in the first tick of a question."""

    @property
    def is_open(self) -> bool:
        """Return whether a question is open."""
        return self._left > 0

    def close(self) -> None:
        """End the question, because it was answered or the robot was put elsewhere."""
        self._left = 0

    def count(self, behaviour: str, *, asks: bool, sure: bool, moves: bool, pressed: bool) -> bool:
        """Count one tick; return whether a question begins in it.

        Args:
            behaviour: active taught behaviour.
            asks: whether the robot asks.
            sure: whether its situation is inside R with a margin.
            moves: whether a wheel turns.
            pressed: whether a teacher drives.
        """
        if pressed or behaviour != self._behaviour:
            self._behaviour = behaviour
            self._left = 0
        self.begins = asks and not self._left
        if asks or self._left:
            self._left = question_ticks(self._left, asks, sure, moves)
        return self.begins

    def update(self, decision: Decision, standing: Standing, behaviour: str, turned: bool) -> Standing:
        """Count one tick; return the standing that teachers are shown: that of the open question, except at a stop.

        Args:
            decision: of the tick, as it is published.
            standing: after the tick.
            behaviour: active taught behaviour.
            turned: whether a wheel turns.
        """
        if not self._left and not standing.asks:  # most ticks
            self.begins = False
            return standing
        asks = decision.asking and not standing.needs_resume
        pressed = decision.cause is _TEACHER
        # A question of another kind replaces this one, if the robot asks it for as long as it would be sure otherwise.
        other = asks and self._left > 0 and standing.reason is not self._standing.reason
        self.count(behaviour, asks=asks and not other, sure=other or is_sure(decision), moves=turned, pressed=pressed)
        if other and not self._left:
            self.count(behaviour, asks=True, sure=False, moves=False, pressed=pressed)
        if self.begins:
            self._standing = standing
        steady = self._left > 0 and not standing.needs_resume and standing.reason in _FLICKERS
        return self._standing if steady else standing
