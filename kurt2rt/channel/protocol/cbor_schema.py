"""Maps with words for keys, for what is told seldom: each key with its check, and from a dataclass and back."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

from kurt2rt.channel.protocol.schema import Check, Flag, Float, Int, ManyOf, OrNone, Text, WireError

COUNT: Final = Int(0, 2**53)
NAME: Final = Text(128)
LINE: Final = Text(512)

ToldT = TypeVar("ToldT")


@dataclass(frozen=True, slots=True)
class MayLack:
    """A check of a key that an older robot does not tell: the value's default stands for it."""

    check: Check

    def __call__(self, what: str, value: object) -> Any:
        """Return what the check made of the value. Raises WireError."""
        return self.check(what, value)


class MapOf:
    """A map with a check for each of its keys; unknown keys are left out, for a newer robot may tell more."""

    def __init__(self, kind: Callable[..., Any], **checks: Check) -> None:
        """`kind` is made of the values, by the keys."""
        self.kind = kind
        self.checks = checks

    def __call__(self, what: str, value: object) -> Any:
        """What `kind` makes of it. Raises WireError."""
        if not isinstance(value, Mapping):
            raise WireError(f"{what} has to be a map")
        missing = [name for name, check in self.checks.items() if name not in value and not isinstance(check, MayLack)]
        if missing:
            raise WireError(f"{what} has no {', '.join(missing)}")
        return self.kind(**{name: check(name, value[name]) for name, check in self.checks.items() if name in value})


@dataclass(frozen=True, slots=True)
class OrNotFinite:
    """Null for a number that is not finite, which has no place on the wire."""

    check: Check
    stands_for: float
    """What null is."""

    def __call__(self, what: str, value: object) -> Any:
        """The number. Raises WireError."""
        return self.stands_for if value is None else self.check(what, value)


class Form(Generic[ToldT]):
    """How a dataclass is told as plain values, for JSON and CBOR, and read again. Names are those of its fields."""

    def __init__(self, what: str, shape: MapOf) -> None:
        """`what`: what is told, in words."""
        self._what = what
        self._shape = shape

    def plain_of(self, value: ToldT) -> dict[str, Any]:
        """Maps, lists, texts and numbers; texts are cut and tidied as `read` wants them, none of it is infinite."""
        plain: dict[str, Any] = _plainly(value, self._shape)
        return plain

    def read(self, plain: object) -> ToldT:
        """What was told. Raises kurt2rt.channel.protocol.schema.WireError."""
        value: ToldT = self._shape(self._what, plain)
        return value


def _plainly(value: Any, check: Check) -> Any:
    """A dataclass, tuple, text or number as the check wants to see it on the other side.

    Texts are cut and tidied, lists are no longer than they may be.
    """
    match check:
        case MapOf(checks=checks):
            return {name: _plainly(getattr(value, name), inner) for name, inner in checks.items()}
        case ManyOf(check=Float() | Int() | Flag(), most=most):  # a condition has 72: they are as they should be
            return list(value[:most])
        case ManyOf(check=inner, most=most):
            return [_plainly(each, inner) for each in value[:most]]
        case MayLack(check=inner):
            return _plainly(value, inner)
        case OrNone(check=inner) if value is not None:
            return _plainly(value, inner)
        case OrNotFinite():
            return value if abs(value) < float("inf") else None
        case Text():
            return check.cut(value)
        case _:
            return value
