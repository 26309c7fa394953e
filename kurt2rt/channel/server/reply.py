"""What a request comes to."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.outcome_text import text_of


class ReplyStatus(Enum):
    """How a request ended; each is one CoAP code."""

    DONE = "done"
    MALFORMED = "malformed"
    NOT_HERE = "not here"
    CONFLICT = "conflict"
    """Understood, and not done: `why` and `text` say the reason."""
    UNSAVED = "unsaved"
    """Cannot be made durable just now."""


@dataclass(frozen=True, slots=True)
class Reply:
    """The answer to a request."""

    verdict: ReplyStatus
    body: Mapping[str, Any] = field(default_factory=dict)


def refusal(why: str, outcome: Outcome, tick: int) -> Reply:
    """Return the reply to a request that is understood and not done; `why` is a kind of the wire contract."""
    return Reply(ReplyStatus.CONFLICT, {"t": tick, "why": why, **plain_outcome(outcome)})


def restarted(tick: int) -> Reply:
    """Refuse a request that was made for an earlier start of the robot program."""
    return refusal("boot", Outcome(RefusalCode.RESTARTED), tick)


def malformed(text: str) -> Reply:
    """Not understood."""
    return Reply(ReplyStatus.MALFORMED, {"why": "malformed", "text": text})


def unsaved(outcome: Outcome, tick: int) -> Reply:
    """Return the reply to a lesson or a copy that is not durable, or not known to be."""
    return Reply(ReplyStatus.UNSAVED, {"t": tick, "why": "unsaved", **plain_outcome(outcome)})


def done(tick: int, outcome: Outcome | None = None, **more: Any) -> Reply:
    """Return the reply to a request that was carried out, and is durable if it has to be."""
    told = {"text": ""} if outcome is None else plain_outcome(outcome)
    return Reply(ReplyStatus.DONE, {"t": tick, "ok": True, **told, **more})


def plain_outcome(outcome: Outcome) -> dict[str, Any]:
    """Return an outcome as the keys of a reply: a sentence for devices that know no codes, code and fields."""
    fields = {key: list(each) if isinstance(each, tuple) else each for key, each in outcome.fields.items()}
    return {"text": text_of(outcome), "code": outcome.code.value, "fields": fields}
