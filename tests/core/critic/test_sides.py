"""Sides of a robot by the headings of its sensors."""

import math

import pytest

from hal.robot_settings import load_robot
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.critic.sides import critic_of, sides_of


def test_critic_of_kurt2_is_the_shipped_one() -> None:
    assert critic_of("basic", load_robot()) == load_critic("basic")


def test_sides_of_kurt2_look_where_the_shipped_critic_says() -> None:
    shipped, found = load_critic("basic").perception.sensors, sides_of(load_robot().infrared)
    for side in ("left", "right", "front", "rear", "ahead_left", "ahead_right"):
        assert set(getattr(found, side)) == set(getattr(shipped, side)), side


def test_sides_without_a_sensor_take_the_nearest_headings() -> None:
    sides = sides_of(load_robot("school").infrared)
    assert set(sides.front) == {"p1", "p2", "p3"}
    assert (sides.ahead_left, sides.ahead_right) == (("p0",), ("p4",))
    assert set(sides.left) == {"p0", "p1"}
    assert set(sides.rear) == {"p5", "p6"}


@pytest.mark.parametrize("robot", ["school", "turtlebot"])
def test_critic_of_each_robot_fits_its_sensors(robot: str) -> None:
    settings = load_robot(robot)
    critic = critic_of("basic", settings)
    assert AppraisalPerception(critic, settings)._left_baseline_m == math.inf
    assert critic.feature_hash != load_critic("basic").feature_hash


def test_critic_with_own_settings_is_taken_as_it_is() -> None:
    own = load_critic("basic")
    assert critic_of(own, load_robot("school")) is own
