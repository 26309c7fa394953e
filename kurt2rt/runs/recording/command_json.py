"""Inbox messages of a tick as JSON: a name for the class, and the fields."""

import math
from typing import Any, get_args

from pydantic import TypeAdapter, ValidationError

from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.teaching.system_events import Input, SystemEvent
from kurt2rt.runs.recording.recording_error import RecordingError

_ADAPTERS: dict[str, TypeAdapter[Any]] = {
    kind.__name__: TypeAdapter(kind) for kind in (*get_args(Command), *get_args(SystemEvent))
}


def encode_command(command: Input) -> dict[str, Any]:
    """Return a JSON object: the name of the class as `is`, then the fields."""
    name = type(command).__name__
    return {"is": name, **_finite(_ADAPTERS[name].dump_python(command, mode="json"))}


def decode_command(content: object) -> Input:
    """Return the command that `encode_command` wrote, equal to the last bit. Raises RecordingError."""
    if not isinstance(content, dict):
        raise RecordingError(f"a {type(content).__name__} is no command")
    fields = dict(content)
    name = fields.pop("is", None)
    adapter = _ADAPTERS.get(name) if isinstance(name, str) else None
    if adapter is None:
        raise RecordingError(f"there is no command {name!r}")
    try:
        command: Input = adapter.validate_python(fields, strict=False)
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        place = ".".join(map(str, problem["loc"]))
        raise RecordingError(f"{place}: {problem['msg']}", where=name) from error
    return command


def _finite(value: Any) -> Any:
    """JSON knows no infinity: it is a text there."""
    match value:
        case float():
            return value if math.isfinite(value) else repr(value)
        case dict():
            return {key: _finite(each) for key, each in value.items()}
        case list():
            return [_finite(each) for each in value]
    return value
