"""Inbox messages of a tick as JSON: a name for the class, and the fields."""

import math
from typing import Any, get_args

from pydantic import TypeAdapter, ValidationError

from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.teaching.system_events import Input, PairingRenewed, RobotRepositioned, SystemEvent
from kurt2rt.runs.recording.recording_error import RecordingError

_NAMES: dict[type[Any], str] = {
    **{kind: kind.__name__ for kind in (*get_args(Command), *get_args(SystemEvent))},
    # Recordings keep the names that these classes had first.
    PairingRenewed: "PressesForgotten",
    RobotRepositioned: "SetDown",
}
_FIELD_NAMES = {"press_id": "hold", "alternative": "beside", "late": "put_back"}
"""Names of fields in recordings, if they differ from the command's."""
_RECORDED = {name: field for field, name in _FIELD_NAMES.items()}
_ADAPTERS: dict[str, TypeAdapter[Any]] = {name: TypeAdapter(kind) for kind, name in _NAMES.items()}


def encode_command(command: Input) -> dict[str, Any]:
    """Return a JSON object: the name of the class as `is`, then the fields."""
    name = _NAMES[type(command)]
    fields: dict[str, Any] = _finite(_ADAPTERS[name].dump_python(command, mode="json"))
    return {"is": name, **{_FIELD_NAMES.get(field, field): value for field, value in fields.items()}}


def decode_command(content: object) -> Input:
    """Return the command that `encode_command` wrote, equal to the last bit. Raises RecordingError."""
    if not isinstance(content, dict):
        raise RecordingError(f"a {type(content).__name__} is no command")
    fields = {_RECORDED.get(name, name): value for name, value in content.items()}
    name = fields.pop("is", None)
    adapter = _ADAPTERS.get(name) if isinstance(name, str) else None
    if adapter is None:
        raise RecordingError(f"there is no command {name!r}", do="a newer kurt2rt may know it")
    try:
        command: Input = adapter.validate_python(fields, strict=False)
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        place = ".".join(_FIELD_NAMES.get(str(each), str(each)) for each in problem["loc"])
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
