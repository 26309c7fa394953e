"""Types of the fields in messages, with their ranges, which pydantic checks."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cache
from math import inf, isfinite
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from pydantic import GetCoreSchemaHandler, TypeAdapter, ValidationError
from pydantic_core import CoreSchema, core_schema

LARGEST_NUMBER = 2**53
"""Largest tick, sequence number or RLA: the largest integer that every language holds exactly."""
LONGEST_TEXT = 64


class WireError(ValueError):
    """Value that breaks the wire contract; the message is a sentence for its sender."""


@dataclass(frozen=True, slots=True)
class Bytes:
    """Byte string of one exact length."""

    length: int

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        """Return the schema."""
        schema = core_schema.bytes_schema(strict=True, min_length=self.length, max_length=self.length)
        return worded(schema, f"has to be {self.length} bytes")


@dataclass(frozen=True, slots=True)
class BytesUpTo:
    """Check of a byte string of 1 to `most` bytes."""

    most: int

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        """Return the schema."""
        schema = core_schema.bytes_schema(strict=True, min_length=1, max_length=self.most)
        return worded(schema, f"has to be 1 to {self.most} bytes")


@dataclass(frozen=True, slots=True)
class Int:
    """Check of a whole number from `least` to `most`; a bool is none."""

    least: int
    most: int

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        """Return the schema."""
        schema = core_schema.int_schema(strict=True, ge=self.least, le=self.most)
        return worded(schema, f"has to be a whole number from {self.least} to {self.most}")


@dataclass(frozen=True, slots=True)
class Float:
    """Check of a number from -`most` to `most`, in `unit`; integers count.

    Some encoders shorten 1.0 to 1.
    """

    most: float
    unit: str = ""

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        """Return the schema; no range holds NaN."""
        unit = f" {self.unit}" if self.unit else ""
        schema = core_schema.float_schema(strict=True, ge=-self.most, le=self.most)
        return worded(schema, f"has to be a number from {-self.most:g} to {self.most:g}{unit}")


@dataclass(frozen=True, slots=True)
class Text:
    """Printable text of `least` to `most` characters; the sender cuts a longer one and blanks other characters."""

    most: int
    least: int = 0

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        """Return the schema."""

        def printable(value: str) -> str:
            if not self.least <= len(value) <= self.most or not value.isprintable():
                raise ValueError
            return value

        schema = core_schema.no_info_after_validator_function(printable, core_schema.str_schema(strict=True))
        cut = core_schema.plain_serializer_function_ser_schema(self.cut)
        says = f"has to be text of {self.least} to {self.most} printable characters"
        return {**worded(schema, says), "serialization": cut}

    def cut(self, value: str) -> str:
        """Return the text with blanks for unprintable characters, cut to `most` characters."""
        if not value.isprintable():
            value = "".join(each if each.isprintable() else " " for each in value)
        return value[: self.most]


@dataclass(frozen=True, slots=True)
class OneOf:
    """Check of a whole number that has to be one of `numbers`; returns it converted by `kind`."""

    values: tuple[str | int, ...]
    kind: Callable[[Any], Any] | None = None

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        """Return the schema."""
        schema: CoreSchema = core_schema.literal_schema(list(self.values))
        if isinstance(self.values[0], int):  # True equals 1
            schema = core_schema.chain_schema([core_schema.int_schema(strict=True), schema])
        if self.kind is not None:
            schema = core_schema.no_info_after_validator_function(self.kind, schema)
        return worded(schema, f"has to be one of {', '.join(map(str, self.values))}")


@dataclass(frozen=True, slots=True)
class Flag:
    """True or false, and no number."""

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        """Return the schema."""
        return worded(core_schema.bool_schema(strict=True), "has to be true or false")


@dataclass(frozen=True, slots=True)
class UpTo:
    """Tuple of up to `most` values; the sender leaves out further ones."""

    most: int

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the schema of a tuple."""

        def cut(value: tuple[Any, ...], inner: Callable[[Any], Any]) -> Any:
            return inner(value[: self.most])

        shortened = core_schema.wrap_serializer_function_ser_schema(cut)
        return {**handler(source), "max_length": self.most, "serialization": shortened}


@dataclass(frozen=True, slots=True)
class OrNotFinite:
    """Check of a number that is sent as null if it is not finite; null is read as `stands_for`."""

    stands_for: float
    """Value of null."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the schema of a number or null."""

        def number(value: float | None) -> float:
            return self.stands_for if value is None else value

        finite = core_schema.plain_serializer_function_ser_schema(lambda value: value if isfinite(value) else None)
        schema = core_schema.nullable_schema(handler(source))
        return core_schema.no_info_after_validator_function(number, schema, serialization=finite)


Number = Annotated[int, Int(0, LARGEST_NUMBER)]
Real = Annotated[float, Float(inf)]
Finite = Annotated[float, Float(1e9)]
Time = Annotated[float, Float(1e12)]
Share = Annotated[float, Float(1.0)]
Name = Annotated[str, Text(LONGEST_TEXT, least=1)]
Word = Annotated[str, Text(LONGEST_TEXT)]
Title = Annotated[str, Text(128)]
Line = Annotated[str, Text(512)]
Truth = Annotated[bool, Flag()]


class Check:
    """Check of a field by its annotation."""

    def __init__(self, hint: Any) -> None:
        """Check values of an annotated type."""
        self.hint = hint
        self._adapter: TypeAdapter[Any] = TypeAdapter(hint)

    def __call__(self, what: str, value: object) -> Any:
        """Return the value of the field named `what` in its Python type. Raises WireError."""
        try:
            return self._adapter.validate_python(value)
        except ValidationError as error:
            raise wire_error(what, error) from None


def wire_error(what: str, error: ValidationError) -> WireError:
    """Return the first problem as a sentence that begins with the field; `what` names the value."""
    problem = error.errors(include_url=False, include_input=False)[0]
    place = ".".join((what, *map(str, problem["loc"])))
    says = _PROBLEMS.get(problem["type"], "has an error: {msg}")
    says = says.format(**{**problem.get("ctx", {}), "msg": problem["msg"]})
    return WireError(f"{place} {says}")


@cache
def check_of(hint: Any) -> Check:
    """Return the check of an annotated type."""
    return Check(hint)


def checks_of(kind: type) -> dict[str, Check]:
    """Return the check of each field of a message's dataclass by its name, in order, without the unchecked ones."""
    return _checks_of(kind)


@cache
def _checks_of(kind: type) -> dict[str, Check]:
    hints: dict[str, Any] = get_type_hints(kind, include_extras=True)
    own = {each.name: hints[each.name] for each in fields(kind)}
    return {name: check_of(hint) for name, hint in own.items() if _is_annotated(hint)}


def _is_annotated(hint: Any) -> bool:
    return any(get_origin(each) is Annotated for each in (hint, *get_args(hint)))


def worded(schema: CoreSchema, says: str) -> CoreSchema:
    """Return a schema whose errors are one sentence."""
    return core_schema.custom_error_schema(schema, custom_error_type=_WORDED, custom_error_message=says)


_WORDED = "worded"
_PROBLEMS = {_WORDED: "{msg}", "too_long": "has to be a list of up to {max_length}", "missing": "is missing"}
