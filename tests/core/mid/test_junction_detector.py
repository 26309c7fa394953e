"""Detection of junctions from simulated walls."""

import json
import math

import pytest

from config.settings import SettingsError
from kurt2rt.core.mid.junction_detector import JunctionDetector, JunctionDetectorSettings
from kurt2rt.core.mid.settings import load_mid_level
from tests.core.mid.walk import OPEN_M, ROBOT, STREET_M, Walk

SETTINGS = load_mid_level("turns").junctions


@pytest.mark.parametrize(("left_m", "right_m"), [(OPEN_M, STREET_M), (STREET_M, OPEN_M)])
def test_detector_side_street_straight(left_m: float, right_m: float) -> None:
    (event,) = Walk().street().go(0.8, left_m, right_m).street().passed
    assert event.name == "straight"
    assert (event.left_open, event.right_open) == (left_m == OPEN_M, right_m == OPEN_M)


@pytest.mark.parametrize(("turn_deg", "name"), [(90.0, "left"), (-90.0, "right"), (180.0, "back"), (-180.0, "back")])
def test_detector_turns_in_quarters_with_open_side(turn_deg: float, name: str) -> None:
    walk = Walk().street().go(0.4, OPEN_M, STREET_M, turn_deg=0.3 * turn_deg)
    # By now it looks away from the wall on its right, along which it came.
    (event,) = walk.go(0.4, OPEN_M, OPEN_M, turn_deg=0.7 * turn_deg).street().passed
    assert event.name == name
    assert event.turn_rad == pytest.approx(math.radians(turn_deg), abs=0.02)
    assert event.left_open
    assert event.right_open == (turn_deg == -90.0)


def test_detector_look_in_and_back_is_no_junction() -> None:
    walk = Walk().street().go(0.3, OPEN_M, OPEN_M).go(-0.3, OPEN_M, OPEN_M).go(-0.3)
    assert walk.told == []
    assert walk.street().go(0.8, OPEN_M, OPEN_M).street().told == ["straight"]


@pytest.mark.parametrize(
    ("changes", "told"),
    [({"left": ["s1", "s99"]}, "junctions: .* s99;"), ({"right": ["s6", "s5"]}, "junctions: s6 .*s5;")],
)
def test_detector_unknown_sensors_are_refused(changes: dict[str, object], told: str) -> None:
    content = json.dumps(SETTINGS.model_dump(mode="json") | changes)
    with pytest.raises(SettingsError, match=told):
        JunctionDetector(JunctionDetectorSettings.model_validate_json(content), ROBOT)
