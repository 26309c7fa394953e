"""A teaching event as one line of JSON, exact to the last bit of every float64."""

import json
import math
import sys
from typing import Any

from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    Appraised,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    SessionEnded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError

EVENT_VERSION = 1
"""Version of the fields below."""

_ORIGIN = ("command_id", "teacher", "phase", "tick")
_FIELDS = {
    "created": ("rla_id", "condition", "action", "radius", "behaviour", "level", *_ORIGIN),
    "replaced": ("rla_id", "action", "instead_of", *_ORIGIN),
    "withdrawn": ("rla_id", "instead_of", *_ORIGIN),
    "deleted": ("rla_id", *_ORIGIN),
    "rewarded": ("rla_id", "value", "decided_at_tick", "credits", "said", *_ORIGIN),
    "appraised": ("appraisal", "value", "decided_at_tick", *_ORIGIN),
    "named": ("name", "situation", "level", *_ORIGIN),
    "undone": ("lesson", *_ORIGIN),
    "redone": ("lesson", *_ORIGIN),
    "session begun": ("name", *_ORIGIN),
    "session ended": ("lasted_ticks", *_ORIGIN),
}


def encode_event(event: TeachingEvent) -> str:
    """Return the JSON text of an event.

    Raises:
        KnowledgeError: the event could not be read back: NaN, infinity, wrong types.
    """
    content = {"version": EVENT_VERSION, **_content(event)}
    try:
        _event(content)  # an event that is refused on reading is never written
        return json.dumps(content, allow_nan=False, separators=(",", ":"))
    except (TypeError, ValueError, OverflowError) as error:
        where = f"command {event.origin.command_id!r}"
        raise KnowledgeError(KnowledgeCode.EVENT_NOT_WRITABLE, where=where, **_fields(error)) from error


def decode_event(text: str, where: str) -> TeachingEvent:
    """Return the event in a JSON text; `where` is its place (file and row).

    Raises:
        KnowledgeError: the text is no teaching event; field `key` names the wrong one, empty if there is none.
    """
    try:
        return _event(json.loads(text))
    except (ValueError, OverflowError, RecursionError) as error:
        raise KnowledgeError(KnowledgeCode.NOT_AN_EVENT, where=where, **_fields(error)) from error


class _FieldError(ValueError):
    def __init__(self, key: str, problem: str) -> None:
        super().__init__(problem)
        self.key = key


def _fields(error: Exception) -> dict[str, object]:
    """Return the fields of a KnowledgeError that `error` is the cause of."""
    return {"error": error, "key": error.key if isinstance(error, _FieldError) else ""}


def _content(event: TeachingEvent) -> dict[str, Any]:
    match event:
        case RlaCreated(rla):
            own: dict[str, Any] = {
                "kind": "created",
                "rla_id": rla.rla_id,
                "condition": list(rla.condition),
                "action": rla.action,
                "radius": rla.radius,
                "behaviour": rla.behaviour,
                "level": rla.level,
            }
        case ActionReplaced(rla_id, action, instead_of, _):
            own = {"kind": "replaced", "rla_id": rla_id, "action": action, "instead_of": instead_of}
        case ActionWithdrawn(rla_id, instead_of, _):
            own = {"kind": "withdrawn", "rla_id": rla_id, "instead_of": instead_of}
        case RlaDeleted(rla_id, _):
            own = {"kind": "deleted", "rla_id": rla_id}
        case RlaRewarded(rla_id, value, decided_at_tick, _, credits_, said):
            own = {
                "kind": "rewarded",
                "rla_id": rla_id,
                "value": value,
                "decided_at_tick": decided_at_tick,
                "credits": [[*credit] for credit in credits_],
                "said": said,
            }
        case Appraised(appraisal, value, decided_at_tick, _):
            own = {"kind": "appraised", "appraisal": appraisal, "value": value, "decided_at_tick": decided_at_tick}
        case SituationNamed(name, situation, level, _):
            own = {"kind": "named", "name": name, "situation": list(situation), "level": level}
        case LessonUndone(lesson, _):
            own = {"kind": "undone", "lesson": lesson}
        case LessonRedone(lesson, _):
            own = {"kind": "redone", "lesson": lesson}
        case SessionBegun(name, _):
            own = {"kind": "session begun", "name": name}
        case SessionEnded(lasted_ticks, _):
            own = {"kind": "session ended", "lasted_ticks": lasted_ticks}
    origin = event.origin
    own.update(command_id=origin.command_id, teacher=origin.teacher, phase=origin.phase, tick=origin.tick)
    return own


def _event(content: object) -> TeachingEvent:
    if not isinstance(content, dict):
        raise ValueError(f"a JSON {type(content).__name__} is no object")  # noqa: TRY004 - all problems are of one type
    version = _whole(content, "version", least=1)
    if version != EVENT_VERSION:
        raise _FieldError("version", f"its version is {version}, this kurt2rt reads version {EVENT_VERSION}")
    kind = _text(content, "kind")
    if kind not in _FIELDS:
        raise _FieldError("kind", f"kind is {kind!r}, known are {', '.join(_FIELDS)}")
    foreign = sorted(content.keys() - {"version", "kind", *_FIELDS[kind]})
    if foreign:
        raise _FieldError(foreign[0], f"{kind} has no {', '.join(map(repr, foreign))}")
    origin = Origin(
        _text(content, "command_id"),
        _word(content, "teacher"),
        _phase(content),
        _whole(content, "tick", least=0),
    )
    match kind:
        case "undone":
            return LessonUndone(_text(content, "lesson"), origin)
        case "redone":
            return LessonRedone(_text(content, "lesson"), origin)
        case "appraised":
            value = _opinion(content, "value")
            return Appraised(_word(content, "appraisal"), value, _whole(content, "decided_at_tick", least=0), origin)
        case "named":
            return SituationNamed(
                _text(content, "name"), _numbers(content, "situation"), _text(content, "level"), origin
            )
        case "session begun":
            return SessionBegun(_text(content, "name"), origin)
        case "session ended":
            return SessionEnded(_whole(content, "lasted_ticks", least=0), origin)
    return _about_an_rla(kind, content, origin)


def _about_an_rla(kind: str, content: dict[str, Any], origin: Origin) -> TeachingEvent:
    rla_id = _whole(content, "rla_id", least=1)
    match kind:
        case "created":
            numbers = _numbers(content, "condition")
            radius = _value(content, "radius")
            own_radius = None if radius is None else _number(radius, "radius")
            behaviour, level = _word(content, "behaviour"), _word(content, "level")
            return RlaCreated(Rla(rla_id, numbers, _word(content, "action"), own_radius, origin, behaviour, level))
        case "replaced":
            return ActionReplaced(rla_id, _word(content, "action"), _word(content, "instead_of"), origin)
        case "withdrawn":
            return ActionWithdrawn(rla_id, _word(content, "instead_of"), origin)
        case "rewarded":
            value = _whole(content, "value", least=-1)
            if value not in (1, -1):
                raise _FieldError("value", f"value must be 1 or -1, not {value}")
            meant = _whole(content, "decided_at_tick", least=0)
            said = None if _value(content, "said") is None else _opinion(content, "said")
            return RlaRewarded(rla_id, value, meant, origin, _credits(content), said)
        case _:
            return RlaDeleted(rla_id, origin)


def _credits(content: dict[str, Any]) -> tuple[Credit, ...]:
    rows = _value(content, "credits")
    if not isinstance(rows, list) or not all(isinstance(row, list) and len(row) == 2 for row in rows):
        raise _FieldError("credits", "credits must be a list of (RLA's id, number)")
    return tuple(
        Credit(_whole({"credits": rla_id}, "credits", least=1), _number(change, "credits")) for rla_id, change in rows
    )


def _opinion(content: dict[str, Any], key: str) -> int:
    value = _whole(content, key, least=-1)
    if value > 1:
        raise _FieldError(key, f"{key} must be -1, 0 or 1, not {value}")
    return value


def _value(content: dict[str, Any], key: str) -> object:
    if key not in content:
        raise _FieldError(key, f"{key} is missing")
    value: object = content[key]
    return value


def _text(content: dict[str, Any], key: str) -> str:
    value = _value(content, key)
    if not isinstance(value, str):
        raise _FieldError(key, f"{key} must be a text")
    try:
        value.encode()  # half a surrogate pair is fine for JSON, not for SQLite
    except UnicodeEncodeError as error:
        raise _FieldError(key, f"{key}: {error}") from error
    return value


def _word(content: dict[str, Any], key: str) -> str:
    """Return a text that many events have: interned, so that memory holds it once."""
    value = _text(content, key)
    return sys.intern(value) if type(value) is str else value


def _whole(content: dict[str, Any], key: str, least: int) -> int:
    value = _value(content, key)
    if not isinstance(value, int) or isinstance(value, bool) or value < least:
        raise _FieldError(key, f"{key} must be a whole number from {least}")
    return value


def _phase(content: dict[str, Any]) -> Phase:
    number = _whole(content, "phase", least=1)
    try:
        return Phase(number)
    except ValueError as error:
        raise _FieldError("phase", str(error)) from error


def _numbers(content: dict[str, Any], key: str) -> tuple[float, ...]:
    values = _value(content, key)
    if not isinstance(values, list):
        raise _FieldError(key, f"{key} must be a list of numbers")
    return tuple(_number(each, key) for each in values)


def _number(value: object, key: str) -> float:
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not _is_finite(value):
        raise _FieldError(key, f"{key} must be made of finite numbers")
    return float(value)


def _is_finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond the range of float
        return False
