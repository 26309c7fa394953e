"""Texts for features."""

import pytest

from hal.robot_settings import load_robot
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.sensor_words import infrared_law, words_for

INFRARED = load_robot().infrared
WORDS = words_for(INFRARED)


@pytest.mark.parametrize("distance_m", [0.11, 0.55])
def test_reading_is_a_distance(distance_m: float) -> None:
    assert WORDS.reading("s9", INFRARED.counts_at(distance_m)) == f"{distance_m * 100:.0f} cm"


@pytest.mark.parametrize(("counts", "limit"), [(70, "60 cm"), (0, "60 cm"), (1023, "10 cm")])
def test_reading_out_of_range_names_the_limit(counts: int, limit: str) -> None:
    reading = WORDS.reading("maximum front", counts)
    assert limit in reading
    assert reading != limit


def test_infrared_law_inverts_the_settings() -> None:
    law = infrared_law(INFRARED)
    seen = [counts for counts in range(1024) if law.detects(counts)]
    assert [law.distance_m(each) for each in seen] == [INFRARED.distance_m(each) for each in seen]


def test_place_is_unique_for_each_feature() -> None:
    names = load_situation("basic", INFRARED.names).names
    places = [WORDS.place(name) for name in names]
    assert len(set(places)) == len(names)
    assert not any(sensor in place.split() for sensor in INFRARED.names for place in places)
