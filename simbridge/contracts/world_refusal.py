"""Refusals of a simulated world: a code and its text per reason."""

from enum import StrEnum
from typing import Self


class WorldRefusal(StrEnum):
    """Reason that a wall or the robot is not put where a teacher wants it."""

    text: str
    """Sentence with the error's fields in braces."""

    def __new__(cls, value: str, text: str) -> Self:
        """Make a member of a code and its text."""
        member = str.__new__(cls, value)
        member._value_ = value
        member.text = text
        return member

    NO_WALL = ("no wall", "world {world}: nothing is named {name!r}; there are: {known}")
    WALL_ON_ROBOT = ("wall on robot", "{name} would stand where the robot is")
    NO_ROOM = ("no room", "there is no room for the robot there")
    START_BLOCKED = ("start blocked", "a wall stands where the run began; move it")


class WorldRefusedError(ValueError):
    """Change that a simulated world refuses: a code with its fields; a tuple holds names."""

    def __init__(self, code: WorldRefusal, **fields: str | tuple[str, ...]) -> None:
        """Fill the code's text with `fields`."""
        shown = {
            key: (", ".join(each) or "nothing") if isinstance(each, tuple) else each for key, each in fields.items()
        }
        super().__init__(code.text.format(**shown))
        self.code = code
        self.fields = fields
