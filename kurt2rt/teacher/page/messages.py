"""Messages of a page, parsed and checked."""

import json
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Annotated, Any, get_args

from kurt2rt.channel.protocol.codec import PATHS
from kurt2rt.channel.protocol.requests import CommandRequest
from kurt2rt.core.message_fields import Bytes, Check, Float, Int, Name, WireError, checks_of
from kurt2rt.core.teaching.commands import Single
from kurt2rt.core.teaching.message_fields import Speed

LONGEST_MESSAGE = 1024
"""Length limit, in characters."""

Counter = Annotated[int, Int(1, 2**53)]
Picture = Counter | None
"""Number of the state on the page's screen; None before the first."""


@dataclass(frozen=True, slots=True)
class PageHeartbeat:
    """Message of a visible page, ten times a second, with the number of the state on its screen."""

    picture: Picture
    at_ms: Annotated[float, Float(1e15, "ms")]
    """The page's own clock, sent back to it for the round trip."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """Message of a page that is not visible any more, such as in a tab in the background."""


@dataclass(frozen=True, slots=True)
class Press:
    """Message of a page whose deadman switch is held, 20 times a second, with the wanted speeds."""

    press_id: Counter
    """Number of the press; grows."""
    left_m_s: Speed
    right_m_s: Speed
    picture: Picture


@dataclass(frozen=True, slots=True)
class HoldPress:
    """Message of a page whose button of an action is held (hold to correct), 20 times a second."""

    press_id: Counter
    """Number of the press, in one sequence with those of `Press`."""
    action: Name
    picture: Picture


@dataclass(frozen=True, slots=True)
class Release:
    """Message of a page at which the deadman switch, or the button of an action, was let go."""


@dataclass(frozen=True, slots=True)
class StopNow:
    """Message of a page whose STOP was pressed; a page without control may send it, too."""

    number: Counter
    """The page's own number of this message, repeated in the answer."""


@dataclass(frozen=True, slots=True)
class Why:
    """Message of a page that asks why the robot decided as it did last; any page may ask."""

    number: Counter
    """The page's own number of this message, repeated in the answer."""


@dataclass(frozen=True, slots=True)
class PageCommand:
    """Message of a page with a command for the robot, which needs control."""

    number: Counter
    """The page's own number of this message, repeated in the answer."""
    kind: type[Single | CommandRequest]
    fields: Mapping[str, Any]
    """Checked fields that the page gave; the others have their defaults."""
    picture: Picture


PageMessage = PageHeartbeat | Hidden | Press | HoldPress | Release | StopNow | Why | PageCommand

_TYPES: Mapping[str, type[PageHeartbeat | Hidden | Press | HoldPress | Release | StopNow | Why | PageCommand]] = {
    "beat": PageHeartbeat,
    "hidden": Hidden,
    "press": Press,
    "hold": HoldPress,
    "release": Release,
    "stop": StopNow,
    "why": Why,
    "command": PageCommand,
}

COMMANDS: Mapping[str, type[Single | CommandRequest]] = {
    path: kind for path, kind in PATHS.items() if issubclass(kind, (*get_args(Single), CommandRequest))
}
"""Class of each command that a page may send, by its path on the wire."""


def parse(text: str) -> PageMessage:
    """Parse one JSON message of a page. Raises WireError for anything but a known message with valid fields."""
    if len(text) > LONGEST_MESSAGE:
        raise WireError(f"message: too long (got {len(text)} characters, at most {LONGEST_MESSAGE})")
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise WireError("message: not JSON") from error
    if not isinstance(content, dict):
        raise WireError("message: has to be an object")
    kind = content.pop("kind", None)
    if not isinstance(kind, str) or kind not in _TYPES:
        raise WireError(f"kind has to be one of {', '.join(_TYPES)}")
    own: dict[str, Any] = {}
    if kind == "command":
        path = content.pop("path", None)
        if not isinstance(path, str) or path not in COMMANDS:
            raise WireError(f"path of a command has to be one of {', '.join(COMMANDS)}")
        own = {"kind": COMMANDS[path], "fields": _command_fields(COMMANDS[path], content.pop("fields", None))}
    checks = checks_of(_TYPES[kind])
    if content.keys() != checks.keys():
        raise WireError(f"{kind} has the fields {', '.join(checks) or '(none)'}")
    return _TYPES[kind](**{name: check(name, content[name]) for name, check in checks.items()}, **own)


def _command_fields(kind: type[Single | CommandRequest], content: object) -> dict[str, Any]:
    """Check the fields that a page gave a command; bytes are hexadecimal. Raises WireError."""
    own = checks_of(CommandRequest)
    checks = {name: check for name, check in checks_of(kind).items() if name not in own}
    needed = {each.name for each in fields(kind) if each.name in checks and each.default is MISSING}
    if not isinstance(content, dict) or not needed <= content.keys() <= checks.keys():
        raise WireError(f"{kind.path} has the fields {', '.join(checks) or '(none)'}")
    return {name: checks[name](name, _bytes_in(checks[name], value)) for name, value in content.items()}


def _bytes_in(check: Check, value: object) -> object:
    if not isinstance(value, str) or not any(isinstance(each, Bytes) for each in get_args(check.hint)):
        return value
    try:
        return bytes.fromhex(value)
    except ValueError:
        return None
