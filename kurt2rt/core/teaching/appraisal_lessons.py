"""Lessons of the critic: values of situations (paper, phase 4)."""

from kurt2rt.core.critic.critic import Critic
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.events import ActionReplaced, Appraised, RlaCreated
from kurt2rt.core.rla.rla import CRITIC, Origin, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.commands import Appraise
from kurt2rt.core.teaching.lesson_result import LessonResult, rla_outcome


class AppraisalLessons:
    """Builder of the events that teach a teacher's appraisals to the critic."""

    def __init__(self, critic: Critic, system: RlaSystem, recent: DecisionHistory) -> None:
        self._critic = critic
        self._system = system
        self._recent = recent

    @property
    def appraisals(self) -> tuple[str, ...]:
        """Return the names of the critic's values."""
        return self._critic.appraisals

    def build(self, command: Appraise, meant: int, origin: Origin) -> LessonResult:
        """Return the outcome and the event of an appraisal about the remembered tick `meant`.

        An appraisal unlike the critic's present opinion is learnt. An equal one counts as agreement, but only if the
        critic was of that opinion in that tick already: it may have learnt it from an appraisal in between.

        Raises:
            CommandRefusedError: for an unknown value, or a tick in which the robot was blind.
        """
        if command.appraisal not in self.appraisals:
            raise CommandRefusedError(RefusalCode.NO_APPRAISAL, appraisal=command.appraisal, known=self.appraisals)
        circumstances = self._recent.circumstances(meant)
        if circumstances is None:
            raise CommandRefusedError(RefusalCode.WAS_BLIND)
        vector = self._critic.to_vector(circumstances)
        now, then = self._critic.opinion(vector), self._recent.opinion(meant)
        if now is not None and now.known and now.appraisal == command.appraisal:
            if then is not None and then.known and then.appraisal == command.appraisal:
                value = self._critic.settings.values[command.appraisal]
                agreed = Outcome.of(ResultCode.CRITIC_AGREED, appraisal=command.appraisal)
                return LessonResult(agreed, Appraised(command.appraisal, value, meant, origin))
            return LessonResult(Outcome.of(ResultCode.CRITIC_AGREES, appraisal=command.appraisal))
        if now is not None and now.rla is not None and now.distance <= self._critic.insert_beyond:
            rla = now.rla
            event = ActionReplaced(rla.rla_id, command.appraisal, rla.action, origin)
            return LessonResult(
                rla_outcome(ResultCode.RLA_CORRECTED, rla, action=command.appraisal, was=rla.action), event
            )
        rla = Rla(
            rla_id=self._system.next_id,
            condition=tuple(vector.tolist()),
            action=command.appraisal,
            radius=None,
            origin=origin,
            level=CRITIC,
        )
        return LessonResult(rla_outcome(ResultCode.RLA_TAUGHT, rla, action=rla.action), RlaCreated(rla))
