"""Texts for features."""

import pytest

from hal.robot_settings import load_robot
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.sensor_words import words_for

INFRARED = load_robot().infrared
WORDS = words_for(INFRARED)


@pytest.mark.parametrize(("counts", "limit"), [(70, "60 cm"), (0, "60 cm"), (1023, "10 cm")])
def test_reading_out_of_range_names_the_limit(counts: int, limit: str) -> None:
    reading = WORDS.reading("maximum front", counts)
    assert limit in reading
    assert reading != limit


def test_place_is_unique_for_each_feature() -> None:
    names = load_situation("basic", INFRARED.names).names
    places = [WORDS.place(name) for name in names]
    assert len(set(places)) == len(names)
    assert not any(sensor in place.split() for sensor in INFRARED.names for place in places)
