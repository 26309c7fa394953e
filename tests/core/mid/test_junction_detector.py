"""Detection of junctions from simulated walls."""

import json
import math

import pytest

from hal.settings import SettingsError
from kurt2rt.core.mid.junction_detector import JunctionDetector, JunctionDetectorSettings
from kurt2rt.core.mid.settings import load_mid_level
from tests.core.mid.walk import OPEN_M, ROBOT, STREET_M, Walk

SETTINGS = load_mid_level("turns").junctions


def test_detector_crossing_straight() -> None:
    walk = Walk().street().go(0.8, OPEN_M, OPEN_M)
    assert walk.told == []  # not before the robot is sure of the next street
    walk.street(0.1)
    assert walk.told == []
    walk.street(0.1)
    (event,) = walk.passed
    assert (event.name, event.quarters, event.left_open, event.right_open) == ("straight", 0, True, True)
    assert event.turn_rad == pytest.approx(0.0, abs=0.01)
    assert event.way_m == pytest.approx(0.8 + SETTINGS.street_over_m, abs=0.02)
    assert walk.street().told == ["straight"]


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


def test_detector_turn_on_the_spot() -> None:
    walk = Walk().street().go(0.4, OPEN_M, STREET_M).go(0.0, OPEN_M, OPEN_M, turn_deg=88.0)
    assert walk.go(0.4, STREET_M, OPEN_M).street().told == ["left"]


def test_detector_wobble_is_no_turn() -> None:
    askew = Walk().street().go(0.3, turn_deg=18.0).go(0.2, askew_deg=18.0)
    askew.go(0.7, OPEN_M, OPEN_M, turn_deg=54.0)
    (event,) = askew.go(0.3, askew_deg=-18.0).passed
    assert event.name == "left"
    assert event.turn_rad == pytest.approx(math.radians(90.0), abs=math.radians(6.0))


def test_detector_unparallel_walls_delay_the_event() -> None:
    walk = Walk().street().go(0.5, OPEN_M, OPEN_M, turn_deg=60.0).go(0.4, 0.25, 0.25, askew_deg=25.0)
    assert walk.told == []
    assert walk.go(0.1, OPEN_M, OPEN_M, turn_deg=30.0).street().told == ["left"]


def test_detector_standstill_changes_nothing() -> None:
    walk = Walk().street().go(0.0, OPEN_M, OPEN_M).street()
    assert walk.told == []
    assert walk.go(0.8, OPEN_M, OPEN_M).go(0.0).told == []
    assert walk.street().told == ["straight"]


@pytest.mark.parametrize("gap_m", [0.03, 0.1, 0.3])
def test_detector_narrow_gap_is_no_junction(gap_m: float) -> None:
    assert Walk().street().go(gap_m, OPEN_M, STREET_M).street().told == []


def test_detector_look_in_and_back_is_no_junction() -> None:
    walk = Walk().street().go(0.3, OPEN_M, OPEN_M).go(-0.3, OPEN_M, OPEN_M).go(-0.3)
    assert walk.told == []
    assert walk.street().go(0.8, OPEN_M, OPEN_M).street().told == ["straight"]


def test_detector_momentary_walls_do_not_end_a_junction() -> None:
    walk = Walk().street().go(0.4, OPEN_M, OPEN_M).go(0.08).go(0.4, OPEN_M, OPEN_M)
    assert walk.told == []
    assert walk.street().told == ["straight"]


def test_detector_turn_back_in_street_is_back() -> None:
    walk = Walk().street().go(0.0, OPEN_M, OPEN_M, turn_deg=180.0)
    assert walk.told == []
    (event,) = walk.street().passed
    assert (event.name, event.left_open, event.right_open) == ("back", False, False)
    assert walk.go(0.8, OPEN_M, OPEN_M).street().told == ["back", "straight"]


def test_detector_restart_has_no_past() -> None:
    walk = Walk().street().go(0.5, OPEN_M, OPEN_M)
    walk.detector.restart()
    walk.go(0.5, OPEN_M, OPEN_M, turn_deg=90.0).street()
    assert walk.told == []
    assert walk.go(0.8, OPEN_M, OPEN_M).street().told == ["straight"]


def test_detector_tolerates_ten_percent_turn_error() -> None:
    walk = Walk().street()
    for turn_deg in (99.0, 5.0, -99.0, 99.0, 198.0):
        walk.go(0.7, OPEN_M, OPEN_M, turn_deg=turn_deg).street(1.0)
    assert walk.told == ["left", "straight", "right", "left", "back"]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"left": ["s1", "s99"]}, "junctions: .* s99;"),
        ({"right": ["s6", "s5"]}, "junctions: s6 .*s5;"),
    ],
)
def test_detector_unknown_sensors_are_refused(changes: dict[str, object], told: str) -> None:
    content = json.dumps(SETTINGS.model_dump(mode="json") | changes)
    with pytest.raises(SettingsError, match=told):
        JunctionDetector(JunctionDetectorSettings.model_validate_json(content), ROBOT)
