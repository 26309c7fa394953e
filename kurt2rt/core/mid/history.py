"""Mid-level situation of the paper (section VI.B.2): a history of symbols, the turns at passed junctions."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.decision import NAMES, JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.settings import MidSituation, MidSituationSettings
from kurt2rt.core.rla.condition import Metric

_NONE = 0.0
"""Symbol of an unused place."""
_SYMBOLS = {quarters: float(number) for number, quarters in enumerate(NAMES, start=1)}
_WORDS = {_NONE: "", **{_SYMBOLS[quarters]: name for quarters, name in NAMES.items()}}


class HistorySettings(MidSituationSettings):
    """Settings of mid-level situations that are the turns at the last junctions, a symbol each.

    Equal symbols in a row count too.
    """

    length: Annotated[int, Field(ge=1, le=100)]
    """Number of symbols."""

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the symbols, newest first."""
        return tuple(f"symbol {place}" for place in range(1, self.length + 1))

    @property
    def metric(self) -> Metric:
        """Metric of symbols: the number of places that differ."""
        return "hamming"

    def describe(self, vector: Sequence[float] | NDArray[np.float64]) -> tuple[str, ...]:
        """Return the symbols of a situation (d,) by name, newest first."""
        return tuple(_WORDS.get(symbol, f"{symbol:.0f}") for symbol in vector)

    def build(
        self,
        detector: JunctionDetector,
        robot: RobotSettings,  # noqa: ARG002 - used by the detector
    ) -> MidSituation:
        """Return an empty history of symbols."""
        return SymbolHistory(self, detector)


class SymbolHistory:
    """Mid-level situation of the turns at the last junctions as symbols, newest first; 0 in unused places."""

    def __init__(self, settings: HistorySettings, detector: JunctionDetector) -> None:
        self.features = settings.features
        self.dimensions = settings.length
        self.vector: NDArray[np.float64] = np.full(settings.length, _NONE)
        self.passed: JunctionEvent | None = None
        self._detector = detector

    def perceive(self, readings: SensorReadings) -> bool:
        """Process one tick; return whether a junction was passed, whose turn is the new first number of `vector`."""
        self.passed = self._detector.perceive(readings)
        if self.passed is None:
            return False
        vector = np.empty_like(self.vector)
        vector[0] = _SYMBOLS[self.passed.quarters]
        vector[1:] = self.vector[:-1]
        self.vector = vector
        return True

    def restart(self) -> None:
        """Remove all symbols, because the robot was put elsewhere."""
        self._detector.restart()
        self.passed = None
        self.vector = np.full(self.dimensions, _NONE)
