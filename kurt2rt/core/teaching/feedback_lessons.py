"""Lessons that judge what the robot did: rewards and appraisals (paper, phases 3 and 4)."""

from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode, refuse
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.events import ActionReplaced, Appraised, RlaCreated, RlaRewarded
from kurt2rt.core.rla.rla import CRITIC, Origin, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.commands import Appraise, Reward
from kurt2rt.core.teaching.handler_parts import HandlerParts
from kurt2rt.core.teaching.lesson_result import LessonResult, require_rla, rla_outcome


class FeedbackLessons:
    """Builder of the events of rewards and appraisals; it applies none."""

    def __init__(self, system: RlaSystem, recent: DecisionHistory, parts: HandlerParts) -> None:
        """Connect the RLAs, and the decisions that feedback is about."""
        self._system = system
        self._recent = recent
        self._reinforcement = parts.reinforcement
        self._critic = parts.critic

    def reward(self, command: Reward, origin: Origin) -> LessonResult:
        """Return the outcome and event of a reward for the decision of a remembered tick.

        Raises CommandRefusedError for a tick that was forgotten, drove slowly or had no RLA that answered.
        """
        meant = self._known_tick(command.decision_tick)
        rla_id = self._recent.driving_rla(meant)
        if rla_id is None:
            raise CommandRefusedError(RefusalCode.NO_RLA_DROVE)
        self._require_full_speed(meant)
        rla = require_rla(rla_id, self._system)
        if self._recent.answering_rla(meant) != rla_id:
            refuse(rla_outcome(RefusalCode.OUTSIDE_RADIUS, rla))
        credits_ = () if self._reinforcement is None else self._reinforcement.credits_for(command.value, meant)
        opinion = self._recent.opinion(meant)
        said = None if opinion is None else opinion.said
        code = ResultCode.RLA_REWARDED if command.value > 0 else ResultCode.RLA_PUNISHED
        return LessonResult(rla_outcome(code, rla), RlaRewarded(rla_id, command.value, meant, origin, credits_, said))

    def appraise(self, command: Appraise, origin: Origin) -> LessonResult:
        """Return the outcome and the event of an appraisal of a remembered tick.

        An appraisal unlike the critic's present opinion is learnt. An equal one counts as agreement, but only if the
        critic was of that opinion in that tick already: it may have learnt it from an appraisal in between.

        Raises:
            CommandRefusedError: for an unknown value, or a tick that was forgotten, drove slowly or had no situation.
        """
        critic = self._critic
        if critic is None:
            raise CommandRefusedError(RefusalCode.NO_CRITIC)
        meant = self._known_tick(command.decision_tick)
        self._require_full_speed(meant)
        if command.appraisal not in critic.appraisals:
            raise CommandRefusedError(RefusalCode.NO_APPRAISAL, appraisal=command.appraisal, known=critic.appraisals)
        circumstances = self._recent.circumstances(meant)
        if circumstances is None:
            raise CommandRefusedError(RefusalCode.WAS_BLIND)
        vector = critic.to_vector(circumstances)
        now, then = critic.opinion(vector), self._recent.opinion(meant)
        if now is not None and now.known and now.appraisal == command.appraisal:
            if then is not None and then.known and then.appraisal == command.appraisal:
                value = critic.settings.values[command.appraisal]
                agreed = Outcome.of(ResultCode.CRITIC_AGREED, appraisal=command.appraisal)
                return LessonResult(agreed, Appraised(command.appraisal, value, meant, origin))
            return LessonResult(Outcome.of(ResultCode.CRITIC_AGREES, appraisal=command.appraisal))
        if now is not None and now.rla is not None and now.distance <= critic.insert_beyond:
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

    def _require_full_speed(self, tick: int) -> None:
        """Raise CommandRefusedError if a stored tick was slow: values and critic are about driving at full speed."""
        if self._recent.slow(tick):
            raise CommandRefusedError(RefusalCode.DROVE_SLOWLY)

    def _known_tick(self, decision_tick: int | None) -> int:
        # Default to the newest remembered tick: the previous number may have been missed.
        meant = self._recent.newest if decision_tick is None else decision_tick
        if not self._recent.contains(meant):
            raise CommandRefusedError(RefusalCode.TICK_FORGOTTEN, tick=meant)
        return meant
