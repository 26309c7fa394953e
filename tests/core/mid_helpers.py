"""A mid level over a situation that a test changes as it likes, over a basic level of one number."""

import numpy as np
from numpy.typing import NDArray

from hal.robot import SensorReadings
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause, JunctionEvent, MidDecision
from kurt2rt.core.layer_stack import LayerStack
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import RlaCreated, TeachingEvent
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.helpers import MINIMUM_TICKS, RADIUS, Counted, sensed, situation
from tests.core.rla.helpers import created

BEHAVIOURS = ("straight_on", "turn_left", "turn_right")
STRAIGHT = JunctionEvent(0, True, True, 0.0, 0.9)


class Symbols:
    """A situation of three symbols, and junctions that are passed when a test says so."""

    features = ("symbol 1", "symbol 2", "symbol 3")
    dimensions = 3

    def __init__(self) -> None:
        self.vector: NDArray[np.float64] = np.zeros(3)
        self.passed: JunctionEvent | None = None
        self.next: float | None = None
        self.looked = 0

    def perceive(self, readings: SensorReadings) -> bool:  # noqa: ARG002 - it looks at nothing
        symbol, self.next = self.next, None
        self.passed = None if symbol is None else STRAIGHT
        if symbol is None:
            return False
        self.vector = np.array([symbol, *self.vector[:-1]])
        return True

    def restart(self) -> None:
        self.vector = np.zeros(3)
        self.passed = None


class SmallStack:
    """A stack whose basic level has one RLA per behaviour at place 0: actions a, b and c."""

    def __init__(self, *events: TeachingEvent, radius: float = 1.0) -> None:
        self.system = RlaSystem(1, RADIUS, others={MID: Space(3, radius, None, "hamming")})
        for number, (behaviour, action) in enumerate(zip(BEHAVIOURS, "abc", strict=True), start=1):
            self.system.apply(created(number, (0.0,), action, behaviour=behaviour))
        self.system.apply_all(events)
        self.actions = {name: Counted() for name in "abc"}
        self.wanted = ActiveBehaviour(BEHAVIOURS)
        self.symbols = Symbols()
        self.mid = MidLevel(self.system, self.symbols, load_mid_level("turns"), self.wanted)
        basic = BasicLevel(self.system, self.actions, MINIMUM_TICKS, self.wanted)
        self.stack = LayerStack(basic, self.mid)

    def tick(
        self, symbol: float | None = None, stand_because: DecisionCause | None = None, place: float = 0.0
    ) -> Decision:
        """One tick; with a symbol a junction was passed in it."""
        self.symbols.next = symbol
        return self.stack.decide(situation(place), sensed(), stand_because)

    def commanded(self, symbol: float | None = None) -> MidDecision:
        """Run one tick and return the decision of the mid level."""
        mid = self.tick(symbol).mid
        assert mid is not None
        return mid


def taught(rla_id: int, condition: tuple[float, ...], behaviour: str) -> RlaCreated:
    return created(rla_id, condition, behaviour, level=MID)
