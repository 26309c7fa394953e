"""Messages of a page, parsed and checked."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from kurt2rt.core.teaching.message_fields import Check, Float, Int, OrNone, Text, WireError
from kurt2rt.teacher.page.commands import COMMANDS, PageCommand

LONGEST_MESSAGE = 1024
"""Length limit, in characters."""

_COUNTER = Int(1, 2**53)
_PICTURE = OrNone(_COUNTER)
_SPEED_M_S = Float(2.0, "m/s")


@dataclass(frozen=True, slots=True)
class PageHeartbeat:
    """Sign of a visible page, ten times a second."""

    picture: int | None
    """Number of the state on its screen; None before the first."""
    at_ms: float
    """The page's own clock, sent back to it for the round trip."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """The page is not visible any more."""


@dataclass(frozen=True, slots=True)
class Press:
    """The deadman switch is held; 20 times a second."""

    press_id: int
    """Number of the press; grows."""
    left_m_s: float
    right_m_s: float
    picture: int | None


@dataclass(frozen=True, slots=True)
class HoldPress:
    """A button of an action is held (hold to correct); 20 times a second."""

    press_id: int
    """Number of the press, in one sequence with those of `Press`."""
    action: str
    picture: int | None


@dataclass(frozen=True, slots=True)
class Release:
    """The deadman switch, or the button of an action, was let go."""


@dataclass(frozen=True, slots=True)
class StopNow:
    """STOP of a page, also of one without control."""

    number: int
    """The page's own number of this message, repeated in the answer."""


@dataclass(frozen=True, slots=True)
class Why:
    """Question for the facts of the newest decision, from any page."""

    number: int
    """The page's own number of this message, repeated in the answer."""


PageMessage = PageHeartbeat | Hidden | Press | HoldPress | Release | StopNow | Why | PageCommand

_FIELDS: Mapping[str, Mapping[str, Check]] = {
    "beat": {"picture": _PICTURE, "at_ms": Float(1e15, "ms")},
    "hidden": {},
    "press": {"hold": _COUNTER, "left_m_s": _SPEED_M_S, "right_m_s": _SPEED_M_S, "picture": _PICTURE},
    "hold": {"hold": _COUNTER, "action": Text(64, least=1), "picture": _PICTURE},
    "release": {},
    "stop": {"number": _COUNTER},
    "why": {"number": _COUNTER},
    "order": {"number": _COUNTER, "name": Text(64, least=1), "arguments": lambda _, value: value, "picture": _PICTURE},
}
_TYPES: Mapping[str, type[PageHeartbeat | Hidden | Release | StopNow | Why]] = {
    "beat": PageHeartbeat,
    "hidden": Hidden,
    "release": Release,
    "stop": StopNow,
    "why": Why,
}


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
    if not isinstance(kind, str) or kind not in _FIELDS:
        raise WireError(f"kind has to be one of {', '.join(_FIELDS)}")
    fields = _checked(kind, _FIELDS[kind], content)
    if kind == "press":
        return Press(fields["hold"], fields["left_m_s"], fields["right_m_s"], fields["picture"])
    if kind == "hold":
        return HoldPress(fields["hold"], fields["action"], fields["picture"])
    if kind != "order":
        return _TYPES[kind](**fields)
    name = fields["name"]
    if name not in COMMANDS:
        raise WireError(f"name of a command has to be one of {', '.join(COMMANDS)}")
    fields["arguments"] = _checked(name, COMMANDS[name].fields, fields["arguments"])
    return PageCommand(**fields)


def _checked(what: str, checks: Mapping[str, Check], content: object) -> dict[str, Any]:
    if not isinstance(content, dict) or content.keys() != checks.keys():
        raise WireError(f"{what} has the fields {', '.join(checks) or '(none)'}")
    return {name: check(name, content[name]) for name, check in checks.items()}
