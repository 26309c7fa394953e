"""The person at the bench, as the checklist sees one: asked, told, free to skip and to leave."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

SKIP = "s"
LEAVE = "q"


class QuestionKind(StrEnum):
    """What a question is about."""

    BEGIN = "begin"
    """Whether to begin a step."""
    LIFTED = "lifted"
    """That the wheels are off the ground, in words."""
    MOVE = "move"
    """For leave to turn the wheels."""
    SEEN = "seen"
    """Which wheels turned, and which way."""
    CLEAR = "clear"
    """To take everything away from the sensors."""
    KEEP = "keep"
    """Whether what was found before still holds."""
    HAND = "hand"
    """For a hand before a sensor."""
    WHICH = "which"
    """Which sensors to hold a board before."""
    BOARD = "board"
    """For a board at a distance from a sensor."""
    UNTOUCHED = "untouched"
    """To touch no bumper."""
    BUMPER = "bumper"
    """For a bumper to be pressed."""
    AFTER_FAILURE = "after failure"
    """Whether to repeat a step that failed."""


@dataclass(frozen=True, slots=True)
class AnswerChoice:
    """One short answer; an empty key is Enter alone."""

    key: str
    meaning: str


@dataclass(frozen=True, slots=True)
class OperatorQuestion:
    """What a person is asked to do or to say. Every question can be answered with LEAVE."""

    about: QuestionKind
    text: str
    choices: tuple[AnswerChoice, ...] = ()
    free: bool = False
    """True when other answers than the choices have a meaning."""
    subject: str = ""
    """Name of the sensor or bumper."""
    distance_m: float | None = None
    """Where the board is asked for."""


class Tone(StrEnum):
    """How a line is meant."""

    TITLE = "title"
    PLAIN = "plain"
    MEASURED = "measured"
    GOOD = "good"
    TO_DO = "to do"
    BAD = "bad"


class Operator(Protocol):
    """Who stands at the robot."""

    async def answer(self, question: OperatorQuestion) -> str:
        """What is answered: a choice's key, or free words. Raises AbortedError when nobody answers any more."""
        ...

    def tell(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        """Say a line."""
        ...


class AbortedError(Exception):
    """The person goes; what was done so far is kept."""


class SkippedError(Exception):
    """A step is not done now. The message says why."""
