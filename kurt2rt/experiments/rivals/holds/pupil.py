"""Pupil of a teacher in charge: what the robot would do by itself, and whether it can go on alone."""

from typing import Protocol

from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.rivals.holds.hold_learner import HoldLearner
from kurt2rt.teacher.scripted.teacher_in_charge import Charge, Offer


class Pupil(Protocol):
    """Robot that is taught by a teacher in charge."""

    charge: Charge
    """Rule by which control passes."""

    def offer(self, record: TickRecord, held: str | None) -> Offer:
        """Return what the robot tells its teacher after a tick; `held`: the action that the teacher holds."""
        ...


class RlaPupil:
    """RLA system taught by held actions: each lesson acts at once, so it goes on wherever it knows the situation."""

    charge = Charge.BY_TEACHER

    def offer(self, record: TickRecord, held: str | None) -> Offer:  # noqa: ARG002 - RLAs do not compare
        """Return the action of the nearest RLA, if it is near enough."""
        match = record.decision.match
        return Offer(match.rla.action if match is not None and match.known else None)


class LearnerPupil:
    """Learners of all behaviours of a task."""

    def __init__(self, learners: dict[str, HoldLearner], demonstrated_ticks: int) -> None:
        """Begin without knowledge; the first demonstration ends after so many ticks."""
        self._learners = learners
        self._demonstrated_ticks = demonstrated_ticks
        self.charge = next(iter(learners.values())).charge
        self.driven_ticks = 0
        """Ticks in which the teacher drove, which the run counts."""

    def offer(self, record: TickRecord, held: str | None) -> Offer:
        """Return the learner's own action, and whether it can go on where its teacher holds an action."""
        learner = self._learners[record.behaviour]
        situation = record.situation.vector
        if not learner.iteration:
            return Offer(None, self.driven_ticks >= self._demonstrated_ticks, learner.stands)
        ready = held is not None and learner.can_go_on(situation, held)
        return Offer(learner.proposal(situation), ready, learner.stands)
