"""Undo of lessons, alone or all of a hold."""

from dataclasses import replace

from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode, refuse
from kurt2rt.core.rla.events import LessonUndone
from kurt2rt.core.rla.lesson_history import DERIVED, hold_of
from kurt2rt.core.rla.rla import BASIC, MID, Origin, Rla
from kurt2rt.core.teaching.handler_parts import HandlerParts
from kurt2rt.core.teaching.lesson_result import LessonResult, rla_outcome


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
        record = self._system.lesson(lesson)
        assert record is not None
        return LessonResult(Outcome.of(ResultCode.LESSON_UNDONE, says=record.text), LessonUndone(lesson, origin))

    def _undo_hold(self, hold: str, origin: Origin) -> LessonResult:
        """Undo all standing lessons of a hold, newest first; the last undo has the command's own id."""
        refuse(self._system.history.why_not_undo_hold(hold))
        standing = []
        for command_id in reversed(self._system.history.of_hold(hold)):
            record = self._system.lesson(command_id)
            assert record is not None
            if not record.undone:
                self._require_restorable(command_id)
                standing.append(command_id)
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
