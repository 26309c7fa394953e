"""Teaching the critic what a situation was worth (paper, phase 4)."""

from kurt2rt.core.critic.critic import Critic
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.rla import CRITIC, ActionReplaced, Appraised, Origin, Rla, RlaCreated
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.commands import Appraise
from kurt2rt.core.teaching.lesson_result import LessonResult, rla_outcome


class AppraisalLessons:
    """Turns what a teacher says of a situation into the event that teaches it to the critic."""

    def __init__(self, critic: Critic, system: RlaSystem, recent: DecisionHistory) -> None:
        self._critic = critic
        self._system = system
        self._recent = recent

    @property
    def appraisals(self) -> tuple[str, ...]:
        """Names that a situation can be given."""
        return self._critic.appraisals

    def build(self, command: Appraise, meant: int, origin: Origin) -> LessonResult:
        """Return what is done and its event; `meant`: a tick that is remembered. Raises CommandRefusedError.

        Another opinion than the critic's is learnt, the same one only counts for how far they agree. What the critic
        has come to think since that tick counts for nothing: it may have learnt it from what was said just before.
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
