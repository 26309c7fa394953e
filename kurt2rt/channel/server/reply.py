"""Replies of the robot to requests."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.outcome_text import text_of


class ReplyStatus(Enum):
    """Result of a request as its sender has to treat it; each member is one CoAP code."""

    DONE = "done"
    MALFORMED = "malformed"
    NOT_HERE = "not here"
    CONFLICT = "conflict"
    """Understood, but refused: `why`, `code` and `text` of the body tell the reason."""
    UNSAVED = "unsaved"
    """It cannot be made durable now."""


@dataclass(frozen=True, slots=True)
class Reply:
    """Status and body of an answer to a device, before it is encoded as CBOR."""

    status: ReplyStatus
    body: Mapping[str, Any] = field(default_factory=dict)


def refusal(why: str, outcome: Outcome, tick: int) -> Reply:
    """Return the reply to a request that is understood and refused.

    `why`: word of the wire contract, such as stale. `outcome`: code and fields for the teacher. `tick`: newest tick.
    """
    return Reply(ReplyStatus.CONFLICT, {"t": tick, "why": why, **plain_outcome(outcome)})


def restarted(tick: int) -> Reply:
    """Return the refusal of a request for an earlier start of the robot program; `tick` is the newest tick."""
    return refusal("boot", Outcome(RefusalCode.RESTARTED), tick)


def malformed(text: str) -> Reply:
    """Return the reply to a request that breaks the wire contract; `text` tells how."""
    return Reply(ReplyStatus.MALFORMED, {"why": "malformed", "text": text})


def not_simulated() -> Reply:
    """Return the refusal of a request that only a simulated robot carries out."""
    return Reply(ReplyStatus.NOT_HERE, {"why": "refused", **plain_outcome(Outcome(RefusalCode.NOT_SIMULATED))})


def unsaved(outcome: Outcome, tick: int) -> Reply:
    """Return the reply to a lesson or a copy that is not durable, or not known to be.

    `outcome`: code and fields for the teacher. `tick`: newest tick.
    """
    return Reply(ReplyStatus.UNSAVED, {"t": tick, "why": "unsaved", **plain_outcome(outcome)})


def done(tick: int, outcome: Outcome | None = None, *, lesson: object = None, **more: Any) -> Reply:
    """Return the reply to a request that was carried out, and is durable if it has to be.

    Args:
        tick: newest tick.
        outcome: code and fields for the teacher. None: no text.
        lesson: id that undoes what the request taught. None: it taught nothing, and the key is left out.
        more: further keys of the answer.
    """
    shown = {"text": ""} if outcome is None else plain_outcome(outcome)
    taught = {} if lesson is None else {"lesson": lesson}
    return Reply(ReplyStatus.DONE, {"t": tick, "ok": True, **shown, **taught, **more})


def plain_outcome(outcome: Outcome) -> dict[str, Any]:
    """Return an outcome as keys of a reply: code, fields, and a sentence."""
    fields = {key: list(each) if isinstance(each, tuple) else each for key, each in outcome.fields.items()}
    return {"text": text_of(outcome), "code": outcome.code.value, "fields": fields}
