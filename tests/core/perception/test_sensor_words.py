"""Texts for features."""

from hal.robot_settings import load_robot
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.sensor_words import words_for

INFRARED = load_robot().infrared
WORDS = words_for(INFRARED)


def test_place_is_unique_for_each_feature() -> None:
    names = load_situation("basic", INFRARED.names).names
    places = [WORDS.place(name) for name in names]
    assert len(set(places)) == len(names)
    assert not any(sensor in place.split() for sensor in INFRARED.names for place in places)
