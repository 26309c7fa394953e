"""Numbers of chance for the simulation, drawn in blocks since single draws cost a microsecond each."""

import numpy as np

_BLOCK = 2048


class Noise:
    """One stream of numbers of chance; the same seed gives the same stream in every process."""

    def __init__(self, seed: int, stream: str) -> None:
        """Streams of one seed are independent, so that a change in one part does not disturb another part's draws."""
        self._generator = np.random.Generator(np.random.PCG64([seed, *stream.encode()]))
        self._block: list[float] = []
        self._used = 0
        self._fractions: list[float] = []
        self.drawn = 0
        """Numbers given out so far; with the seed it is the whole state of the stream."""

    def normal(self) -> float:
        """Next number of mean 0 and standard deviation 1."""
        if self._used == len(self._block):
            self._block = self._generator.standard_normal(_BLOCK).tolist()
            self._used = 0
        self._used += 1
        self.drawn += 1
        return self._block[self._used - 1]

    def fraction(self) -> float:
        """Next number from 0 up to, but not including, 1, all alike in chance."""
        if not self._fractions:
            self._fractions = self._generator.random(_BLOCK).tolist()
        self.drawn += 1
        return self._fractions.pop()

    def uniform(self, count: int) -> list[float]:
        """Numbers in -1 to 1, for what is fixed once when the robot is built."""
        return [float(value) for value in self._generator.uniform(-1.0, 1.0, count)]
