"""Protocol of the operator at the test stand, and the questions to them."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

SKIP = "s"
LEAVE = "q"


class QuestionKind(StrEnum):
    """Subject of a question to the operator, by which a script in place of a person answers."""

    BEGIN = "begin"
    """Start of a step."""
    LIFTED = "lifted"
    """Confirmation in words that the wheels are off the ground."""
    MOVE = "move"
    """Permission to turn the wheels."""
    SEEN = "seen"
    """Observed wheels and directions."""
    CLEAR = "clear"
    """Removal of everything in front of the sensors."""
    KEEP = "keep"
    """Validity of earlier findings."""
    HAND = "hand"
    """Hand in front of a sensor."""
    WHICH = "which"
    """Sensors for the calibration."""
    BOARD = "board"
    """Board at a distance from a sensor."""
    UNTOUCHED = "untouched"
    """Release of all bumpers."""
    BUMPER = "bumper"
    """Press of a bumper."""
    AFTER_FAILURE = "after failure"
    """Repetition of a failed step."""


@dataclass(frozen=True, slots=True)
class AnswerChoice:
    """Short answer that a question offers: the typed key and its meaning; an empty key is Enter alone."""

    key: str
    meaning: str


@dataclass(frozen=True, slots=True)
class OperatorQuestion:
    """Question or instruction of a step to the operator; the answer LEAVE to any of them ends the session."""

    about: QuestionKind
    text: str
    choices: tuple[AnswerChoice, ...] = ()
    free: bool = False
    """True if other answers than the choices are valid."""
    subject: str = ""
    """Name of the sensor or bumper."""
    distance_m: float | None = None
    """Requested distance of the board."""


class Tone(StrEnum):
    """Style of a line on the operator's screen: a title, a measurement, a fault and others."""

    TITLE = "title"
    PLAIN = "plain"
    MEASURED = "measured"
    GOOD = "good"
    TO_DO = "to do"
    BAD = "bad"


class Operator(Protocol):
    """Person who stands next to the robot, reads the lines of a step and answers its questions."""

    async def answer(self, question: OperatorQuestion) -> str:
        """Return the key of a choice, or free text if the question has no choices.

        Raises AbortedError if no answer can come.
        """
        ...

    def tell(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        """Show a line of text to the operator; `tone` tells how important it is."""
        ...


class AbortedError(Exception):
    """End of the session by the operator; the progress is kept."""
