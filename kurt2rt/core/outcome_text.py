"""Texts of outcomes on each surface."""

from collections.abc import Mapping, Sequence
from enum import StrEnum

from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.goal import goal_text
from kurt2rt.core.decision.standing import Standing, hindrance_text
from kurt2rt.core.outcome import Code, Field, Outcome, ResultCode
from kurt2rt.core.rla.events import InvalidEventError
from kurt2rt.core.rla.rla import BASIC, rla_title


class Surface(StrEnum):
    """Surface on which a teacher reads an outcome; texts name what to press or type there."""

    PAGE = "page"
    TERMINAL = "terminal"
    LOG = "log"
    """Log, and the sentence in a robot's answer."""


_WORDS: dict[Surface, dict[str, str]] = {
    Surface.PAGE: {
        "go": "touch GO",
        "until_go": "until GO",
        "take": "touch Take the robot",
        "press": "let go and press again",
        "look": "look at the page",
    },
    Surface.TERMINAL: {
        "go": "type go",
        "until_go": "until you type go",
        "take": "type take",
        "press": "let go and press again",
        "look": "look at the robot",
    },
    Surface.LOG: {
        "go": "say resume",
        "until_go": "until a teacher says resume",
        "take": "take the robot",
        "press": "let go and press again",
        "look": "look at the robot",
    },
}
"""Names of the controls of each surface."""

_TICKS_PER_S = 100
_ONLY_BEHAVIOUR = "the only behaviour"
_MADE_OF = {"title": ("rla",), "wanted": ("behaviour",), "sought": ("goal", "status")}
"""Name in a text -> fields that it is made of."""


def fields_of(code: Code) -> frozenset[str]:
    """Return the names of the fields that an outcome of a code needs, so that its text can be made."""
    named = code.fields - _WORDS[Surface.LOG].keys()
    return frozenset(each for name in named for each in _MADE_OF.get(name, (name,)))


def text_of(outcome: Outcome, surface: Surface = Surface.LOG) -> str:
    """Return a sentence for the teacher, in the words of a surface. Raises KeyError for a missing field."""
    hindrance = _hindrance_text(outcome)
    if hindrance:
        return hindrance
    text = outcome.code.text.format(**{**_shown(outcome.fields), **_WORDS[surface]})
    return text + _no_lesson_text(outcome) + _late_press_text(outcome.fields) + _contradiction_text(outcome.fields)


def neighbours_text(actions: Sequence[str], nearest: int) -> str:
    """Return what the neighbours of a contradicting RLA say: their actions, and the id of the nearest of them."""
    return f"all near it say {', '.join(actions)} (RLA {nearest} first)"


def event_error_text(error: InvalidEventError) -> str:
    """Return a sentence for an event that does not fit: the refusal's text if there is a refusal."""
    return error.fault.text.format(**error.fields) if error.refusal is None else text_of(error.refusal)


def _hindrance_text(outcome: Outcome) -> str:
    """Return the sentence of a resume after which the robot still stands; empty for other outcomes."""
    stands, says = outcome.fields.get("stands"), str(outcome.fields.get("says", ""))
    if outcome.code is not ResultCode.RESUMED or not isinstance(stands, str):
        return ""
    return f"the robot still stands: {hindrance_text(Standing(StandReason(stands), says=says))}"


def _no_lesson_text(outcome: Outcome) -> str:
    """Return why a hold taught nothing, as the end of its sentence; empty for other outcomes."""
    if outcome.code is not ResultCode.HOLD_RELEASED or outcome.fields.get("lessons") != 0:
        return ""
    return "; the robot does this here already, or was answered here, which a short press corrects"


def _late_press_text(fields: Mapping[str, Field]) -> str:
    """Return the end of the sentence of a late press: the decision that it was given to; empty for other outcomes."""
    back, rla = fields.get("put_back_ticks"), fields.get("decided_by")
    if not isinstance(back, int) or back == 0:
        return ""
    by = f" of RLA {rla}" if isinstance(rla, int) else ""
    answers = fields.get("delay_answers")
    why = f", by {answers} of your answers" if answers else ", the usual delay"
    return f"; given to the decision{by} {back / _TICKS_PER_S:.1f} s before the press{why}"


def _contradiction_text(fields: Mapping[str, Field]) -> str:
    """Return the end of the sentence of a lesson that contradicts its neighbours; empty for other outcomes."""
    actions, nearest = fields.get("against"), fields.get("nearest")
    if not isinstance(actions, tuple) or not isinstance(nearest, int):
        return ""
    return f"; {neighbours_text(actions, nearest)}: undo it if your finger slipped"


def _shown(fields: Mapping[str, Field]) -> dict[str, str | int]:
    shown = {key: _plain(key, each) for key, each in fields.items()}
    shown["wanted"] = shown.get("behaviour") or _ONLY_BEHAVIOUR
    if "goal" in fields:
        shown["sought"] = goal_text(str(fields.get("status")), str(fields["goal"]))
    rla = fields.get("rla")
    if isinstance(rla, int):
        behaviour, level = str(fields.get("behaviour", "")), str(fields.get("level", BASIC))
        shown["title"] = rla_title(rla, behaviour, level, str(fields.get("image", "")))
    return shown


def _plain(key: str, value: Field) -> str | int:
    if isinstance(value, tuple):
        return (" and " if key == "teachers" else ", ").join(
            each or "a single one without a name" for each in value
        ) or "nothing"
    return "" if value is None else value
