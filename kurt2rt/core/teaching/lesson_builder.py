"""Lesson builder: from a teacher's command to the event that changes the knowledge."""

from collections import Counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.learner.learner import Why
from kurt2rt.core.outcome import CommandRefusedError, RefusalCode, ResultCode, refuse
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.events import ActionReplaced, RlaCreated, RlaDeleted, TeachingEvent
from kurt2rt.core.rla.lesson_history import hold_of
from kurt2rt.core.rla.rla import BASIC, MID, Origin, Rla
from kurt2rt.core.teaching.commands import Appraise, Correct, DeleteRla, ReplaceAction, Reward, Teach, Undo
from kurt2rt.core.teaching.feedback_lessons import FeedbackLessons, UndoLessons
from kurt2rt.core.teaching.knowledge_updater import (
    HandlerParts,
    LessonResult,
    require_action,
    require_rla,
    rla_outcome,
)
from kurt2rt.core.teaching.late_press import RewindHistory

LessonCommand = Teach | Correct | ReplaceAction | DeleteRla | Reward | Appraise | Undo
"""Command that changes the knowledge."""


class LessonContext(NamedTuple):
    """Situation that a lesson is about, with its level and behaviour, and the RLA that answered there."""

    vector: NDArray[np.float64]
    """Situation of the level, shape (d,)."""
    behaviour: str
    """Behaviour that the lesson belongs to; empty if the level has a single one."""
    level: str
    drove: int | None
    """RLA that answered there; None if none did."""
    insert_radius_fraction: float
    """A correction farther than this share of R from the nearest condition inserts a new RLA, else it replaces."""
    touched: bool = False
    """True if the robot asked at a bumper: an answer corrects the RLA that pushed on."""


class LessonBuilder:
    """Builder of the events of lessons, also about decisions of the last seconds; it applies none."""

    def __init__(
        self,
        level: BasicLevel,
        recent: DecisionHistory,
        rewind: RewindHistory,
        insert_radius_fraction: float,
        parts: HandlerParts,
    ) -> None:
        """Connect the level and its optional parts.

        Args:
            level: whose RLAs are taught.
            recent: decisions that rewards and appraisals can be about.
            rewind: decisions that answers and corrections can be about.
            insert_radius_fraction: a correction farther than this share of R from the nearest condition inserts an RLA.
            parts: of the command handler.
        """
        self._level = level
        self._system = level.system
        self._recent = recent
        self._rewind = rewind
        self._insert_radius_fraction = insert_radius_fraction
        self._reinforcement = parts.reinforcement
        self._appraisals = () if parts.critic is None else parts.critic.appraisals
        self._mid = parts.mid
        self._answers_override_holds = parts.answers_override_holds
        self._learner = parts.learner
        self._feedback = FeedbackLessons(level.system, recent, parts)
        self._undos = UndoLessons(level, parts)
        self.corrections_at: Counter[str] = Counter()
        """Number of corrections by level."""

    def build(self, command: LessonCommand, situation: Situation, origin: Origin) -> LessonResult:
        """Return the outcome and event of a command in the present `situation`; apply nothing.

        Raises CommandRefusedError for an unknown action, RLA, lesson or tick, and for a lesson that cannot be undone.
        """
        match command:
            case Teach() | Correct():
                return self._action_lesson(command, situation, origin)
            case ReplaceAction() | DeleteRla() if self._learner is not None:
                raise CommandRefusedError(RefusalCode.NO_RLA_DECIDES)
            case ReplaceAction(rla_id=rla_id, action=action):
                rla = require_rla(rla_id, self._system)
                self._require_action_of(rla.level, action)
                other = self._competitor_with(action, rla)
                if other is not None:
                    refuse(rla_outcome(RefusalCode.SAYS_SO, other, action=action, delete=rla_id))
                return self._replace(rla, action, origin)
            case DeleteRla(rla_id=rla_id):
                deleted = rla_outcome(ResultCode.RLA_DELETED, require_rla(rla_id, self._system))
                return LessonResult(deleted, RlaDeleted(rla_id, origin))
            case Reward() if self._learner is not None:
                raise CommandRefusedError(RefusalCode.NO_SIGNALS)
            case Reward():
                return self._feedback.reward(command, origin)
            case Appraise():
                return self._feedback.appraise(command, origin)
            case Undo(lesson=lesson):
                return self._undos.build(lesson, origin)

    def held(self, action: str, meant: int, origin: Origin, *, counts: bool) -> TeachingEvent | None:
        """Return the lesson that a held action gives about a remembered tick; None if it would be done there already.

        Args:
            action: of the repertoire.
            meant: tick that had a situation.
            origin: of the lesson.
            counts: whether a lesson counts as a correction.

        Raises:
            CommandRefusedError: if the tick was forgotten or had no situation.
        """
        context = self._basic_context(meant, None)
        self._label(action, context, Why.HOLD, origin)
        event = self._in_context(action, context, origin, yields=self._answers_override_holds)
        if event is not None and counts:
            self.corrections_at[BASIC] += 1
        return event

    def shown(self, action: str, vector: NDArray[np.float64], behaviour: str, origin: Origin) -> TeachingEvent | None:
        """Return the lesson that a shown action gives a situation `vector` (d,) of the basic level.

        Returns None if the robot would do that action there already.
        """
        context = LessonContext(vector, behaviour, BASIC, None, self._insert_radius_fraction)
        self._label(action, context, Why.SHOWN, origin)
        return self._in_context(action, context, origin)

    def _in_context(
        self, action: str, context: LessonContext, origin: Origin, *, yields: bool = False
    ) -> TeachingEvent | None:
        """Return the lesson of an action in a context; None if it would be done already, or yields to an answer."""
        nearest = self._system.match(context.vector, context.behaviour, BASIC)
        if self._agreeing(nearest, context, action) is not None:
            return None
        share = context.insert_radius_fraction
        if yields and nearest is not None and self._is_within(share, nearest) and _is_exact(nearest.rla):
            return None
        return self._corrected(action, nearest, context, share, origin).event

    def _label(self, action: str, context: LessonContext, why: Why, origin: Origin) -> None:
        """Give a lesson of the basic level to the learner, before the RLAs decide between inserting and replacing."""
        if self._learner is not None and context.level == BASIC:
            self._learner.teach(context.vector, context.behaviour, action, why, origin.command_id)

    def _is_within(self, share: float, nearest: Match) -> bool:
        """Return whether a lesson is about the nearest RLA; of one that is near at another width only it is not."""
        if self._system.is_estimate(nearest):
            return False
        return nearest.distance <= share * self._system.whole_radius(nearest.rla)

    def _action_lesson(self, command: Teach | Correct, situation: Situation, origin: Origin) -> LessonResult:
        """Return the lesson that makes the taught action the answer to the situation that the command means."""
        if command.level == MID:
            if self._mid is None:
                raise CommandRefusedError(RefusalCode.NO_MID_LEVEL)
            self._require_action_of(MID, command.action)
            vector, commanded = self._mid.meant(command.decision_tick)
            share = self._mid.mid.settings.learning.insert_radius_fraction
            context = LessonContext(vector, "", MID, commanded, share)
        elif command.level == BASIC:
            self._require_action_of(BASIC, command.action)
            context = self._basic_context(command.decision_tick, situation)
        else:
            raise CommandRefusedError(RefusalCode.NO_LEVEL, level=command.level, known=(BASIC, MID))
        nearest = self._system.match(context.vector, context.behaviour, context.level)
        if isinstance(command, Teach) and command.alternative:
            return self._add_alternative(command.action, context, nearest, origin)
        self._label(command.action, context, _why(command), origin)
        if isinstance(command, Correct) and command.late:
            agreeing = self._agreeing(nearest, context, command.action)
            if agreeing is not None:  # an earlier press was about the same mistake
                return LessonResult(rla_outcome(ResultCode.RLA_AGREES, agreeing, action=command.action))
        # A second RLA on the same condition would never win, because the older one does.
        replace_within_share = 0.0
        if isinstance(command, Correct):
            self.corrections_at[command.level] += 1
            replace_within_share = context.insert_radius_fraction
        elif context.touched or (nearest is not None and nearest.rla.is_withdrawn):
            replace_within_share = context.insert_radius_fraction  # it waits for this answer
        elif context.level == MID and nearest is not None and _is_at_known_place(nearest, context):
            return self._add_alternative(command.action, context, nearest, origin)
        return self._corrected(command.action, nearest, context, replace_within_share, origin)

    def _corrected(
        self, action: str, nearest: Match | None, context: LessonContext, replace_within_share: float, origin: Origin
    ) -> LessonResult:
        """Replace the action of the nearest RLA within a share of its radius, else create another one."""
        if nearest is None or not self._is_within(replace_within_share, nearest):
            return self._create(action, context, origin)
        rla = self._corrected_rla(nearest.rla, context)
        if rla.action == action:
            return LessonResult(rla_outcome(ResultCode.RLA_AGREES, rla, action=action))
        other = self._competitor_with(action, rla)
        if other is not None:
            return LessonResult(rla_outcome(ResultCode.RLA_CONFLICTS, other, action=action))
        return self._replace(rla, action, origin)

    def _agreeing(self, nearest: Match | None, context: LessonContext, action: str) -> Rla | None:
        """Return the RLA that would do an action in a known situation already; None if it would be another action."""
        if nearest is None or not nearest.known:
            return None
        rla = self._corrected_rla(nearest.rla, context)
        return rla if rla.action == action else None

    def _basic_context(self, decision_tick: int | None, situation: Situation | None) -> LessonContext:
        share = self._insert_radius_fraction
        if decision_tick is None:
            assert situation is not None
            newest = self._recent.newest
            drove, touched = self._recent.driving_rla(newest), self._recent.touched(newest)
            return LessonContext(situation.vector, self._level.active_behaviour.behaviour, BASIC, drove, share, touched)
        found = self._rewind.find(decision_tick)
        if found is None:
            raise CommandRefusedError(RefusalCode.TICK_FORGOTTEN, tick=decision_tick)
        history, at = found
        if not history.has_situation(at):
            raise CommandRefusedError(RefusalCode.WAS_BLIND)
        drove, touched = history.driving_rla(at), history.touched(at)
        return LessonContext(history.situation(at), history.behaviour(at), BASIC, drove, share, touched)

    def _add_alternative(
        self, action: str, context: LessonContext, nearest: Match | None, origin: Origin
    ) -> LessonResult:
        """Create another RLA on the condition of those that know the situation, or the first one there."""
        if context.level != MID:
            raise CommandRefusedError(RefusalCode.NO_OTHER_WAY)
        if nearest is None or not nearest.known:
            return self._create(action, context, origin)
        for rla in self._system.competitors(nearest.rla):
            if rla.action == action:
                return LessonResult(rla_outcome(ResultCode.RLA_AGREES, rla, action=action))
        return self._create(action, context, origin, competitor=nearest.rla)

    def _corrected_rla(self, nearest: Rla, context: LessonContext) -> Rla:
        """Return which of several RLAs on one condition is meant: the one that drove, or else the one that would."""
        group = self._system.competitors(nearest)
        if len(group) == 1 or nearest.is_withdrawn:
            return nearest
        for rla in group:
            if rla.rla_id == context.drove:
                return rla
        if context.level != BASIC or self._reinforcement is None:
            return nearest
        return self._reinforcement.choice.best(group)

    def _create(
        self, action: str, context: LessonContext, origin: Origin, competitor: Rla | None = None
    ) -> LessonResult:
        rla = Rla(
            rla_id=self._system.next_id,
            condition=tuple(context.vector.tolist()) if competitor is None else competitor.condition,
            action=action,
            radius=None if competitor is None else competitor.radius,
            origin=origin,
            behaviour=context.behaviour,
            level=context.level,
        )
        if competitor is None:
            outcome = rla_outcome(ResultCode.RLA_TAUGHT, rla, action=action)
        else:
            outcome = rla_outcome(ResultCode.RLA_ADDED, rla, action=action, next_to=competitor.rla_id)
        return LessonResult(outcome, RlaCreated(rla))

    def _replace(self, rla: Rla, action: str, origin: Origin) -> LessonResult:
        taught, instead_of = self._system.as_taught(rla, action), self._system.as_taught(rla, rla.action)
        event = ActionReplaced(rla.rla_id, taught, instead_of, origin)
        if rla.is_withdrawn:
            return LessonResult(rla_outcome(ResultCode.RLA_ANSWERED, rla, action=action), event)
        return LessonResult(rla_outcome(ResultCode.RLA_CORRECTED, rla, action=action, was=rla.action), event)

    def _competitor_with(self, action: str, rla: Rla) -> Rla | None:
        """Return another mid-level RLA on the same condition with this action; no two may be equal."""
        if rla.level != MID or rla.is_withdrawn:
            return None
        return next((each for each in self._system.competitors(rla) if each is not rla and each.action == action), None)

    def _require_action_of(self, level_name: str, action: str) -> None:
        """Raise CommandRefusedError, which lists the actions of a level, if `action` is none of them."""
        if level_name == MID:
            names = self._level.active_behaviour.behaviours
            if action not in names:
                raise CommandRefusedError(RefusalCode.NO_BEHAVIOUR, behaviour=action, known=names)
        else:
            require_action(action, self._level.repertoire if level_name == BASIC else self._appraisals)


def _why(command: Teach | Correct) -> Why:
    if isinstance(command, Teach):
        return Why.ANSWER
    return Why.LATE if command.late else Why.CORRECTION


def _is_exact(rla: Rla) -> bool:
    """Return whether an RLA has an action that no hold taught: the moment of a hold's lesson is an estimate."""
    return not rla.is_withdrawn and hold_of(rla.origin.command_id) is None


def _is_at_known_place(nearest: Match, context: LessonContext) -> bool:
    """Return whether a situation is so near to a known place that a second one would be the same place."""
    return (
        context.insert_radius_fraction > 0.0
        and nearest.known
        and (nearest.distance <= context.insert_radius_fraction * nearest.radius)
    )
