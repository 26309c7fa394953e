"""Mid-level situation of the paper (section VI.B.2): a history of symbols."""

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.situation import MidSituation, MidSituationSettings
from kurt2rt.core.mid.symbols.source import NONE, AnySymbolSettings, SymbolSource, Transitions
from kurt2rt.core.rla.space import Metric


class HistorySettings(MidSituationSettings):
    """Settings of a history of symbols."""

    symbols: AnySymbolSettings
    length: Annotated[int, Field(ge=1, le=100)]
    """Number of symbols."""
    distance: Literal["hamming", "edit"]
    """hamming: number of different places; edit: number of insertions, deletions and changes."""

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the symbols, newest first."""
        return tuple(f"symbol {place}" for place in range(1, self.length + 1))

    @property
    def metric(self) -> Metric:
        """Metric of symbols."""
        return self.distance

    def describe(self, vector: Sequence[float] | NDArray[np.float64]) -> tuple[str, ...]:
        """Return the symbols of a situation (d,) by name, newest first."""
        named = dict(enumerate(("", *self.symbols.names)))
        return tuple(named.get(int(symbol), str(int(symbol))) for symbol in vector)

    def build(
        self,
        detector: JunctionDetector,
        robot: RobotSettings,  # noqa: ARG002 - used by the detector
        transitions: Transitions,
    ) -> MidSituation:
        """Return an empty history of symbols. `transitions`: (RLA id, follow-up id) -> count so far."""
        return SymbolHistory(self, self.symbols.build(transitions), detector)


class SymbolHistory:
    """Mid-level situation of the last symbols, newest first; NONE in unused places."""

    def __init__(self, settings: HistorySettings, source: SymbolSource, detector: JunctionDetector) -> None:
        self.features = settings.features
        self.dimensions = settings.length
        self.vector: NDArray[np.float64] = np.full(settings.length, float(NONE))
        self.passed: JunctionEvent | None = None
        self._source = source
        self._detector = detector

    def perceive(self, readings: SensorReadings, before: Decision) -> bool:
        """Process one tick and return whether there is a new symbol. `before`: decision of the last tick."""
        self.passed = self._detector.perceive(readings)
        symbol = self._source.perceive(before, self._detector, self.passed)
        if symbol == NONE:
            return False
        vector = np.empty_like(self.vector)
        vector[0] = symbol
        vector[1:] = self.vector[:-1]
        self.vector = vector
        return True

    def restart(self) -> None:
        """Remove all symbols."""
        self._detector.restart()
        self._source.restart()
        self.passed = None
        self.vector = np.full(self.dimensions, float(NONE))
