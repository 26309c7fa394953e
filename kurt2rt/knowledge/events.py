"""A teaching event as one line of JSON, exact to the last bit of every float64."""

import json
import math
from typing import Any

from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.rla.rla import (
    ActionReplaced,
    LessonUndone,
    Origin,
    Phase,
    Rla,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    SessionEnded,
    TeachingEvent,
)

EVENT_VERSION = 3
"""Raise it when the fields below change, and keep reading the older ones: journals live as long as robots.

Version 1 knew created, replaced and deleted, with the same fields as version 2. Up to version 2 created has no
behaviour: all RLAs belonged to one without a name.
"""

_BEHAVIOURS_SINCE = 3
_ORIGIN = ("command_id", "teacher", "phase", "tick")
_FIELDS = {
    "created": ("rla_id", "condition", "action", "radius", "behaviour", *_ORIGIN),
    "replaced": ("rla_id", "action", "instead_of", *_ORIGIN),
    "deleted": ("rla_id", *_ORIGIN),
    "rewarded": ("rla_id", "value", "decided_at_tick", *_ORIGIN),
    "undone": ("lesson", *_ORIGIN),
    "session begun": ("name", *_ORIGIN),
    "session ended": ("lasted_ticks", *_ORIGIN),
}


def encode_event(event: TeachingEvent) -> str:
    """JSON text of an event. Raises KnowledgeError for one that could not be read back: NaN, infinity, wrong types."""
    content = {"version": EVENT_VERSION, **_content(event)}
    try:
        _event(content)  # what would be refused on reading must never be written
        return json.dumps(content, allow_nan=False, separators=(",", ":"))
    except (TypeError, ValueError, OverflowError) as error:
        name = event.origin.command_id
        raise KnowledgeError(f"command {name!r}: cannot be written: {error}; teach it again") from error


def decode_event(text: str, where: str) -> TeachingEvent:
    """The event that a JSON text stands for. Raises KnowledgeError that begins with `where` (file and row)."""
    try:
        return _event(json.loads(text))
    except (ValueError, OverflowError, RecursionError) as error:
        problem = f"{where}: not a teaching event: {error}"
        raise KnowledgeError(f"{problem}; keep the file, and go on with a backup copy") from error


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
            }
        case ActionReplaced(rla_id, action, instead_of, _):
            own = {"kind": "replaced", "rla_id": rla_id, "action": action, "instead_of": instead_of}
        case RlaDeleted(rla_id, _):
            own = {"kind": "deleted", "rla_id": rla_id}
        case RlaRewarded(rla_id, value, decided_at_tick, _):
            own = {"kind": "rewarded", "rla_id": rla_id, "value": value, "decided_at_tick": decided_at_tick}
        case LessonUndone(lesson, _):
            own = {"kind": "undone", "lesson": lesson}
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
    if version > EVENT_VERSION:
        raise ValueError(f"its version {version} is of a newer kurt2rt, this one reads up to {EVENT_VERSION}")
    kind = _text(content, "kind")
    if version < _BEHAVIOURS_SINCE and kind == "created":
        if "behaviour" in content:
            raise ValueError(f"created has no 'behaviour' in version {version}")
        content = {**content, "behaviour": ""}
    if kind not in _FIELDS:
        raise ValueError(f"kind is {kind!r}, known are {', '.join(_FIELDS)}")
    foreign = sorted(content.keys() - {"version", "kind", *_FIELDS[kind]})
    if foreign:
        raise ValueError(f"{kind} has no {', '.join(map(repr, foreign))}")
    origin = Origin(
        _text(content, "command_id"),
        _text(content, "teacher"),
        Phase(_whole(content, "phase", least=1)),
        _whole(content, "tick", least=0),
    )
    match kind:
        case "undone":
            return LessonUndone(_text(content, "lesson"), origin)
        case "session begun":
            return SessionBegun(_text(content, "name"), origin)
        case "session ended":
            return SessionEnded(_whole(content, "lasted_ticks", least=0), origin)
    return _about_an_rla(kind, content, origin)


def _about_an_rla(kind: str, content: dict[str, Any], origin: Origin) -> TeachingEvent:
    rla_id = _whole(content, "rla_id", least=1)
    match kind:
        case "created":
            condition = _value(content, "condition")
            if not isinstance(condition, list):
                raise ValueError("condition must be a list of numbers")  # noqa: TRY004
            numbers = tuple(_number(each, "condition") for each in condition)
            radius = _value(content, "radius")
            own_radius = None if radius is None else _number(radius, "radius")
            behaviour = _text(content, "behaviour")
            return RlaCreated(Rla(rla_id, numbers, _text(content, "action"), own_radius, origin, behaviour))
        case "replaced":
            return ActionReplaced(rla_id, _text(content, "action"), _text(content, "instead_of"), origin)
        case "rewarded":
            value = _whole(content, "value", least=-1)
            if value not in (1, -1):
                raise ValueError(f"value must be 1 or -1, not {value}")
            return RlaRewarded(rla_id, value, _whole(content, "decided_at_tick", least=0), origin)
        case _:
            return RlaDeleted(rla_id, origin)


def _value(content: dict[str, Any], key: str) -> object:
    if key not in content:
        raise ValueError(f"{key} is missing")
    value: object = content[key]
    return value


def _text(content: dict[str, Any], key: str) -> str:
    value = _value(content, key)
    if not isinstance(value, str):
        raise ValueError(f"{key} must be a text")  # noqa: TRY004
    value.encode()  # half a surrogate pair is fine for JSON, not for SQLite; UnicodeEncodeError is a ValueError
    return value


def _whole(content: dict[str, Any], key: str, least: int) -> int:
    value = _value(content, key)
    if not isinstance(value, int) or isinstance(value, bool) or value < least:
        raise ValueError(f"{key} must be a whole number from {least}")
    return value


def _number(value: object, key: str) -> float:
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not math.isfinite(value):
        raise ValueError(f"{key} must be made of finite numbers")
    return float(value)
