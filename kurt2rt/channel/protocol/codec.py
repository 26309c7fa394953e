"""Codec of the teacher's channel: requests, answers and the state as CBOR (docs/the-wire.md)."""

from collections.abc import Mapping
from typing import Any, get_args

from hal import points
from kurt2rt.channel.protocol.requests import (
    REQUESTS,
    Request,
    StreamRequest,
    TickRequest,
    stream_request,
    tick_request,
)
from kurt2rt.channel.protocol.schema import Codec, decode_strictly, encode_plainly
from kurt2rt.channel.protocol.state import STATE, State
from kurt2rt.core.message_fields import Check, WireError, checks_of
from kurt2rt.core.teaching.commands import Single, Stop, Stream
from kurt2rt.core.teaching.message_fields import plain
from kurt2rt.runs.explain.facts import DecisionFacts

CONTENT_FORMAT = 60
"""CoAP's content format of application/cbor."""

MOST_REQUEST_BYTES = 1024
MOST_ANSWER_BYTES = 65_507
"""Largest UDP datagram, for worlds with many walls."""

_REQUEST_DEPTH = 4
_STATE_DEPTH = 3
_ANSWER_DEPTH = 8

_COMMANDS = (*get_args(Stream), *(each for each in get_args(Single) if each is not Stop))

PATHS: Mapping[str, Any] = {kind.path: kind for kind in (*REQUESTS, *_COMMANDS)}
"""Class of the request or of the command of each path; /state is not among them."""

_HEADS: Mapping[Any, type[StreamRequest | TickRequest]] = {
    kind: StreamRequest if kind in get_args(Stream) else TickRequest for kind in _COMMANDS
}
"""Class of the request that carries a command; its fields come first in the body."""

BODIES: Mapping[str, Mapping[str, Check]] = {
    path: (checks_of(_HEADS[kind]) if kind in _HEADS else {}) | checks_of(kind) for path, kind in PATHS.items()
}
"""Name and check of each place in the body of a path, in order."""


def path_of(request: Request) -> str:
    """Return the path that takes a request."""
    return request.command.path if isinstance(request, TickRequest | StreamRequest) else request.path


def encode_request(request: Request) -> bytes:
    """Return the body of a request. Raises WireError if the robot would refuse it."""
    own = request.command if isinstance(request, TickRequest | StreamRequest) else request
    values = (
        (name, check, getattr(request if hasattr(request, name) else own, name))
        for name, check in BODIES[path_of(request)].items()
    )
    body = [plain(check(name, value)) for name, check, value in values]
    return encode_plainly(body)


def decode_request(path: str, payload: bytes) -> Request:
    """Return the request in a body; `path` is a key of PATHS. Raises WireError."""
    if path not in PATHS:
        raise WireError(f"there is no {path} here")
    points.fail("a request is malformed", WireError, "it came in parts")
    body = decode_strictly(payload, most_bytes=MOST_REQUEST_BYTES, most_depth=_REQUEST_DEPTH)
    checks = BODIES[path]
    if not isinstance(body, list) or len(body) != len(checks):
        raise WireError(f"{path} takes a list of {len(checks)}: [{', '.join(checks)}]")
    return build_request(
        path, {name: check(name, each) for (name, check), each in zip(checks.items(), body, strict=True)}
    )


def build_request(path: str, values: Mapping[str, Any]) -> Request:
    """Return the request to a path with these values by the names of `BODIES`.

    A command has no teacher yet; the id of one that counts once lacks the teacher's name.
    """
    kind = PATHS[path]
    if kind not in _HEADS:
        request: Request = kind(**values)
        return request
    return (stream_request if _HEADS[kind] is StreamRequest else tick_request)(kind, **values)


def encode_answer(answer: Mapping[str, Any]) -> bytes:
    """Return an answer, a map with text keys, as CBOR."""
    return encode_plainly(dict(answer))


def decode_answer(payload: bytes) -> dict[str, Any]:
    """Return the map of an answer. Raises WireError if the payload is no CBOR map with text keys."""
    # Integer keys are allowed: an answer comes from the robot, and phases have numbers.
    answer = decode_strictly(payload, most_bytes=MOST_ANSWER_BYTES, most_depth=_ANSWER_DEPTH, text_keys=False)
    if not isinstance(answer, dict) or not all(isinstance(key, str) for key in answer):
        raise WireError("an answer has to be a map with text keys")
    return answer


def encode_state(state: State) -> bytes:
    """Return the body of /state. Texts that a device would refuse are cut and made printable."""
    return encode_plainly(STATE.plain_of(state))


def decode_state(payload: bytes) -> State:
    """Return the state in a body, without other keys. Raises WireError."""
    state = STATE.read(decode_strictly(payload, most_bytes=MOST_ANSWER_BYTES, most_depth=_STATE_DEPTH))
    shown = state.shown
    if shown is not None and not len(shown.actions) == len(shown.from_ticks) == len(shown.ticks):
        raise WireError("shown drive: has to have as many actions as ticks")
    return state


FACTS = Codec[DecisionFacts]("what the robot knows of its decision", DecisionFacts)
