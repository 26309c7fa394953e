"""Base of the errors that a user sees, in one line each, and the exit codes of the programs."""

from collections.abc import Iterable
from difflib import get_close_matches
from enum import IntEnum, StrEnum
from string import Formatter
from typing import ClassVar, Self


class ExitCode(IntEnum):
    """Exit code of each `kurt2rt` program; an error class names its own in `UserError.exit_code`."""

    DONE = 0
    FAILED = 1
    """A check, comparison or exam failed, or the user answered no."""
    REFUSED = 2
    """An error that the user can mend, or a shutdown that took too long."""
    INTERRUPTED = 130
    """Ctrl-C: 128 and SIGINT, as shells count."""


class TextCode(StrEnum):
    """Base of codes that are told to a person: each member carries its text; more values go to a subclass's init."""

    text: str
    """Fact or fault, with the fields of its case in braces."""
    do: str
    """Remedy, with the fields of its case in braces; empty if there is none, or `text` says it."""

    def __new__(cls, value: str, text: str = "", do: str = "", *_more: object) -> Self:
        """Make a member of a code and its text."""
        member = str.__new__(cls, value)
        member._value_ = value
        member.text, member.do = text, do
        return member

    @property
    def fields(self) -> frozenset[str]:
        """Names of the fields in the text and the remedy."""
        return frozenset(name for _, name, _, _ in Formatter().parse(self.text + self.do) if name)


class UserError(Exception):
    """Error that the user can mend. `str` of it is the line `<where>: <what is wrong>; <what to do>`."""

    exit_code: ClassVar[ExitCode] = ExitCode.REFUSED
    """Exit code of a command that ends with an error of this class."""

    def __init__(self, what: str, *, where: object = "", do: str = "") -> None:
        """Keep the parts of the line.

        Args:
            what: what is wrong, with what was found and what is allowed.
            where: file, device, task or key; empty where `what` names it.
            do: what mends it; empty where `what` says it.
        """
        super().__init__(what)  # `what` alone: an error that comes from another process is built from its args
        self.what = what
        self.where = str(where)
        self.do = do

    def __str__(self) -> str:
        """Return the line."""
        return (f"{self.where}: " if self.where else "") + self.what + (f"; {self.do}" if self.do else "")


class CodedError(UserError):
    """User error with a code, from whose text its line is made, so that callers can tell the cause."""

    code: TextCode

    def __init__(self, code: TextCode, *, where: object = "", **fields: object) -> None:
        """Fill the gaps in the code's texts with `fields`; `where` is as in `UserError`."""
        super().__init__(code.text.format_map(fields), where=where, do=code.do.format_map(fields))
        self.code = code


def guess(word: str, names: Iterable[str]) -> str:
    """Return "; did you mean NAME?" with the name most like a mistyped word; empty if none is like it."""
    return "".join(f"; did you mean {name}?" for name in get_close_matches(word, list(names), n=1))
