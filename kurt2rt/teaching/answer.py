"""What became of a command that a teacher gave over the network."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from hal.errors import UserError


class NoAnswerError(UserError):
    """Nobody answered in time. It is not known whether the command counted: look at the lessons."""


class RefusedError(UserError):
    """The robot does not take what the scripted teacher cannot do without. One line."""


@dataclass(frozen=True, slots=True)
class Answer:
    """The robot's answer. A refusal is one, too."""

    accepted: bool
    """Whether it was carried out; a lesson is durable then."""
    why: str
    """Kind of a refusal, a word of the wire contract such as "stale" or "held"; empty where it was accepted."""
    text: str
    """What was done, or why not and what to do: a sentence for the teacher."""
    tick: int
    """Of the robot when it answered; -1 where it did not say."""
    extra: Mapping[str, Any] = field(default_factory=dict)
    """What else the robot answered, such as `name` and `sha256` of a copy."""


def answer_of(code: str, body: Mapping[str, Any]) -> Answer:
    """The answer in a decoded body; `code` is CoAP's, such as "4.09 Conflict"."""
    accepted = code.startswith("2.") and body.get("ok", True) is not False
    tick, text, why = body.get("t"), body.get("text"), body.get("why")
    return Answer(
        accepted=accepted,
        why="" if accepted else str(why) if why else code,
        text=text if isinstance(text, str) else "",
        tick=tick if isinstance(tick, int) else -1,
        extra={key: value for key, value in body.items() if key not in ("t", "ok", "text", "why")},
    )
