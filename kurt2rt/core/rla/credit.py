"""What a reward changed: the share of each RLA in it, held for as long as the reward can be undone."""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, overload

_ROW = struct.Struct("=IdI")
"""Id, change, and id of the one before it, 0 for none."""
_MOST_ID = 2**32 - 1


class Credit(NamedTuple):
    """An RLA's share in a reward."""

    rla_id: int
    change: float
    """What its value was changed by; with `before` what that of the edge was."""
    before: int | None = None
    """The RLA before it, where it was an edge of the network whose weight was changed."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PackedCredits(Sequence[Credit]):
    """Is, equals and hashes as the tuple of its credits, in 16 bytes each where objects take 120."""

    packed: bytes

    def __len__(self) -> int:
        return len(self.packed) // _ROW.size

    def __iter__(self) -> Iterator[Credit]:
        return (_credit(*row) for row in _ROW.iter_unpack(self.packed))

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


def packed(credits_: Sequence[Credit]) -> Sequence[Credit]:
    """The same in less memory; none, and what is not made as credits are, stay as they are, for others to refuse."""
    if not credits_ or not all(map(_can_be_packed, credits_)):
        return credits_
    return PackedCredits(b"".join(_ROW.pack(rla_id, change, before or 0) for rla_id, change, before in credits_))


def _can_be_packed(credit: object) -> bool:
    return (
        type(credit) is Credit
        and type(credit.change) is float
        and _is_id(credit.rla_id)
        and (credit.before is None or _is_id(credit.before))
    )


def _is_id(value: object) -> bool:
    return type(value) is int and 1 <= value <= _MOST_ID


def _credit(rla_id: int, change: float, before: int) -> Credit:
    return Credit(rla_id, change, before or None)
