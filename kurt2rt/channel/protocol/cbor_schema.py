"""Codec between dataclasses and maps with words as keys, for answers that are rare."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

from kurt2rt.core.teaching.message_fields import Check, Flag, Float, Int, ListOf, OrNone, Text, WireError

COUNT: Final = Int(0, 2**53)
NAME: Final = Text(128)
LINE: Final = Text(512)

ValueT = TypeVar("ValueT")


class MapOf:
    """Check of a map by its keys; other keys are left out."""

    def __init__(self, kind: Callable[..., Any], **checks: Check) -> None:
        """`kind` is called with the values by their keys."""
        self.kind = kind
        self.checks = checks

    def __call__(self, what: str, value: object) -> Any:
        """Return the checked value. Raises WireError."""
        if not isinstance(value, Mapping):
            raise WireError(f"{what} has to be a map")
        missing = [name for name in self.checks if name not in value]
        if missing:
            raise WireError(f"{what} has no {', '.join(missing)}")
        return self.kind(**{name: check(name, value[name]) for name, check in self.checks.items()})


@dataclass(frozen=True, slots=True)
class OrNotFinite:
    """Check of a number whose non-finite value is null on the wire."""

    check: Check
    stands_for: float
    """Value of null."""

    def __call__(self, what: str, value: object) -> Any:
        """Return the checked value. Raises WireError."""
        return self.stands_for if value is None else self.check(what, value)


class DataclassCodec(Generic[ValueT]):
    """Codec of a dataclass to plain values for JSON and CBOR; the keys are its fields."""

    def __init__(self, what: str, shape: MapOf) -> None:
        """Name the value `what` in errors."""
        self._what = what
        self._shape = shape

    def plain_of(self, value: ValueT) -> dict[str, Any]:
        """Return a dataclass as maps, lists, texts and finite numbers that `read` accepts."""
        plain: dict[str, Any] = _plain(value, self._shape)
        return plain

    def read(self, plain: object) -> ValueT:
        """Return the dataclass of plain values. Raises kurt2rt.channel.protocol.schema.WireError."""
        value: ValueT = self._shape(self._what, plain)
        return value


def _plain(value: Any, check: Check) -> Any:
    """Return a value in the form that the check accepts; texts and lists that are too long are cut."""
    match check:
        case MapOf(checks=checks):
            return {name: _plain(getattr(value, name), inner) for name, inner in checks.items()}
        case ListOf(check=Float() | Int() | Flag(), most=most):  # valid already; a condition has 72
            return list(value[:most])
        case ListOf(check=inner, most=most):
            return [_plain(each, inner) for each in value[:most]]
        case OrNone(check=inner) if value is not None:
            return _plain(value, inner)
        case OrNotFinite():
            return value if abs(value) < float("inf") else None
        case Text():
            return check.cut(value)
        case _:
            return value
