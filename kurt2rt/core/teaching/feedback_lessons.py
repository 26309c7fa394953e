"""Lessons about what was done or taught before: rewards, appraisals (paper, phases 3 and 4) and undos."""

from dataclasses import replace

from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode, refuse
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.events import ActionReplaced, Appraised, LessonUndone, RlaCreated, RlaRewarded
from kurt2rt.core.rla.lesson_history import DERIVED, hold_of
from kurt2rt.core.rla.rla import BASIC, CRITIC, MID, Origin, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.commands import Appraise, Reward
from kurt2rt.core.teaching.knowledge_updater import HandlerParts, LessonResult, require_rla, rla_outcome


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
        learning = critic.settings.learning
        nearer_than = learning.insert_radius_fraction * learning.radius
        if now is not None and now.rla is not None and now.distance <= nearer_than:
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


class UndoLessons:
    """Builder of the events that undo lessons; it applies none."""

    def __init__(self, level: BasicLevel, parts: HandlerParts) -> None:
        self._level = level
        self._system = level.system
        self._appraisals = None if parts.critic is None else parts.critic.appraisals
        self._mid = parts.mid
        self._learner = parts.learner

    def build(self, named: str | None, origin: Origin) -> LessonResult:
        """Return the outcome and events that undo a lesson, or all of a hold, by its id.

        `named`: None: the last standing lesson, with the hold that it belongs to. Raises CommandRefusedError.
        """
        lesson = named or self._system.history.last_standing
        if lesson is None:
            raise CommandRefusedError(RefusalCode.NO_LESSON)
        hold = hold_of(lesson) if named is None else None
        if hold is not None or self._system.history.of_hold(lesson):
            return self._undo_hold(hold or lesson, origin)
        refuse(self._system.history.why_not_undo(lesson))
        self._require_restorable(lesson)
        record = self._system.history.get(lesson)
        assert record is not None
        return LessonResult(Outcome.of(ResultCode.LESSON_UNDONE, says=record.text), LessonUndone(lesson, origin))

    def _undo_hold(self, hold: str, origin: Origin) -> LessonResult:
        """Undo all standing lessons of a hold, newest first; the last undo has the command's own id."""
        refuse(self._system.history.why_not_undo_hold(hold))
        standing = self._system.history.standing_of_hold(hold)[::-1]
        for command_id in standing:
            self._require_restorable(command_id)
        origins = [replace(origin, command_id=f"{origin.command_id}{DERIVED}{n}") for n in range(1, len(standing))]
        if self._learner is not None:
            self._learner.team.undo_hold(hold)
        before = tuple(map(LessonUndone, standing, origins))
        outcome = Outcome.of(ResultCode.HOLD_UNDONE, lessons=len(standing))
        return LessonResult(outcome, LessonUndone(standing[-1], origin), before)

    def _require_restorable(self, lesson: str) -> None:
        """Raise CommandRefusedError if an undo would restore an action that the task lacks."""
        back = self._system.restored_by_undo(lesson)
        if back is not None and not self._can_act(back):
            refuse(rla_outcome(RefusalCode.ACTION_NOT_IN_TASK, back, action=back.action))

    def _can_act(self, rla: Rla) -> bool:
        """Return whether an RLA that comes back can act here; knowledge may be older than the task, or another's."""
        behaviours = self._level.active_behaviour.behaviours
        if rla.level == BASIC:
            return rla.behaviour in behaviours and (rla.is_withdrawn or rla.action in self._level.repertoire)
        if rla.level == MID:
            return self._mid is None or rla.is_withdrawn or rla.action in behaviours
        return self._appraisals is None or rla.action in self._appraisals
