"""Strict CBOR for input from the network, and checks of its values."""

import io
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

import cbor2

from hal.errors import UserError


class ChannelError(UserError):
    """The teacher's channel cannot be opened."""


class WireError(ValueError):
    """Value that breaks the wire contract; the message is a sentence for its sender."""


Check = Callable[[str, object], Any]
"""Function of a value's name and the value; it returns the value in its Python type. Raises WireError."""


@dataclass(frozen=True, slots=True)
class Bytes:
    """Bytes of one length."""

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
    """Printable text."""

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
    """True or False."""

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
class ManyOf:
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


class _NoTags(Mapping[int, Any]):
    """Decoders of tagged values that refuse all tags before cbor2 builds an object."""

    def __getitem__(self, tag: int) -> NoReturn:
        raise WireError(f"tag {tag}: tagged values are not taken")

    def __iter__(self) -> Iterator[int]:
        return iter(())

    def __len__(self) -> int:
        return 0


def decode_strictly(payload: bytes, *, most_bytes: int, most_depth: int, text_keys: bool = True) -> Any:
    """Return one CBOR item: null, bool, int, float, text, bytes, and lists and maps of these, each key once.

    Raises WireError for tags, indefinite lengths and trailing bytes too.

    Args:
        payload: Encoded item.
        most_bytes: Largest size in bytes.
        most_depth: Deepest nesting of lists and maps.
        text_keys: Whether to refuse keys that are neither text nor bytes.
    """
    if len(payload) > most_bytes:
        raise WireError(f"{len(payload)} bytes are too many; {most_bytes} are taken")
    stream = io.BytesIO(payload)
    decoder = cbor2.CBORDecoder(
        stream,
        semantic_decoders=_NoTags(),
        max_depth=most_depth,
        allow_indefinite=False,
        allow_duplicate_keys=False,
        strict_hashable_types=text_keys,
    )
    try:
        item = decoder.decode()
    except cbor2.CBORError as error:
        reason = error.__cause__ if isinstance(error.__cause__, WireError) else error
        raise WireError(f"this is not the CBOR that is taken here: {reason}") from error
    if stream.tell() != len(payload):
        raise WireError(f"{len(payload) - stream.tell()} bytes too many at the end")
    return item


def encode_plainly(item: object) -> bytes:
    """Return the CBOR of null, bool, int, float, text, bytes, or lists and maps of these."""
    encoded: bytes = cbor2.dumps(item)
    return encoded
