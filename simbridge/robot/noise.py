"""Random numbers of the simulation, drawn in blocks because single draws cost 1 µs each."""

import copy

import numpy as np
from numpy.typing import NDArray

_BLOCK = 2048
_NONE: NDArray[np.float64] = np.zeros(0)


class Noise:
    """Stream of random numbers for one part of the simulation; equal seeds give equal numbers everywhere."""

    def __init__(self, seed: int, stream: str) -> None:
        """Open the named stream of a seed; streams are independent, so one part's draws never shift another's."""
        self._generator = np.random.Generator(np.random.PCG64([seed, *stream.encode()]))
        self._block: list[float] = []
        self._used = 0
        self._ahead: NDArray[np.float64] = _NONE
        """Numbers that follow those of the block."""
        self._fractions: list[float] = []
        self.drawn = 0
        """Numbers drawn so far; with the seed the whole state of the stream."""

    def __deepcopy__(self, memo: dict[int, object]) -> "Noise":
        # Numbers that lie ahead are replaced and never changed, so copies share them; copying each took 0.5 ms.
        twin = copy.copy(self)
        twin._generator, twin._fractions = copy.deepcopy(self._generator, memo), self._fractions.copy()
        return twin

    def normal(self) -> float:
        """Return the next standard normal number, dimensionless."""
        if self._used == len(self._block):
            ahead = self._ahead if len(self._ahead) else self._generator.standard_normal(_BLOCK)
            self._block, self._used, self._ahead = ahead.tolist(), 0, _NONE
        self._used += 1
        self.drawn += 1
        return self._block[self._used - 1]

    def next_normals(self, count: int) -> list[float]:
        """Return the next `count` standard normal numbers, as one call of `normal` for each would."""
        begin, end = self._used, self._used + count
        if end > len(self._block):
            return [self.normal() for _ in range(count)]
        self._used = end
        self.drawn += count
        return self._block[begin:end]

    def normals(self, count: int) -> NDArray[np.float64]:
        """Return the next `count` standard normal numbers, shape (count,), as one call of `normal` for each would."""
        numbers = np.empty(count)
        self.fill(numbers)
        return numbers

    def fill(self, numbers: NDArray[np.float64]) -> None:
        """Fill an array (count,) with the next standard normal numbers, as one call of `normal` for each would."""
        if self._used < len(self._block):
            self._ahead = np.concatenate((self._block[self._used :], self._ahead))
        self._block, self._used = [], 0
        self.drawn += len(numbers)
        begun = min(len(self._ahead), len(numbers))
        numbers[:begun], self._ahead = self._ahead[:begun], self._ahead[begun:]
        whole = begun + (len(numbers) - begun) // _BLOCK * _BLOCK
        self._generator.standard_normal(out=numbers[begun:whole])
        if whole < len(numbers):
            block = self._generator.standard_normal(_BLOCK)
            numbers[whole:], self._ahead = block[: len(numbers) - whole], block[len(numbers) - whole :]

    def fraction(self) -> float:
        """Return the next uniform number from 0 up to 1, 1 excluded."""
        if not self._fractions:
            self._fractions = self._generator.random(_BLOCK).tolist()
        self.drawn += 1
        return self._fractions.pop()

    def uniform(self, count: int) -> list[float]:
        """Return `count` uniform numbers from -1 to 1, dimensionless, for constants of a robot."""
        return [float(value) for value in self._generator.uniform(-1.0, 1.0, count)]
