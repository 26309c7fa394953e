"""Settings of critics, and sides of a robot by the headings of its sensors."""

import json
import math
from typing import Any

import pytest

from config.settings import SettingsError
from hal.robot import SensorReadings
from hal.robot_settings import load_robot
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.critic.settings import CIRCLING, GRAZING, NAMES, CriticSettings, critic_of, load_critic

CONTENT: dict[str, Any] = load_critic().model_dump(mode="json")


def changed(section: str, **values: object) -> dict[str, Any]:
    return CONTENT | {section: CONTENT[section] | values}


def checked(content: dict[str, Any]) -> CriticSettings:
    return CriticSettings.model_validate_json(json.dumps(content))


def test_circling_feature_needs_its_settings() -> None:
    content = json.loads(load_critic("eight_with_memory").model_dump_json())
    assert checked(content).names == (*NAMES, CIRCLING, GRAZING)
    del content["perception"]["circling"]
    with pytest.raises(ValueError, match=r"weights\.circling .*perception\.circling"):
        checked(content)
    del content["learning"]["weights"]["circling"]
    assert checked(content).names == (*NAMES, GRAZING)
    assert checked(content).feature_hash != load_critic("eight_with_memory").feature_hash


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (changed("learning", weights={"left_m": 0.0}), "weighs 0"),
        (changed("agreement", least=31), r"\bleast\b.* 31, .*window \(30\)"),
        (CONTENT | {"appraisals": CONTENT["appraisals"][:2]}, r"-1 .*\b1\b"),
        (CONTENT | {"appraisals": CONTENT["appraisals"] * 2}, "bad, good, neutral"),
    ],
)
def test_critic_settings_invalid_values_are_refused(content: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        checked(content)


@pytest.mark.parametrize("robot", ["school", "turtlebot"])
def test_critic_of_each_robot_fits_its_sensors(robot: str) -> None:
    settings = load_robot(robot)
    critic = critic_of("basic", settings)
    assert AppraisalPerception(critic, settings)._left_baseline_m == math.inf
    assert critic.feature_hash != load_critic("basic").feature_hash


def in_sectors(**changed: object) -> CriticSettings:
    """Return the shipped critic with sectors, of the given ones or 45 degrees round each side, in place of sensors."""
    headings = {"front": 0, "ahead_left": 45, "left": 90, "rear": 180, "right": -90, "ahead_right": -45, "wall": 90}
    content = load_critic("basic").model_dump(mode="json")
    sectors = {
        side: {"from_deg": deg - 22, "to_deg": deg + 22 if deg + 22 <= 180 else deg - 338}
        for side, deg in headings.items()
    }
    content["perception"] |= {"sensors": None, "sectors": {**sectors, **changed}}
    return CriticSettings.model_validate_json(json.dumps(content))


def test_sector_without_a_sensor_is_refused_by_its_side() -> None:
    with pytest.raises(SettingsError, match=r"critic: left: .*from 68 to 112 degrees.*-40, -20, 0"):
        critic_of(in_sectors(), load_robot("school"))


def test_sensors_and_sectors_together_are_refused() -> None:
    content = in_sectors().model_dump(mode="json")
    content["perception"]["sensors"] = load_critic("basic").model_dump(mode="json")["perception"]["sensors"]
    with pytest.raises(ValueError, match=r"sensors and sectors .* leave one out"):
        CriticSettings.model_validate_json(json.dumps(content))


@pytest.mark.parametrize("robot", ["turtlebot"])
def test_shipped_critic_of_a_robot_sees_each_side(robot: str) -> None:
    """An object that one side alone sees is nearer there than on the opposite side."""
    settings = load_robot(robot)
    infrared, perception = settings.infrared, AppraisalPerception(load_critic(f"{robot}/basic"), settings)
    for side, opposite in (("left_m", "right_m"), ("ahead_right_m", "ahead_left_m"), ("front_m", "rear_m")):
        heading_deg = {"left_m": 50.0, "ahead_right_m": -40.0, "front_m": 0.0}[side]
        nearest = min(infrared.sensors, key=lambda each: abs(each.heading_deg - heading_deg))
        counts = [round(infrared.counts_at(infrared.near_m)) if each is nearest else 0 for each in infrared.sensors]
        features = perception.perceive(SensorReadings(0.0, tuple(counts), 0.0, 0, 0, 0.0, 0, 0.0), driving=True)
        assert getattr(features, side) == pytest.approx(infrared.near_m, abs=0.01)
        assert getattr(features, opposite) == infrared.far_m
        assert features.left_angle_rad == 0.0
