"""A condition: a point in feature space, held once for as long as its RLA is known."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import DTypeLike, NDArray

_BYTES = 8


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PackedCondition(Sequence[float]):
    """Is, equals and hashes as the tuple of its numbers, in 8 bytes a number where boxed floats take 32."""

    packed: bytes
    """Its float64s, as this machine has them in memory."""

    @property
    def _numbers(self) -> "memoryview[float]":
        return memoryview(self.packed).cast("d")

    def __len__(self) -> int:
        return len(self.packed) // _BYTES

    def __iter__(self) -> Iterator[float]:
        return iter(self._numbers)

    @overload
    def __getitem__(self, place: int) -> float: ...

    @overload
    def __getitem__(self, place: slice) -> tuple[float, ...]: ...

    def __getitem__(self, place: int | slice) -> float | tuple[float, ...]:
        return tuple(self._numbers[place]) if isinstance(place, slice) else self._numbers[place]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PackedCondition):
            return tuple(self) == other if isinstance(other, tuple) else NotImplemented
        mine, its = self.packed, other.packed
        if mine is its:
            return True
        # Of the numbers, not of the bytes: 0.0 and -0.0 are one place.
        return memoryview(mine).cast("d").__eq__(memoryview(its).cast("d"))

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        return repr(tuple(self))

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[np.float64]:
        """Shape (d,), for `np.array`; not to be written to where no copy was asked for."""
        array = np.frombuffer(self.packed)
        return array.astype(dtype or array.dtype, copy=bool(copy))


Condition = tuple[float, ...] | PackedCondition
"""A point in feature space, one float64 per feature of the situation definition."""


def packed(condition: Condition) -> Condition:
    """The same in less memory; what is not made of floats alone stays as it is, for others to refuse."""
    if isinstance(condition, PackedCondition) or set(map(type, condition)) != {float}:
        return condition
    return PackedCondition(np.array(condition).tobytes())
