"""Conditions: points in feature space, stored once for the lifetime of their RLA; and the features of a space."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, overload

import numpy as np
from numpy.typing import DTypeLike, NDArray

_BYTES = 8


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PackedCondition(Sequence[float]):
    """Tuple of float64 in 8 bytes a number, where boxed floats take 32. Equals and hashes as the tuple."""

    packed: bytes
    """Numbers in the byte order of this machine."""

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
        # Compare numbers, not bytes: 0.0 equals -0.0.
        return memoryview(mine).cast("d").__eq__(memoryview(its).cast("d"))

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        return repr(tuple(self))

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[np.float64]:
        """Return an array (d,) for `np.array`; read-only unless a copy is requested."""
        array = np.frombuffer(self.packed)
        return array.astype(dtype or array.dtype, copy=bool(copy))


Condition = tuple[float, ...] | PackedCondition
"""Point in feature space where an RLA applies: its part C (paper, section III.A.1).

One float64 per feature of the level, in the feature's unit; shape (72,) at the basic level. It is the situation in
which the teacher gave the lesson, not weighted."""


def pack_condition(condition: Condition) -> Condition:
    """Return an equal condition in less memory; return anything but a tuple of floats unchanged."""
    if isinstance(condition, PackedCondition) or set(map(type, condition)) != {float}:
        return condition
    return PackedCondition(np.array(condition).tobytes())


Metric = Literal["euclidean", "hamming"]
"""Distance between two points: Euclidean for measured features; for symbols the number of places that differ."""


class Space(NamedTuple):
    """Dimensions, radius, weights and metric by which one level measures distances between situations."""

    dimensions: int
    radius: float
    """Confidence radius of RLAs without an own radius."""
    weights: NDArray[np.float64] | None = None
    """Weight of each feature in a distance, shape (dimensions,); None: all 1. Symbols have no weights."""
    metric: Metric = "euclidean"


@dataclass(frozen=True, slots=True)
class LevelFeatures:
    """Features of one level's conditions, by which a knowledge file is checked against a task."""

    feature_hash: str
    """Fingerprint of all settings that define these features."""
    feature_names: tuple[str, ...]
    """One per dimension of a condition."""
