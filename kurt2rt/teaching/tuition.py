"""What a teacher's command teaches: the event that changes the knowledge as he said."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from kurt2rt.layers.basic_level import BasicLevel
from kurt2rt.perception.perception import Situation
from kurt2rt.reinforcement.reinforcement import Reinforcement
from kurt2rt.rla.rla import (
    BASIC,
    ActionReplaced,
    LessonUndone,
    Origin,
    Rla,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    TeachingEvent,
)
from kurt2rt.teaching.appraising import Appraising
from kurt2rt.teaching.commands import Appraise, Correct, DeleteRla, ReplaceAction, Reward, Teach, Undo
from kurt2rt.teaching.recent import RecentDecisions
from kurt2rt.teaching.refused import RefusedError, refuse

LessonCommand = Teach | Correct | ReplaceAction | DeleteRla | Reward | Appraise | Undo
"""Commands that are about the knowledge."""

Taught = tuple[str, TeachingEvent | None]
"""What was done, in words, and the event that does it; None where nothing had to be."""


class Tuition:
    """Makes the events of lessons, and applies none; the teacher may mean a decision of the last seconds."""

    def __init__(
        self,
        level: BasicLevel,
        recent: RecentDecisions,
        *,
        insert_beyond_share: float,
        reinforcement: Reinforcement | None,
        appraising: Appraising | None,
    ) -> None:
        """Without `reinforcement` rewards are only counted; without `appraising` there is no critic to teach."""
        self._level = level
        self._system = level.system
        self._recent = recent
        self._insert_beyond_share = insert_beyond_share
        self._reinforcement = reinforcement
        self._appraising = appraising
        self._appraisals: tuple[str, ...] = () if appraising is None else appraising.appraisals
        self.corrections = 0

    def event_of(self, command: LessonCommand, situation: Situation, origin: Origin) -> Taught:
        """What a command teaches in the present `situation`. Raises RefusedError."""
        match command:
            case Teach() | Correct():
                return self._lesson(command, situation, origin)
            case ReplaceAction(rla_id=rla_id, action=action):
                rla = self._require_rla(rla_id)
                require_action(action, self._level.repertoire if rla.level == BASIC else self._appraisals)
                return self._replace(rla, action, origin)
            case DeleteRla(rla_id=rla_id):
                return f"{self._require_rla(rla_id).title} deleted", RlaDeleted(rla_id, origin)
            case Reward():
                return self._reward(command, origin)
            case Appraise():
                return self._appraise(command, origin)
            case Undo(lesson=lesson):
                return self._undo(lesson or self._system.last_standing_lesson, origin)

    def _lesson(self, command: Teach | Correct, situation: Situation, origin: Origin) -> Taught:
        require_action(command.action, self._level.repertoire)
        meant, behaviour = situation.vector, self._level.wanted.behaviour
        if command.decision_tick is not None:
            self._require_known(command.decision_tick)
            if not self._recent.saw(command.decision_tick):
                raise RefusedError("the infra-red sensors were silent then, so there is no situation to teach")
            meant = self._recent.situation(command.decision_tick)
            behaviour = self._recent.behaviour(command.decision_tick)
        nearest = self._system.match(meant, behaviour)
        # On the very condition of an RLA a second one would never win: the older one does.
        replace_within_share = 0.0
        if isinstance(command, Correct):
            self.corrections += 1
            replace_within_share = self._insert_beyond_share
        elif nearest is not None and nearest.rla.asks:
            replace_within_share = self._insert_beyond_share  # it waits for this answer
        if nearest is None or nearest.distance > replace_within_share * nearest.radius:
            return self._create(command.action, meant, behaviour, origin)
        rla = self._of_competitors(nearest.rla, command.decision_tick)
        if rla.action == command.action:
            return f"{rla.title} says {command.action} already", None
        return self._replace(rla, command.action, origin)

    def _of_competitors(self, nearest: Rla, decision_tick: int | None) -> Rla:
        """Where several stand on one condition: the one that drove then, else the one that would answer."""
        group = self._system.competitors(nearest)
        if len(group) == 1 or nearest.asks or self._reinforcement is None:
            return nearest
        drove = self._recent.rla(self._recent.newest if decision_tick is None else decision_tick)
        return next((rla for rla in group if rla.rla_id == drove), self._reinforcement.choice.best(group))

    def _create(self, action: str, meant: NDArray[np.float64], behaviour: str, origin: Origin) -> Taught:
        rla = Rla(
            rla_id=self._system.next_id,
            condition=tuple(meant.tolist()),
            action=action,
            radius=None,
            origin=origin,
            behaviour=behaviour,
        )
        return f"{rla.title} taught: {rla.action}", RlaCreated(rla)

    def _replace(self, rla: Rla, action: str, origin: Origin) -> Taught:
        event = ActionReplaced(rla.rla_id, action, rla.action, origin)
        if rla.asks:
            return f"{rla.title} answered anew: {action}", event
        return f"{rla.title} corrected: {action} instead of {rla.action}", event

    def _reward(self, command: Reward, origin: Origin) -> Taught:
        meant = self._meant(command.decision_tick)
        rla_id = self._recent.rla(meant)
        if rla_id is None:
            raise RefusedError("no RLA drove the robot then; there is nothing to reward or to punish")
        title = self._require_rla(rla_id).title
        if self._recent.answering(meant) != rla_id:
            raise RefusedError(f"the situation lay outside the radius of {title}, or it stood; nobody is blamed for it")
        credits_ = () if self._reinforcement is None else self._reinforcement.credits_of(command.value, meant)
        opinion = self._recent.opinion(meant)
        said = None if opinion is None else opinion.said
        word = "rewarded" if command.value > 0 else "punished"
        return f"{title} {word}", RlaRewarded(rla_id, command.value, meant, origin, credits_, said)

    def _appraise(self, command: Appraise, origin: Origin) -> Taught:
        if self._appraising is None:
            raise RefusedError("this robot has no critic")
        return self._appraising.event_of(command, self._meant(command.decision_tick), origin)

    def _undo(self, lesson: str | None, origin: Origin) -> Taught:
        if lesson is None:
            raise RefusedError("there is no lesson to undo")
        refuse(self._system.why_not_undo(lesson))
        record = self._system.lesson(lesson)
        assert record is not None
        return f"undone: {record.text}", LessonUndone(lesson, origin)

    def _meant(self, decision_tick: int | None) -> int:
        # The newest, not the tick before this one, which may have been missed.
        meant = self._recent.newest if decision_tick is None else decision_tick
        self._require_known(meant)
        return meant

    def _require_rla(self, rla_id: int) -> Rla:
        rla = self._system.get(rla_id)
        if rla is None:
            raise RefusedError(f"there is no RLA {rla_id}; it may have been deleted")
        return rla

    def _require_known(self, tick: int) -> None:
        if not self._recent.knows(tick):
            raise RefusedError(f"the decision of tick {tick} is not remembered any more; look at the newest picture")


def require_action(action: str, repertoire: Iterable[str]) -> None:
    """Raises RefusedError, which lists those there are, for a name that a repertoire does not have."""
    names = tuple(repertoire)
    if action not in names:
        raise RefusedError(f"there is no action {action!r}; the repertoire has: {', '.join(names)}")
