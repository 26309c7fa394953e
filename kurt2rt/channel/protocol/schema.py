"""Strict CBOR for input from the network, and codecs of annotated classes."""

import io
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any, Generic, NoReturn, TypeVar

import cbor2
from pydantic import TypeAdapter, ValidationError

from config.errors import UserError
from kurt2rt.core.message_fields import WireError, wire_error


class ChannelError(UserError):
    """Teachers' channel that cannot be opened, because its address or UDP port is not to be had."""


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


ValueT = TypeVar("ValueT")


class Codec(Generic[ValueT]):
    """Codec of a class with annotated fields: its plain values are maps by the fields' names, or rows."""

    def __init__(self, what: str, kind: Any) -> None:
        """Name the value `what` in errors; `kind` is its type: a dataclass is a map, a named tuple a row."""
        self._what = what
        self._kind = kind

    @cached_property
    def _adapter(self) -> TypeAdapter[ValueT]:
        return TypeAdapter(self._kind)  # at first use, because a client of one answer needs no other

    def plain_of(self, value: ValueT) -> Any:
        """Return maps, lists, texts and finite numbers that `read` accepts. Long texts and lists are cut."""
        return self._adapter.dump_python(value, by_alias=True)

    def read(self, plain: object) -> ValueT:
        """Return the value in plain values; other keys of maps are left out. Raises WireError."""
        try:
            return self._adapter.validate_python(plain)
        except ValidationError as error:
            raise wire_error(self._what, error) from None
