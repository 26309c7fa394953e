"""Layer that failed at a junction: symbols, mid level or basic level."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from behaviors.metrics.route import FixedRoute, Passage
from behaviors.metrics.task_metric import WayAhead
from hal.robot import STANDSTILL, GuardResult
from kurt2rt.core.decision.decision import Decision, DecisionCause, JunctionEvent, MidDecision
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.rla import BASIC, MID
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.route.route_monitor import Layer, RouteMonitor
from tests.behaviors.metrics.test_route import a_route, streets
from tests.core.helpers import sensed

NAMES = {0: "straight_on", 1: "turn_left", -1: "turn_right"}


class ARoute(FixedRoute):
    """Stands where it is told to stand."""

    def __init__(self) -> None:
        super().__init__(streets(), a_route(), tuple(NAMES.values()))
        self.inside = False

    @property
    def ahead(self) -> WayAhead:
        return WayAhead(len(self.passages), self.inside, "straight_on", "straight_on")


@dataclass
class Watched:
    """A drive, junction by junction."""

    watching: RouteMonitor = field(default_factory=RouteMonitor)
    metric: ARoute = field(default_factory=ARoute)
    tick: int = 0

    def look(self, wanted: int, event: int | None = None, *, asks: bool = False, mid: bool = True) -> None:
        self.tick += 1
        noticed = None if event is None else JunctionEvent(event, True, False, 0.0, 1.0)
        behaviour = NAMES[wanted]
        decided = MidDecision(behaviour, 1, None, asks, False, noticed) if mid else None
        cause = DecisionCause.UNKNOWN if asks else DecisionCause.RLA
        decision = Decision(STANDSTILL, cause, None, None, None, asks_at=MID if asks else BASIC, mid=decided)
        situation = Situation(np.zeros(1), history_frozen=False)
        grant = GuardResult(STANDSTILL, (), latched=False)
        record = TickRecord(self.tick, 0.01 * self.tick, sensed(100), situation, decision, grant, (), behaviour)
        self.watching.on_tick(record, self.metric)

    def junction(
        self, right: int, wanted: int, taken: int | None, noticed: int | None, within: int | None = None
    ) -> None:
        """Drive through one junction, which is detected after it; `within`: the direction wanted inside it."""
        self.look(wanted)
        self.metric.inside = True
        self.look(wanted)
        if within is not None:
            self.look(within)
        self.metric.inside = False
        self.metric.passages.append(Passage(0, right, taken, 1.0, 2.0))
        self.look(wanted if within is None else within)
        if noticed is not None:
            self.look(wanted, noticed)

    @property
    def blamed(self) -> list[Layer]:
        return [wrong.layer for wrong in self.watching.wrong]


@pytest.mark.parametrize(
    ("junction", "layers"), [((1, 1, 1, 1), []), ((1, -1, -1, -1), ["mid"]), ((1, 1, 0, 0), ["basic"])]
)
def test_wrong_choice_is_mid_and_wrong_drive_is_basic(junction: tuple[int, int, int, int], layers: list[Layer]) -> None:
    watched = Watched()
    watched.junction(0, 0, 0, 0)
    watched.junction(*junction)
    assert watched.blamed == layers


def test_route_monitor_changed_command_is_symbols() -> None:
    watched = Watched()
    watched.junction(1, 1, -1, -1, within=-1)
    assert watched.blamed == ["symbols"]


def test_route_monitor_unknown_history_is_mid_stuck_is_basic() -> None:
    watched = Watched()
    watched.junction(0, 0, 0, 0)
    watched.look(0, asks=True)
    watched.metric.passages.append(Passage(1, 1, None, 1.0, 2.0))
    watched.watching.end()
    assert watched.blamed == ["mid"]
    watched = Watched()
    watched.look(1)
    watched.metric.passages.append(Passage(0, 1, None, 1.0, 2.0))
    watched.watching.end()
    assert watched.blamed == ["basic"]


def test_route_monitor_stuck_after_a_junction_is_basic() -> None:
    watched = Watched()
    for turn in (0, 1, -1) * 5:
        watched.junction(turn, turn, turn, turn)
    watched.junction(1, 1, 1, None)
    watched.metric.passages.append(Passage(1, 0, None, 1.0, 2.0))
    watched.watching.end()
    assert watched.blamed == ["basic"]


def test_without_a_mid_level_it_is_always_the_basic_one() -> None:
    watched = Watched()
    watched.look(0, mid=False)
    watched.metric.passages.append(Passage(0, 1, 0, 1.0, 2.0))
    watched.look(0, mid=False)
    assert watched.blamed == ["basic"]


def test_a_drive_that_never_began_has_nothing_to_blame() -> None:
    watching = RouteMonitor()
    watching.end()
    assert watching.wrong == []
