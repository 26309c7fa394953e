import pytest

from behaviors.metrics.way import Way
from simbridge.contracts.simulation import Pose
from tests.behaviors.metrics.paths import follow, put


def test_way_is_counted_in_metres_wherever_it_leads() -> None:
    way = Way(Pose(0.0, 0.0, 0.0), "")
    put(way, (1.0, 1.0), 0.0)
    follow(way, [(1.0, 1.0), (3.0, 1.0), (3.0, 2.5), (1.0, 1.0)])
    assert way.progress == pytest.approx(2.0 + 1.5 + 2.5)
    assert (way.unit, way.findings, way.needs_reset, way.behaviour) == ("m", {}, False, "")


def test_neither_a_turn_on_the_spot_nor_a_hand_makes_way() -> None:
    way = Way(Pose(0.0, 0.0, 0.0), "")
    for tenth in range(60):
        way.update(Pose(0.0, 0.0, tenth / 10))
    put(way, (5.0, 5.0), 0.0)
    assert way.progress == 0.0
