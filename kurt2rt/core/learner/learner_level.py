"""Learner level: it drives by learners, with the same minimum time per action as the RLAs' level."""

import numpy as np
from numpy.typing import NDArray

from behaviors.repertoire import Repertoire
from hal.robot import STANDSTILL, SensorReadings
from kurt2rt.core.basic.held_action import HeldAction
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause
from kurt2rt.core.learner.learner import Label, Why
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.events import LessonUndone, TeachingEvent


class LearnerLevel:
    """Level that drives by a learner's actions, stands where it asks, and stands if it failed."""

    def __init__(
        self,
        team: LearnerTeam,
        repertoire: Repertoire,
        minimum_action_ticks: int,
        active_behaviour: ActiveBehaviour,
    ) -> None:
        """Connect the learners to the repertoire.

        Args:
            team: learners, which may know something already.
            repertoire: actions that they name.
            minimum_action_ticks: ticks before another action may replace the driving one.
            active_behaviour: only its learner decides.
        """
        self.team = team
        self._active_behaviour = active_behaviour
        self._behaviour = active_behaviour.behaviour
        self._held = HeldAction(repertoire, minimum_action_ticks)
        self.taught = False
        """Whether a teacher is there who answers."""
        self.counts = True
        """Whether this tick counts for the minimum time of an action; a slow lesson leaves out some."""

    def decide(self, situation: Situation, readings: SensorReadings, blocking_cause: DecisionCause | None) -> Decision:
        """Return the decision of this tick: drive by the learner's action or the held one, or stand.

        It stands for `blocking_cause`, for a failure, and where the learner asks. `situation`: vector (d,).
        """
        if self._behaviour != self._active_behaviour.behaviour:
            self._behaviour = self._active_behaviour.behaviour
            self._held.allow_switch()
        if blocking_cause is not None:
            return self._stand(blocking_cause)
        action = self.team.decide(self._behaviour, situation.vector, taught=self.taught)
        if self.team.failure:
            return self._stand(DecisionCause.LEARNER_FAILED)
        if action is None:
            return self._stand(DecisionCause.UNKNOWN)
        self._held.select(action)
        wheel_speeds = self._held.step(readings, counts=self.counts)
        if self._held.lost:
            # The action is not restarted: it goes on by itself once its situation is known again.
            return Decision(STANDSTILL, DecisionCause.UNKNOWN, None, None, None)
        return Decision(wheel_speeds, DecisionCause.LEARNER, self._held.name, None, None)

    def teach(self, situation: NDArray[np.float64], behaviour: str, action: str, why: Why, command_id: str) -> None:
        """Give a lesson to its learner; the next decision follows it at once, even if an action is held.

        Args:
            situation: that the lesson is about, shape (d,); it is copied.
            behaviour: behaviour that the lesson belongs to.
            action: right action there.
            why: occasion.
            command_id: id of the command, by which an undo names the lesson.
        """
        copied = situation.copy()
        copied.flags.writeable = False
        self.team.teach(Label(copied, behaviour, action, why, command_id))
        self._held.allow_switch()

    def on_event(self, event: TeachingEvent) -> None:
        """Undo the lesson that an event undoes."""
        if isinstance(event, LessonUndone):
            self.team.undo(event.lesson)
            self._held.allow_switch()

    def _stand(self, cause: DecisionCause) -> Decision:
        self._held.stop()
        return Decision(STANDSTILL, cause, None, None, None)
