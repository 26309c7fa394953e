"""Listing of the texts of `kurt2rt.core.outcome_text`."""

from collections.abc import Iterator

from kurt2rt.core.decision.decision import GoalStatus
from kurt2rt.core.outcome import Code, Field, Outcome, RefusalCode, ResultCode
from kurt2rt.core.outcome_text import Surface, event_error_text, fields_of, text_of
from kurt2rt.core.rla.events import EventFault, InvalidEventError
from kurt2rt.core.rla.rla import MID

SAMPLES: dict[str, Field] = {
    "action": "forward",
    "appraisal": "bad",
    "behaviour": "turn_left",
    "command": "door",
    "command_id": "t/1",
    "delete": 4,
    "earlier": "ann-1",
    "error": "OSError(5)",
    "features": ("smell",),
    "goal": "door",
    "known": ("back", "forward"),
    "later": "ann-3",
    "lesson": "ann-2",
    "lessons": 12,
    "level": MID,
    "longest": 64,
    "most_bytes": 1000,
    "name": "door",
    "least": 20,
    "next_to": 4,
    "offset": 896,
    "percent": 60,
    "phase": 2,
    "rla": 7,
    "says": "<words of another table>",
    "segments": 3,
    "session": "morning",
    "sign": "/",
    "situations": 40,
    "size": 4096,
    "teacher": "Ann",
    "teachers": ("Ann", "Ben"),
    "status": "planning",
    "task": "eight",
    "tick": 1200,
    "ticks": 50,
    "times": 4,
    "was": "back",
    "world": "a",
}
"""One value for every field that a text shows."""


def sample(code: Code) -> Outcome:
    """Return an outcome with a value in every field that its text shows."""
    return Outcome(code, {name: SAMPLES[name] for name in sorted(fields_of(code))})


def on_page() -> Iterator[tuple[str, str]]:
    """Yield the page's text of each outcome."""
    return _each(Surface.PAGE)


def in_terminal() -> Iterator[tuple[str, str]]:
    """Yield the terminal's text of each outcome."""
    return _each(Surface.TERMINAL)


def in_log() -> Iterator[tuple[str, str]]:
    """Yield the text of each outcome in logs and on the wire."""
    return _each(Surface.LOG)


def _each(surface: Surface) -> Iterator[tuple[str, str]]:
    for code in (*ResultCode, *RefusalCode):
        yield code, text_of(sample(code), surface)
    taught = Outcome.of(ResultCode.RLA_TAUGHT, rla=7, behaviour="turn_left", level=MID, action="back")
    yield f"{taught.code}, behaviour and level", text_of(taught, surface)
    late = Outcome.of(ResultCode.RLA_CORRECTED, rla=7, action="back", was="forward")
    for rla, answers in ((7, 0), (None, 9)):
        fields: dict[str, Field] = {"decision_tick": 1200, "put_back_ticks": 83, "decided_by": rla}
        text = text_of(Outcome(late.code, {**late.fields, **fields, "delay_answers": answers}), surface)
        yield f"{late.code}, put back to {'no RLA' if rla is None else 'an RLA'} by {answers} answers", text
    alone = Outcome(taught.code, {**taught.fields, "against": ("forward", "bear_left"), "nearest": 3})
    yield f"{taught.code}, contradicts its neighbours", text_of(alone, surface)
    wanted = Outcome.of(ResultCode.BEHAVIOUR_WANTED, behaviour="")
    yield f"{wanted.code}, without a name", text_of(wanted, surface)
    for status in (each.value for each in GoalStatus if each is not GoalStatus.NONE):
        sought = Outcome.of(ResultCode.GOAL_SOUGHT, goal="door", status=status)
        yield f"{sought.code}, {status}", text_of(sought, surface)
    unnamed = Outcome.of(RefusalCode.NOT_NAMED, name="door", known=())
    yield f"{unnamed.code}, none known", text_of(unnamed, surface)


def event_faults() -> Iterator[tuple[str, str]]:
    """Yield the text of each event that does not fit."""
    fields: dict[str, int | str] = {
        "lesson": "7f3a",
        "command_id": "7f3a",
        "rla_id": 7,
        "last": 5,
        "error": "its condition has 3 values, level basic matches 2",
        "name": "door",
        "got": 3,
        "level": "mid",
        "expected": 12,
        "action": "ask",
        "value": 2,
        "title": "RLA 7 of turn_left",
    }
    for fault in EventFault:
        yield fault, event_error_text(InvalidEventError(fault, fields))
    refusal = sample(RefusalCode.TAUGHT_AFTER)
    refused = InvalidEventError(EventFault.NOT_UNDOABLE, {"lesson": "7f3a"}, refusal)
    yield f"{refused.fault}, {refusal.code}", event_error_text(refused)
