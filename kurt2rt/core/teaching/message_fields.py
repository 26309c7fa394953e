"""Checks of the values in a teacher's messages, and the types of their fields, each with its check."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from kurt2rt.core.decision.goal import Goal, NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.lesson_speed import SLOWEST
from kurt2rt.core.rla.rla import BASIC, MID, Phase

LARGEST_NUMBER = 2**53
"""Largest tick, sequence number or RLA: the largest integer that every language holds exactly."""
LONGEST_TEXT = 64
HIGHEST_SPEED_M_S = 2.0
LONGEST_BEHAVIOUR_TICKS = 60_000
"""Ten minutes at 100 Hz."""
MOST_GOAL_FEATURES = 16
MOST_SEGMENTS = 12
"""Largest number of segments of a drive by hand that are published; older ones stay untaught."""
SLOWEST_PERCENT = round(100 * SLOWEST)
"""Least speed of a lesson."""


class WireError(ValueError):
    """Value that breaks the wire contract; the message is a sentence for its sender."""


Check = Callable[[str, object], Any]
"""Function of a value's name and the value; it returns the value in its Python type. Raises WireError."""


@dataclass(frozen=True, slots=True)
class Bytes:
    """Check of a byte string of one exact length."""

    length: int

    def __call__(self, what: str, value: object) -> bytes:
        """Return the checked value. Raises WireError."""
        if not isinstance(value, bytes) or len(value) != self.length:
            raise WireError(f"{what} has to be {self.length} bytes")
        return value


@dataclass(frozen=True, slots=True)
class BytesUpTo:
    """One byte to `most` bytes."""

    most: int

    def __call__(self, what: str, value: object) -> bytes:
        """Return the checked value. Raises WireError."""
        if not isinstance(value, bytes) or not 1 <= len(value) <= self.most:
            raise WireError(f"{what} has to be 1 to {self.most} bytes")
        return value


@dataclass(frozen=True, slots=True)
class Int:
    """Whole number; a bool is none."""

    least: int
    most: int

    def __call__(self, what: str, value: object) -> int:
        """Return the checked value. Raises WireError."""
        if isinstance(value, bool) or not isinstance(value, int) or not self.least <= value <= self.most:
            raise WireError(f"{what} has to be a whole number from {self.least} to {self.most}")
        return value


@dataclass(frozen=True, slots=True)
class Float:
    """Number from -`most` to `most`, in `unit`. Integers count, because some encoders shorten 1.0 to 1."""

    most: float
    unit: str = ""

    def __call__(self, what: str, value: object) -> float:
        """Return the checked value. Raises WireError."""
        # Compared before the conversion, which overflows for huge integers. No comparison with NaN is true.
        if isinstance(value, bool) or not isinstance(value, int | float) or not -self.most <= value <= self.most:
            unit = f" {self.unit}" if self.unit else ""
            raise WireError(f"{what} has to be a number from {-self.most:g} to {self.most:g}{unit}")
        return float(value)


@dataclass(frozen=True, slots=True)
class Text:
    """Check of a printable text of `least` to `most` characters."""

    most: int
    least: int = 0

    def __call__(self, what: str, value: object) -> str:
        """Return the checked value. Raises WireError."""
        if not isinstance(value, str) or not self.least <= len(value) <= self.most or not value.isprintable():
            raise WireError(f"{what} has to be text of {self.least} to {self.most} printable characters")
        return value

    def cut(self, value: str) -> str:
        """Return the text with blanks for unprintable characters, cut to `most` characters."""
        if not value.isprintable():
            value = "".join(each if each.isprintable() else " " for each in value)
        return value[: self.most]


@dataclass(frozen=True, slots=True)
class OneWord:
    """One of a few words."""

    words: tuple[str, ...]

    def __call__(self, what: str, value: object) -> str:
        """Return the checked value. Raises WireError."""
        if not isinstance(value, str) or value not in self.words:
            raise WireError(f"{what} has to be one of {', '.join(self.words)}")
        return value


@dataclass(frozen=True, slots=True)
class Flag:
    """Check of a value that has to be true or false."""

    def __call__(self, what: str, value: object) -> bool:
        """Return the checked value. Raises WireError."""
        if not isinstance(value, bool):
            raise WireError(f"{what} has to be true or false")
        return value


@dataclass(frozen=True, slots=True)
class OneOf:
    """One of a few whole numbers, converted by `kind`."""

    numbers: tuple[int, ...]
    kind: Callable[[int], Any] = int

    def __call__(self, what: str, value: object) -> Any:
        """Return the checked value. Raises WireError."""
        if isinstance(value, bool) or not isinstance(value, int) or value not in self.numbers:
            raise WireError(f"{what} has to be one of {', '.join(str(each) for each in self.numbers)}")
        return self.kind(value)


@dataclass(frozen=True, slots=True)
class OrNone:
    """Null, or a value that another check accepts."""

    check: Check

    def __call__(self, what: str, value: object) -> Any:
        """Return the checked value. Raises WireError."""
        return None if value is None else self.check(what, value)


@dataclass(frozen=True, slots=True)
class ListOf:
    """List of up to `most` values that another check accepts."""

    check: Check
    most: int

    def __call__(self, what: str, value: object) -> tuple[Any, ...]:
        """Return the checked value. Raises WireError."""
        if not isinstance(value, list | tuple) or len(value) > self.most:
            raise WireError(f"{what} has to be a list of up to {self.most}")
        return tuple(self.check(what, each) for each in value)


@dataclass(frozen=True, slots=True)
class Row:
    """List of fixed length with a check for each place."""

    checks: tuple[Check, ...]

    def __call__(self, what: str, value: object) -> tuple[Any, ...]:
        """Return the checked value. Raises WireError."""
        if not isinstance(value, list | tuple) or len(value) != len(self.checks):
            raise WireError(f"{what} has to be a list of {len(self.checks)}")
        return tuple(check(what, each) for check, each in zip(self.checks, value, strict=True))


Number = Annotated[int, Int(0, LARGEST_NUMBER)]
NumberOrNone = Annotated[int | None, OrNone(Int(0, LARGEST_NUMBER))]
Speed = Annotated[float, Float(HIGHEST_SPEED_M_S, "m/s")]
_NAME = Text(LONGEST_TEXT, least=1)
Name = Annotated[str, _NAME]
NameOrNone = Annotated[str | None, OrNone(_NAME)]
Level = Annotated[str, OneWord((BASIC, MID))]
Truth = Annotated[bool, Flag()]
PhaseNumber = Annotated[Phase, OneOf(tuple(each.value for each in Phase), Phase)]
_FEATURES = ListOf(Row((_NAME, Float(1e6))), most=MOST_GOAL_FEATURES)


@dataclass(frozen=True, slots=True)
class GoalField:
    """Goal of a plan: a name, the number of an RLA, or features with a tolerance."""

    def __call__(self, what: str, value: object) -> Goal:
        """Return the checked value. Raises WireError."""
        match plain(value):
            case str(name):
                return NamedGoal(_NAME(what, name))
            case int(rla_id):
                return RlaGoal(Int(0, LARGEST_NUMBER)(what, rla_id))
            case list() | tuple() as like:
                return PartialGoal(*Row((_FEATURES, Float(1e6)))(what, like))
        raise WireError(f"{what} has to be a name, the number of an RLA, or a list of features and a tolerance")


def plain(value: Any) -> Any:
    """Return a goal as its one field, or as the list of its fields; other values as they are."""
    match value:
        case NamedGoal(name=name):
            return name
        case RlaGoal(rla_id=rla_id):
            return rla_id
        case PartialGoal(features=features, tolerance=tolerance):
            return [features, tolerance]
    return value


def checks_of(kind: type) -> dict[str, Check]:
    """Return the check of each field of a message's dataclass by its name, in order, without the others."""
    hints: dict[str, Any] = get_type_hints(kind, include_extras=True)
    own = {each.name: hints[each.name] for each in fields(kind)}
    return {name: get_args(hint)[1] for name, hint in own.items() if get_origin(hint) is Annotated}
