"""Answers of the robot to a teacher's requests, and the error for the lack of one."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from config.errors import TextCode, UserError
from kurt2rt.core.outcome import Code, Outcome, RefusalCode, outcome_in
from kurt2rt.core.outcome_text import Surface, fields_of, text_of


class NoAnswer(TextCode):
    """Code for why a request got no usable answer from the robot; some leave open whether it counted."""

    NO_STATE = ("no state", "no word from the robot, so nothing was sent to it")
    SILENT = ("silent", "no state of the robot for {after_s:g} s")
    NO_REPLY = (
        "no reply",
        "no answer for {after_s:g} s: it is not known whether it counted; look at the lessons",
    )
    STOP_UNANSWERED = (
        "stop unanswered",
        "the stop is not answered: no answer for {after_s:g} s; it is sent on until it is",
    )
    NOT_UNDERSTOOD = ("not understood", "the robot's answer to {path} is not understood: {says}")
    NO_ROBOT = ("no robot", "no robot answers {says}")
    OTHER = ("other", "{says}")
    """The text is the caller's."""


class NoAnswerError(UserError):
    """No answer came in time; a command may have counted: look at the lessons."""

    def __init__(
        self,
        says: str = "",
        code: NoAnswer = NoAnswer.OTHER,
        *,
        trouble: str = "",
        where: object = "",
        do: str = "",
        **parts: str | float,
    ) -> None:
        """Word the code.

        Args:
            says: Detail for the text of the code.
            code: Kind of the missing answer.
            trouble: Sentence on the network; empty if nothing is known.
            where: As in UserError.
            do: As in UserError.
            parts: Values that the text of the code names.
        """
        text = code.text.format(says=says, **parts)
        super().__init__(f"{text}. {trouble}" if trouble else text, where=where, do=do)
        self.code = code


@dataclass(frozen=True, slots=True)
class Answer:
    """Robot's answer to a command or a request, or its refusal."""

    accepted: bool
    """True if the command was carried out; a lesson is durable then."""
    why: str
    """Kind of a refusal, a word of the wire contract such as "stale" or "held"; empty if accepted."""
    text: str
    """Result, or the reason and the remedy: the robot's own sentence; a surface shows `text_on`."""
    tick: int
    """Tick of the robot when it answered; -1 if it did not tell."""
    extra: Mapping[str, Any] = field(default_factory=dict)
    """Further values of the answer, such as `name` and `sha256` of a copy."""
    outcome: Outcome | None = None
    """Code and fields; None of a request that was not understood, and of an answer without a text."""

    @property
    def lesson(self) -> str | None:
        """Id that `undo` takes to undo what the command taught; None if it taught nothing."""
        lesson = self.extra.get("lesson")
        return lesson if isinstance(lesson, str) else None

    @property
    def code(self) -> Code | None:
        """Code of the outcome; None without one."""
        return None if self.outcome is None else self.outcome.code

    def text_on(self, surface: Surface) -> str:
        """Return the sentence for a surface; the robot's own without an outcome."""
        return self.text if self.outcome is None else text_of(self.outcome, surface)


_WHY: Final = {
    RefusalCode.MALFORMED: "malformed",
    RefusalCode.NOT_UNDERSTOOD: "malformed",
    RefusalCode.NO_PICTURE: "stale",
    RefusalCode.PICTURE_LOST: "stale",
    RefusalCode.RESTARTED_MEANWHILE: "boot",
    RefusalCode.STOPPED_MEANWHILE: "stopped",
    RefusalCode.PRESS_OVER: "stopped",
}
"""Wire word of each refusal that this device makes itself."""


def local_refusal(code: RefusalCode, **fields: Any) -> Answer:
    """Return the refusal of a command that this device itself withdrew or did not send."""
    outcome = Outcome.of(code, **fields)
    return Answer(False, _WHY[code], text_of(outcome), -1, outcome=outcome)


class RefusedError(UserError):
    """Refusal of a command or a file without which the caller cannot go on."""

    def __init__(self, what: str, answer: Answer | None = None) -> None:
        """Keep the robot's `answer`, if it is the robot that refuses."""
        super().__init__(what)
        self.answer = answer

    def text_on(self, surface: Surface) -> str:
        """Return the sentence of the refusal for a surface."""
        return str(self) if self.answer is None else self.answer.text_on(surface) or self.answer.why


_OWN_KEYS = ("t", "ok", "text", "why", "code", "fields")


def _outcome_in(body: Mapping[str, Any]) -> Outcome | None:
    outcome = outcome_in(body.get("code"), body.get("fields"))
    return outcome if outcome is not None and fields_of(outcome.code) <= outcome.fields.keys() else None


def answer_of(code: str, body: Mapping[str, Any]) -> Answer:
    """Return the answer of the robot from the decoded body of its response.

    `code`: CoAP's, such as "4.09 Conflict"; it tells whether the request was accepted.
    """
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


def no_robot(host: str, port: int, name: str) -> NoAnswerError:
    """Return the error for a robot expected at `host` and `port`; `name` is the device that asked."""
    return NoAnswerError(
        f"at {host}:{port} as {name}", NoAnswer.NO_ROBOT, do="start one in another terminal: kurt2rt run"
    )
