"""A teaching event as one line of JSON, exact to the last bit of every float64."""

import json
import sys
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict, ValidationError, create_model

from kurt2rt.core.message_fields import Int, OneOf, wire_error
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


def _encodable(text: str) -> str:
    text.encode()  # half a surrogate pair is fine for JSON, not for SQLite
    return text


Id = Annotated[int, Int(1, 2**63 - 1)]
Number = Annotated[int, Int(0, 2**63 - 1)]
_Real = Annotated[float, Field(strict=True, allow_inf_nan=False)]
_Opinion = Annotated[int, OneOf((-1, 0, 1))]
StoredText = Annotated[str, Strict(), AfterValidator(_encodable)]
_Word = Annotated[str, Strict(), AfterValidator(lambda text: sys.intern(_encodable(text)))]
"""Text that many events have: interned, so that memory holds it once."""

_ORIGIN = {
    "command_id": StoredText,
    "teacher": _Word,
    "phase": Annotated[Phase, OneOf(tuple(each.value for each in Phase), Phase)],
    "tick": Number,
}
_FIELDS: dict[type, tuple[str, dict[str, Any]]] = {
    RlaCreated: (
        "created",
        {
            "rla_id": Id,
            "condition": tuple[_Real, ...],
            "action": _Word,
            "radius": _Real | None,
            "behaviour": _Word,
            "level": _Word,
        },
    ),
    ActionReplaced: ("replaced", {"rla_id": Id, "action": _Word, "instead_of": _Word}),
    ActionWithdrawn: ("withdrawn", {"rla_id": Id, "instead_of": _Word}),
    RlaDeleted: ("deleted", {"rla_id": Id}),
    RlaRewarded: (
        "rewarded",
        {
            "rla_id": Id,
            "value": Annotated[int, OneOf((1, -1))],
            "decided_at_tick": Number,
            "credits": tuple[tuple[Id, _Real], ...],
            "said": _Opinion | None,
        },
    ),
    Appraised: ("appraised", {"appraisal": _Word, "value": _Opinion, "decided_at_tick": Number}),
    SituationNamed: ("named", {"name": StoredText, "situation": tuple[_Real, ...], "level": StoredText}),
    LessonUndone: ("undone", {"lesson": StoredText}),
    LessonRedone: ("redone", {"lesson": StoredText}),
    SessionBegun: ("session begun", {"name": StoredText}),
    SessionEnded: ("session ended", {"lasted_ticks": Number}),
}
"""Name of each kind of event, and the fields that come before those of its origin."""


class _Row(BaseModel):
    model_config = ConfigDict(extra="forbid")


def _row(name: str, own: dict[str, Any]) -> type[_Row]:
    fields: dict[str, Any] = {key: (hint, ...) for key, hint in (own | _ORIGIN).items()}
    return create_model(name, __base__=_Row, **fields)


_KINDS: dict[str, tuple[type, type[_Row]]] = {name: (kind, _row(name, own)) for kind, (name, own) in _FIELDS.items()}


def encode_event(event: TeachingEvent) -> str:
    """Return the JSON text of an event.

    Raises:
        KnowledgeError: the event could not be read back: NaN, infinity, wrong types.
    """
    name, own = _FIELDS[type(event)]
    source = event.rla if isinstance(event, RlaCreated) else event
    content = {key: getattr(source, key) for key in own} | {key: getattr(event.origin, key) for key in _ORIGIN}
    for key in ("condition", "situation", "credits"):
        if key in content:
            content[key] = [[*each] if isinstance(each, Credit) else each for each in content[key]]
    content = {"version": EVENT_VERSION, "kind": name, **content}
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


def _event(content: object) -> TeachingEvent:
    if not isinstance(content, dict):
        raise ValueError(f"a JSON {type(content).__name__} is no object")  # noqa: TRY004 - all problems are of one type
    given = dict(content)
    version, name = given.pop("version", None), given.pop("kind", None)
    if version != EVENT_VERSION or isinstance(version, bool):
        raise _FieldError("version", f"its version is {version}, this kurt2rt reads version {EVENT_VERSION}")
    if not isinstance(name, str) or name not in _KINDS:
        raise _FieldError("kind", f"kind is {name!r}, known are {', '.join(_KINDS)}")
    kind, model = _KINDS[name]
    try:
        values = dict(model.model_validate(given))
    except ValidationError as error:
        key = str(error.errors(include_url=False)[0]["loc"][0])
        raise _FieldError(key, str(wire_error(name, error))) from error
    origin = Origin(*(values.pop(key) for key in _ORIGIN))
    if "credits" in values:
        values["credits"] = tuple(Credit(*each) for each in values["credits"])
    if kind is RlaCreated:
        return RlaCreated(Rla(origin=origin, **values))
    event: TeachingEvent = kind(origin=origin, **values)
    return event
