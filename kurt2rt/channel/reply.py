"""What a request comes to."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any


class Verdict(Enum):
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

    verdict: Verdict
    body: Mapping[str, Any] = field(default_factory=dict)


def refusal(why: str, text: str, tick: int) -> Reply:
    """Understood and not done. `why` is a word for the program at the other end, `text` a sentence for the teacher."""
    return Reply(Verdict.CONFLICT, {"t": tick, "why": why, "text": text})


def restarted(tick: int) -> Reply:
    """Refuse a request that was made for an earlier start of the robot program."""
    return refusal("boot", "the robot program was started anew; look at the robot, then say it again", tick)


def malformed(text: str) -> Reply:
    """Not understood."""
    return Reply(Verdict.MALFORMED, {"why": "malformed", "text": text})


def unsaved(text: str, tick: int) -> Reply:
    """Not durable, or not known to be."""
    return Reply(Verdict.UNSAVED, {"t": tick, "why": "unsaved", "text": text})


def done(tick: int, text: str = "", **more: Any) -> Reply:
    """Carried out, and durable where it has to be."""
    return Reply(Verdict.DONE, {"t": tick, "ok": True, "text": text, **more})
