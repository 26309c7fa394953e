"""Listing of the refusals of requests that break the wire contract."""

import math
from collections.abc import Iterator

import cbor2
import pytest

from kurt2rt.channel.protocol.codec import decode_request
from kurt2rt.core.message_fields import WireError

_BOOT, _ID = b"boot", b"12345678"
_BODIES: tuple[tuple[str, list[object]], ...] = (
    ("/stop", [b"short", None]),
    ("/stop", [_ID]),
    ("/lessons", [True]),
    ("/lessons", [21]),
    ("/watch", [_BOOT, -1]),
    ("/correct", [_BOOT, _ID, 0, "turn_left", None, "basic", 1]),
    ("/correct", [_BOOT, _ID, 0, "turn_left", None, "mid", False, 0]),
    ("/shown", [_BOOT, _ID, 0, 7, [0] * 13]),
    ("/shown", [_BOOT, _ID, 0, 7, [-1]]),
    ("/hold", [_BOOT, 0, 0, ""]),
    ("/hold", [_BOOT, 0, 0]),
    ("/drive", [_BOOT, 0, 0, math.nan, 0.0]),
    ("/drive", [_BOOT, 0, 0, 0.0, 2.01]),
    ("/world/move", [_BOOT, _ID, 0, "north", 100.5, 0.0]),
    ("/world/move", [_BOOT, _ID, 0, "north", 0.0, -math.inf]),
    ("/reward", [_BOOT, _ID, 0, 0, None]),
    ("/appraise", [_BOOT, _ID, 0, "", None]),
    ("/seek", [_BOOT, _ID, 0, None]),
    ("/seek", [_BOOT, _ID, 0, ""]),
    ("/seek", [_BOOT, _ID, 0, -12]),
    ("/seek", [_BOOT, _ID, 0, [[["x", 1]] * 17, 0.1]]),
    ("/seek", [_BOOT, _ID, 0, [["x"], 0.1]]),
    ("/seek", [_BOOT, _ID, 0, [[["x", math.nan]], 0.1]]),
    ("/phase", [_BOOT, _ID, 0, 6]),
    ("/answer", [_BOOT, _ID, 0, "turn_left", None, "high", False]),
    ("/answer", [_BOOT, _ID, 0, "turn_left", None, "mid", 1]),
    ("/answer", [_BOOT, _ID, 0, "turn_left"]),
    *(("/answer", [_BOOT, _ID, 0, action, None, "basic", False]) for action in ("", "a\nb", "x" * 65)),
    ("/behaviour", [_BOOT, _ID, 0, "forward", 0]),
)
_PAYLOADS = (
    ("/stop", cbor2.dumps({"id": _ID})),
    ("/stop", cbor2.dumps([_ID, None]) + b"\x00"),
    ("/stop", b"\x81" * 2000),
    ("/lessons", b"\x81\xc2\x41\x01"),
    ("/fly", b"\x80"),
)


def refusals() -> Iterator[tuple[str, str]]:
    """Yield the refusal of each kind of a malformed request."""
    for path, body in _BODIES:
        yield f"{path} {body}", _refusal(path, cbor2.dumps(body))
    for path, payload in _PAYLOADS:
        yield f"{path} {payload[:12]!r} of {len(payload)} bytes", _refusal(path, payload)


def _refusal(path: str, payload: bytes) -> str:
    with pytest.raises(WireError) as refused:
        decode_request(path, payload)
    return str(refused.value)
