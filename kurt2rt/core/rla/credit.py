"""Credits of a reward: the change of each RLA's value, stored so that the reward can be undone."""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import starmap
from typing import NamedTuple, overload

_ROW = struct.Struct("=Id")
_MAX_ID = 2**32 - 1


class Credit(NamedTuple):
    """Change of one RLA's value by one reward; an undo subtracts it."""

    rla_id: int
    change: float
    """Change of the RLA's value."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PackedCredits(Sequence[Credit]):
    """Tuple of credits in 12 bytes each, where objects take 120. Equals and hashes as the tuple."""

    packed: bytes

    def __len__(self) -> int:
        return len(self.packed) // _ROW.size

    def __iter__(self) -> Iterator[Credit]:
        return starmap(Credit, _ROW.iter_unpack(self.packed))

    @overload
    def __getitem__(self, place: int) -> Credit: ...

    @overload
    def __getitem__(self, place: slice) -> tuple[Credit, ...]: ...

    def __getitem__(self, place: int | slice) -> Credit | tuple[Credit, ...]:
        return tuple(self)[place]

    def __eq__(self, other: object) -> bool:
        return tuple(self) == (tuple(other) if isinstance(other, PackedCredits) else other)

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        return repr(tuple(self))


def pack_credits(credits_: Sequence[Credit]) -> Sequence[Credit]:
    """Return equal credits in less memory; return an empty sequence, or one of other types, unchanged."""
    if not credits_ or not all(map(_can_be_packed, credits_)):
        return credits_
    return PackedCredits(b"".join(starmap(_ROW.pack, credits_)))


def _can_be_packed(credit: object) -> bool:
    return (
        type(credit) is Credit
        and type(credit.change) is float
        and type(credit.rla_id) is int
        and 1 <= credit.rla_id <= _MAX_ID
    )
