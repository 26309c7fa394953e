"""The mid level's situation as the paper has it (VI.B.2): the last differing symbols."""

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
    """A history of symbols."""

    symbols: AnySymbolSettings
    length: Annotated[int, Field(ge=1, le=100)]
    """How many symbols are remembered."""
    distance: Literal["hamming", "edit"]
    """hamming: in how many places two histories differ; edit: how many insertions, deletions and changes it takes."""

    @property
    def features(self) -> tuple[str, ...]:
        """The newest symbol first."""
        return tuple(f"symbol {place}" for place in range(1, self.length + 1))

    @property
    def metric(self) -> Metric:
        """Symbols are equal or not."""
        return self.distance

    def describe(self, vector: Sequence[float] | NDArray[np.float64]) -> tuple[str, ...]:
        """The newest symbol first."""
        named = dict(enumerate(("", *self.symbols.names)))
        return tuple(named.get(int(symbol), str(int(symbol))) for symbol in vector)

    def build(
        self,
        detector: JunctionDetector,
        robot: RobotSettings,  # noqa: ARG002 - the robot is its detector's matter
        transitions: Transitions,
    ) -> MidSituation:
        """The history, empty."""
        return SymbolHistory(self, self.symbols.build(transitions), detector)


class SymbolHistory:
    """The last symbols, newest first; NONE where there was none yet."""

    def __init__(self, settings: HistorySettings, source: SymbolSource, detector: JunctionDetector) -> None:
        self.features = settings.features
        self.dimensions = settings.length
        self.vector: NDArray[np.float64] = np.full(settings.length, float(NONE))
        self.passed: JunctionEvent | None = None
        self._source = source
        self._detector = detector

    def perceive(self, senses: SensorReadings, before: Decision) -> bool:
        """Take in one tick."""
        self.passed = self._detector.perceive(senses)
        symbol = self._source.perceive(before, self._detector, self.passed)
        if symbol == NONE:
            return False
        vector = np.empty_like(self.vector)
        vector[0] = symbol
        vector[1:] = self.vector[:-1]
        self.vector = vector
        return True

    def restart(self) -> None:
        """Forget all symbols."""
        self._detector.restart()
        self._source.restart()
        self.passed = None
        self.vector = np.full(self.dimensions, float(NONE))
