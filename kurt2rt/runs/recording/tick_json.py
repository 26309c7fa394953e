"""JSON codec of tick entries, exact to the last bit of every float64."""

import json
import math
from collections.abc import Callable
from dataclasses import MISSING, fields
from enum import Enum
from functools import cache
from typing import Any, get_args, get_origin, get_type_hints

from pydantic import BaseModel, ValidationError, create_model

from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.teaching.inbox import Input, SystemEvent
from kurt2rt.knowledge.journal.event_codec import decode_event, encode_event
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError

_INPUTS: dict[str, type[Input]] = {kind.__name__: kind for kind in (*get_args(Command), *get_args(SystemEvent))}
_KEYS = {"wheel_speeds": "wheels"}
"""Keys of fields that are named otherwise in JSON."""
_JSON = json.JSONEncoder(allow_nan=False, check_circular=False, separators=(",", ":"))


def encode_tick(entry: TickEntry) -> bytes:
    """Return the entry as UTF-8 JSON without absent fields; infinity and NaN become texts.

    Raises RecordingError for an event that cannot be written.
    """
    try:
        content = _plain(entry)
        for name in ("commands", "results", "events", "saved"):
            if not content[name]:
                del content[name]
        if entry.commands:
            content["commands"] = [encode_command(each) for each in entry.commands]
        if entry.events:
            content["events"] = [json.loads(encode_event(each)) for each in entry.events]
        if entry.readings.time_s == entry.now_s:
            del content["readings"]["time_s"]
        if entry.decision.asks_at == BASIC:
            del content["decision"]["asks_at"]
        try:
            return _JSON.encode(content).encode()
        except ValueError:
            return _JSON.encode(_finite(content)).encode()
    except (KnowledgeError, ValueError, TypeError) as error:
        raise RecordingError(f"tick {entry.tick} cannot be written: {error}") from error


def decode_tick(data: bytes) -> TickEntry:
    """Return the entry of `encode_tick`, equal to the last bit. Raises RecordingError."""
    try:
        content = json.loads(data)
        content.setdefault("saved", False)
        content["readings"].setdefault("time_s", content["now_s"])
        content["decision"].setdefault("asks_at", BASIC)
        place, events = f"tick {content['tick']}", content.pop("events", ())
        entry: TickEntry = _decoder(TickEntry)(content)
        return entry._replace(events=tuple(decode_event(json.dumps(each), place) for each in events))
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError, KnowledgeError) as error:
        raise RecordingError(f"not a tick of a run: {type(error).__name__}: {error}") from error


def _plain(value: Any) -> Any:
    """Return a named tuple as an object of JSON without absent fields, and any other value as it is."""
    if not isinstance(value, tuple):
        return value
    if not hasattr(value, "_fields"):
        return [_plain(each) for each in value] if value and isinstance(value[0], tuple) else value
    named = zip(_keys_of(type(value)), value, strict=True)
    return {key: _plain(each) for key, each in named if each is not None}


@cache
def _keys_of(kind: Any) -> tuple[str, ...]:
    return tuple(_KEYS.get(name, name) for name in kind._fields)


def tick_properties() -> dict[str, Any]:
    """Return the JSON schema of each field of `encode_tick`."""
    properties: dict[str, Any] = _schema_of(TickEntry)["properties"]
    return properties


def _schema_of(hint: Any) -> dict[str, Any]:
    kinds = [each for each in get_args(hint) if each is not type(None)]
    if get_origin(hint) is tuple:
        return {"type": "array", "items": _schema_of(kinds[0])}
    if len(kinds) == 1:  # or None
        return _schema_of(kinds[0])
    if hasattr(hint, "_fields"):
        fields = get_type_hints(hint).items()
        return {"type": "object", "properties": {_KEYS.get(name, name): _schema_of(each) for name, each in fields}}
    plain = {bool: "boolean", int: "integer", float: "number"}
    is_text = isinstance(hint, type) and issubclass(hint, str | Enum)
    return {"type": plain.get(hint, "string" if is_text else "object")}


@cache
def _decoder(hint: Any) -> Callable[[Any], Any]:
    """Return the function that makes a value of this type of JSON. It raises KeyError for an absent field."""
    kinds = [each for each in get_args(hint) if each is not type(None)]
    if get_origin(hint) is tuple:
        item = _decoder(kinds[0])
        return lambda content: tuple(map(item, content))
    if hint == Input:
        return decode_command
    if kinds:  # or None
        only = _decoder(kinds[0])
        return lambda content: None if content is None else only(content)
    if hasattr(hint, "_fields"):
        return _named_tuple_decoder(hint)
    return hint if hint is float or (isinstance(hint, type) and issubclass(hint, Enum)) else lambda content: content


def _named_tuple_decoder(kind: Any) -> Callable[[Any], Any]:
    """Return the decoder of a named tuple.

    Absent fields may be those that may be None, those with a default, and other tuples, which are empty.
    """
    hints = {_KEYS.get(name, name): hint for name, hint in get_type_hints(kind).items()}
    decoders = {key: _decoder(hint) for key, hint in hints.items()}
    absent: dict[str, Any] = {key: () for key, hint in hints.items() if get_origin(hint) is tuple}
    absent |= kind._field_defaults
    absent |= {key: None for key, hint in hints.items() if type(None) in get_args(hint)}

    def decode(content: dict[str, Any]) -> Any:
        fields = decoders.items()
        return kind(*(decoder(content[key]) if key in content else absent[key] for key, decoder in fields))

    return decode


@cache
def _fields_of(name: str) -> type[BaseModel]:
    """Return a command's fields without the ranges of the wire, which other senders may exceed."""
    kind: Any = _INPUTS[name]
    hints = get_type_hints(kind)
    own: dict[str, Any] = {
        each.name: (hints[each.name], ... if each.default is MISSING else each.default) for each in fields(kind)
    }
    return create_model(name, **own)


def encode_command(command: Input) -> dict[str, Any]:
    """Return a command as a JSON object for `decode_command`.

    It has the name of the class as `is`, then the fields.
    """
    name = type(command).__name__
    own = {each.name: getattr(command, each.name) for each in fields(command)}
    return {"is": name, **_finite(_fields_of(name).model_construct(**own).model_dump(mode="json"))}


def decode_command(content: object) -> Input:
    """Return the command that `encode_command` wrote, equal to the last bit. Raises RecordingError."""
    if not isinstance(content, dict):
        raise RecordingError(f"a {type(content).__name__} is no command")
    own = dict(content)
    name = own.pop("is", None)
    if not isinstance(name, str) or name not in _INPUTS:
        raise RecordingError(f"there is no command {name!r}")
    try:
        return _INPUTS[name](**dict(_fields_of(name).model_validate(own)))
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        place = ".".join(map(str, problem["loc"]))
        raise RecordingError(f"{place}: {problem['msg']}", where=name) from error


def _finite(value: Any) -> Any:
    """JSON knows no infinity: it is a text there."""
    match value:
        case float():
            return value if math.isfinite(value) else repr(value)
        case dict():
            return {key: _finite(each) for key, each in value.items()}
        case list() | tuple():
            return [_finite(each) for each in value]
    return value
