"""Strict CBOR: what may come from the network, and the checks that every value of it has to pass."""

import io
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

import cbor2

from hal.errors import UserError


class ChannelError(UserError):
    """The teacher's channel cannot be opened."""


class WireError(ValueError):
    """Something that is not as the wire contract says; the message is a sentence for the one who sent it."""


Check = Callable[[str, object], Any]
"""Takes what a value is called and the value, returns the value in its Python type. Raises WireError."""


@dataclass(frozen=True, slots=True)
class Bytes:
    """Bytes of one length."""

    length: int

    def __call__(self, what: str, value: object) -> bytes:
        """These bytes. Raises WireError."""
        if not isinstance(value, bytes) or len(value) != self.length:
            raise WireError(f"{what} has to be {self.length} bytes")
        return value


@dataclass(frozen=True, slots=True)
class BytesUpTo:
    """At least one byte, and no more than `most`."""

    most: int

    def __call__(self, what: str, value: object) -> bytes:
        """Return these bytes. Raises WireError."""
        if not isinstance(value, bytes) or not 1 <= len(value) <= self.most:
            raise WireError(f"{what} has to be 1 to {self.most} bytes")
        return value


@dataclass(frozen=True, slots=True)
class Int:
    """A whole number; True is none."""

    least: int
    most: int

    def __call__(self, what: str, value: object) -> int:
        """This number. Raises WireError."""
        if isinstance(value, bool) or not isinstance(value, int) or not self.least <= value <= self.most:
            raise WireError(f"{what} has to be a whole number from {self.least} to {self.most}")
        return value


@dataclass(frozen=True, slots=True)
class Float:
    """A number no larger than `most` either way, in `unit`. Whole ones count: some encoders shorten 1.0 to 1."""

    most: float
    unit: str = ""

    def __call__(self, what: str, value: object) -> float:
        """This number. Raises WireError."""
        # Compared before it is made a float: a huge whole number would overflow. No comparison with NaN is true.
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
        """This text. Raises WireError."""
        if not isinstance(value, str) or not self.least <= len(value) <= self.most or not value.isprintable():
            raise WireError(f"{what} has to be text of {self.least} to {self.most} printable characters")
        return value

    def cut(self, value: str) -> str:
        """The text with blanks for what cannot be printed, and no longer than it may be."""
        if not value.isprintable():
            value = "".join(each if each.isprintable() else " " for each in value)
        return value[: self.most]


@dataclass(frozen=True, slots=True)
class OneWord:
    """One of a few words."""

    words: tuple[str, ...]

    def __call__(self, what: str, value: object) -> str:
        """This word. Raises WireError."""
        if not isinstance(value, str) or value not in self.words:
            raise WireError(f"{what} has to be one of {', '.join(self.words)}")
        return value


@dataclass(frozen=True, slots=True)
class Flag:
    """True or False."""

    def __call__(self, what: str, value: object) -> bool:
        """This. Raises WireError."""
        if not isinstance(value, bool):
            raise WireError(f"{what} has to be true or false")
        return value


@dataclass(frozen=True, slots=True)
class OneOf:
    """One of a few whole numbers, as the type `kind` has it."""

    numbers: tuple[int, ...]
    kind: Callable[[int], Any] = int

    def __call__(self, what: str, value: object) -> Any:
        """This number, as `kind`. Raises WireError."""
        if isinstance(value, bool) or not isinstance(value, int) or value not in self.numbers:
            raise WireError(f"{what} has to be one of {', '.join(str(each) for each in self.numbers)}")
        return self.kind(value)


@dataclass(frozen=True, slots=True)
class OrNone:
    """Null, or what another check lets pass."""

    check: Check

    def __call__(self, what: str, value: object) -> Any:
        """None, or what the other check made of it. Raises WireError."""
        return None if value is None else self.check(what, value)


@dataclass(frozen=True, slots=True)
class ManyOf:
    """A list of up to `most`, each of which passes another check."""

    check: Check
    most: int

    def __call__(self, what: str, value: object) -> tuple[Any, ...]:
        """All of them. Raises WireError."""
        if not isinstance(value, list | tuple) or len(value) > self.most:
            raise WireError(f"{what} has to be a list of up to {self.most}")
        return tuple(self.check(what, each) for each in value)


@dataclass(frozen=True, slots=True)
class Row:
    """A list of a fixed length, each place with its own check."""

    checks: tuple[Check, ...]

    def __call__(self, what: str, value: object) -> tuple[Any, ...]:
        """All of them. Raises WireError."""
        if not isinstance(value, list | tuple) or len(value) != len(self.checks):
            raise WireError(f"{what} has to be a list of {len(self.checks)}")
        return tuple(check(what, each) for check, each in zip(self.checks, value, strict=True))


class _NoTags(Mapping[int, Any]):
    """Decoders for tagged values: cbor2 asks here before it looks into one, and builds none of its own objects."""

    def __getitem__(self, tag: int) -> NoReturn:
        raise WireError(f"tag {tag}: tagged values are not taken")

    def __iter__(self) -> Iterator[int]:
        return iter(())

    def __len__(self) -> int:
        return 0


def decode_strictly(payload: bytes, *, most_bytes: int, most_depth: int, text_keys: bool = True) -> Any:
    """One CBOR item: null, bool, int, float, text, bytes, and lists and maps of these, each key once.

    Tags, indefinite lengths, further bytes behind it and nesting beyond `most_depth` are refused; keys that are neither
    text nor bytes only where `text_keys` says so. Raises WireError.
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
    """CBOR of null, bool, int, float, text, bytes, lists and maps of these; nothing else has a place on the wire."""
    encoded: bytes = cbor2.dumps(item)
    return encoded
