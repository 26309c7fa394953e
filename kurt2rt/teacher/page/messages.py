"""What a page says, checked before anything acts on it."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from kurt2rt.channel.protocol.requests import FASTEST, SHA256_BYTES, UPLOAD_ID_BYTES
from kurt2rt.channel.protocol.schema import Bytes, Check, Flag, Float, Int, OneOf, OneWord, OrNone, Text, WireError
from kurt2rt.core.rla.rla import BASIC, MID, Phase

LONGEST_MESSAGE = 1024
"""In characters."""

_COUNTER = Int(1, 2**53)
_PICTURE = OrNone(_COUNTER)
_SPEED_M_S = Float(2.0, "m/s")
_PLACE_M = Float(100.0, "m")
_NAME = Text(64, least=1)
_LEVEL = OneWord((BASIC, MID))


def _hexadecimal(length: int) -> Check:
    def check(what: str, value: object) -> bytes:
        try:
            return Bytes(length)(what, bytes.fromhex(value) if isinstance(value, str) else None)
        except ValueError as error:
            raise WireError(f"{what} has to be {2 * length} hexadecimal digits") from error

    return check


@dataclass(frozen=True, slots=True)
class PageHeartbeat:
    """The page is open, visible and alive; ten times a second."""

    picture: int | None
    """Number of the picture on its screen; None before the first."""
    at_ms: float
    """The page's own clock, sent back to it for the round trip."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """Nobody sees the page any more."""


@dataclass(frozen=True, slots=True)
class Press:
    """Hold-to-drive is held; twenty times a second."""

    hold: int
    """Number of the press; grows."""
    left_m_s: float
    right_m_s: float
    picture: int | None


@dataclass(frozen=True, slots=True)
class Release:
    """Hold-to-drive was let go."""


@dataclass(frozen=True, slots=True)
class StopNow:
    """Stop, from any page."""

    number: int
    """The page's own, repeated in the answer."""


@dataclass(frozen=True, slots=True)
class Why:
    """What does the newest decision rest on? From any page."""

    number: int
    """As of a stop."""


@dataclass(frozen=True, slots=True)
class PageOrder:
    """A command that is answered."""

    number: int
    name: str
    """A key of ORDERS."""
    arguments: Mapping[str, Any]
    picture: int | None
    """What the page showed when it was given."""


PageMessage = PageHeartbeat | Hidden | Press | Release | StopNow | Why | PageOrder

ORDERS: Mapping[str, Mapping[str, Check]] = {
    "answer": {"action": _NAME, "level": _LEVEL, "beside": Flag()},
    "correct": {"action": _NAME, "level": _LEVEL},
    "reward": {"value": OneOf((1, -1))},
    "appraise": {"appraisal": _NAME},
    # By name: "the last one" would mean another lesson by the time it arrives.
    "undo": {"lesson": Text(128, least=1)},
    "phase": {"phase": OneOf(tuple(each.value for each in Phase), Phase)},
    "pursue": {"behaviour": _NAME},
    "name": {"name": _NAME},
    "seek": {"name": _NAME},
    "stop_seeking": {},
    "be_at": {"name": _NAME},
    "begin_session": {"name": _NAME},
    "end_session": {},
    "resume": {},
    "take": {},
    "hand_over": {"to": OrNone(_NAME)},
    "save": {"label": Text(64)},
    "export": {},
    "examine": {},
    "move": {"name": _NAME, "dx_m": _PLACE_M, "dy_m": _PLACE_M},
    "put_back": {},
    "speed": {"times": Int(1, FASTEST)},
    "load": {"upload": _hexadecimal(UPLOAD_ID_BYTES), "sha256": _hexadecimal(SHA256_BYTES)},
    "next_run": {"world": OrNone(_NAME), "task": OrNone(_NAME), "fresh": Flag()},
    "place": {"x_m": _PLACE_M, "y_m": _PLACE_M, "heading_rad": Float(7.0, "rad")},
}
"""Orders by name, and the arguments of each."""

_FIELDS: Mapping[str, Mapping[str, Check]] = {
    "beat": {"picture": _PICTURE, "at_ms": Float(1e15, "ms")},
    "hidden": {},
    "press": {"hold": _COUNTER, "left_m_s": _SPEED_M_S, "right_m_s": _SPEED_M_S, "picture": _PICTURE},
    "release": {},
    "stop": {"number": _COUNTER},
    "why": {"number": _COUNTER},
    "order": {"number": _COUNTER, "name": _NAME, "arguments": lambda _, value: value, "picture": _PICTURE},
}


def parse(text: str) -> PageMessage:
    """One message of a page. Raises WireError."""
    if len(text) > LONGEST_MESSAGE:
        raise WireError(f"{len(text)} characters are too many; {LONGEST_MESSAGE} are taken")
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise WireError("this is not JSON") from error
    if not isinstance(content, dict):
        raise WireError("a message has to be an object")
    kind = content.pop("kind", None)
    if not isinstance(kind, str) or kind not in _FIELDS:
        raise WireError(f"kind has to be one of {', '.join(_FIELDS)}")
    fields = _checked(kind, _FIELDS[kind], content)
    match kind:
        case "beat":
            return PageHeartbeat(**fields)
        case "hidden":
            return Hidden()
        case "press":
            return Press(**fields)
        case "release":
            return Release()
        case "stop":
            return StopNow(**fields)
        case "why":
            return Why(**fields)
    name = fields["name"]
    if name not in ORDERS:
        raise WireError(f"an order has to be one of {', '.join(ORDERS)}")
    fields["arguments"] = _checked(name, ORDERS[name], fields["arguments"])
    return PageOrder(**fields)


def _checked(what: str, checks: Mapping[str, Check], content: object) -> dict[str, Any]:
    if not isinstance(content, dict) or content.keys() != checks.keys():
        raise WireError(f"{what} has the fields {', '.join(checks) or '(none)'}")
    return {name: check(name, content[name]) for name, check in checks.items()}
