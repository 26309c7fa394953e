"""Teaching events in words, with undone lessons named by their content."""

from kurt2rt.core.rla.events import (
    Appraised,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    SessionBegun,
    SessionEnded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.core.rla.lesson_history import LessonRecord, rla_id_of
from kurt2rt.core.rla.rla import BASIC


class LessonDescriber:
    """Description of teaching events that remembers earlier lessons, to name them in an undo or redo."""

    def __init__(self) -> None:
        self._texts: dict[str, str] = {}
        self._home_of: dict[int, tuple[str, str]] = {}
        """Behaviour and level of each RLA."""

    def describe(self, event: TeachingEvent) -> str:
        """Return the event in a few words, with its teacher."""
        by = event.origin.teacher
        match event:
            case LessonUndone(lesson):
                return f"undone: {self._texts.get(lesson, 'a lesson')} ({by})"
            case LessonRedone(lesson):
                return f"redone: {self._texts.get(lesson, 'a lesson')} ({by})"
            case SessionBegun(name):
                return f"session {name} begun by {by}"
            case SessionEnded():
                return f"session ended by {by}"
            case Appraised(appraisal):
                return f"called {appraisal} ({by})"
            case RlaCreated(rla):
                self._home_of[rla.rla_id] = rla.behaviour, rla.level
        behaviour, level = (
            ("", BASIC) if isinstance(event, SituationNamed) else self._home_of.get(rla_id_of(event), ("", BASIC))
        )
        text = LessonRecord(event, behaviour=behaviour, level=level).text
        self._texts[event.origin.command_id] = text
        return f"{text} ({by})"
