"""Texts for features."""

import pytest

from hal.robot_settings import load_robot
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.sensor_words import NO_WORDS, infrared_law, words_for

INFRARED = load_robot().infrared
WORDS = words_for(INFRARED)


@pytest.mark.parametrize(
    ("feature", "place"),
    [
        ("s9", "front left"),
        ("s9 (10 s average)", "front left (10 s average)"),
        ("maximum front", "nearest in front"),
        ("minimum rear (10 s average)", "farthest behind (10 s average)"),
        ("orientation left s2>s1", "left back nearer than left front"),
        ("wheel speed left", "wheel speed left"),
        ("junction", "junction"),
    ],
)
def test_place_is_named_by_its_sensors(feature: str, place: str) -> None:
    assert WORDS.place(feature) == place


@pytest.mark.parametrize("distance_m", [0.11, 0.13, 0.25, 0.40, 0.55])
def test_reading_is_a_distance(distance_m: float) -> None:
    assert WORDS.reading("s9", INFRARED.counts_at(distance_m)) == f"{distance_m * 100:.0f} cm"


@pytest.mark.parametrize(
    ("counts", "text"), [(70, "nothing within 60 cm"), (0, "nothing within 60 cm"), (1023, "10 cm or less")]
)
def test_reading_out_of_range_says_so(counts: int, text: str) -> None:
    assert WORDS.reading("maximum front", counts) == text


def test_reading_other_feature_is_a_number() -> None:
    assert WORDS.difference("wheel speed left", 30.0, 0.25) == "wheel speed left: 30, was 0.25"
    assert NO_WORDS.difference("maximum front", 300.0, 20.0) == "maximum front: 300, was 20"


def test_infrared_law_inverts_the_settings() -> None:
    law = infrared_law(INFRARED)
    seen = [counts for counts in range(1024) if law.detects(counts)]
    assert [law.distance_m(each) for each in seen] == [INFRARED.distance_m(each) for each in seen]


def test_place_is_unique_for_each_feature() -> None:
    names = load_situation("basic", INFRARED.names).names
    places = [WORDS.place(name) for name in names]
    assert len(set(places)) == len(names)
    assert not any(sensor in place.split() for sensor in INFRARED.names for place in places)
