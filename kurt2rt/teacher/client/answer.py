"""Answers of the robot to commands that a teacher gave over the network."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from hal.errors import UserError
from kurt2rt.core.rla.outcome import Outcome, outcome_in
from kurt2rt.core.rla.outcome_text import Surface, fields_of, text_of


class NoAnswerError(UserError):
    """No answer came in time. It is not known whether the command counted: look at the lessons."""


@dataclass(frozen=True, slots=True)
class Answer:
    """The robot's answer. A refusal is one, too."""

    accepted: bool
    """Whether it was carried out; a lesson is durable then."""
    why: str
    """Kind of a refusal, a word of the wire contract such as "stale" or "held"; empty where it was accepted."""
    text: str
    """What was done, or why not and what to do: the robot's own sentence; a surface shows `text_on`."""
    tick: int
    """Of the robot when it answered; -1 where it did not say."""
    extra: Mapping[str, Any] = field(default_factory=dict)
    """What else the robot answered, such as `name` and `sha256` of a copy."""
    outcome: Outcome | None = None
    """Code and fields; None from a robot that tells none, or one that is not known here."""

    def text_on(self, surface: Surface) -> str:
        """Return the sentence for a surface; the robot's own if it told no code that is known here."""
        return self.text if self.outcome is None else text_of(self.outcome, surface)


def local_refusal(why: str, outcome: Outcome) -> Answer:
    """Return the refusal of a command that was not sent to the robot, or was withdrawn."""
    return Answer(False, why, text_of(outcome), -1, outcome=outcome)


class RefusedError(UserError):
    """The robot refuses a command or a file that the caller cannot do without."""

    def __init__(self, what: str, answer: Answer | None = None) -> None:
        """Keep the robot's `answer`, if it is the robot that refuses."""
        super().__init__(what)
        self.answer = answer

    def text_on(self, surface: Surface) -> str:
        """Return the sentence for a surface."""
        return str(self) if self.answer is None else self.answer.text_on(surface) or self.answer.why


_OWN_KEYS = ("t", "ok", "text", "why", "code", "fields")


def _outcome_in(body: Mapping[str, Any]) -> Outcome | None:
    outcome = outcome_in(body.get("code"), body.get("fields"))
    return outcome if outcome is not None and fields_of(outcome.code) <= outcome.fields.keys() else None


def answer_of(code: str, body: Mapping[str, Any]) -> Answer:
    """The answer in a decoded body; `code` is CoAP's, such as "4.09 Conflict"."""
    accepted = code.startswith("2.") and body.get("ok", True) is not False
    tick, text, why = body.get("t"), body.get("text"), body.get("why")
    return Answer(
        accepted=accepted,
        why="" if accepted else str(why) if why else code,
        text=text if isinstance(text, str) else "",
        tick=tick if isinstance(tick, int) else -1,
        extra={key: value for key, value in body.items() if key not in _OWN_KEYS},
        outcome=_outcome_in(body),
    )
