"""Mirror images of sensors, features and actions are found by their places and names."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
import pytest

from behaviors.motor_primitive import MotorPrimitive
from config.settings import SettingsError
from hal.robot import WheelSpeeds
from hal.robot_settings import InfraredSettings, load_robot
from kurt2rt.core.perception.definition import SituationDefinition, load_situation
from kurt2rt.core.perception.mirror_image import build_mirror
from kurt2rt.core.rla.mirror import Mirror
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.task_repertoire import load_task_repertoire

ROBOT = load_robot("kurt2")
BASIC_SITUATION = load_situation("basic", ROBOT.infrared.names)
REPERTOIRE = load_task_repertoire(load_task("eight"), ROBOT)


def mirror_of(
    definition: SituationDefinition = BASIC_SITUATION,
    infrared: InfraredSettings = ROBOT.infrared,
    actions: Mapping[str, float] = MappingProxyType({}),
) -> Mirror:
    more = {name: MotorPrimitive(WheelSpeeds(left_m_s, 0.3)) for name, left_m_s in actions.items()}
    return build_mirror(definition, infrared, {**REPERTOIRE, **more}, ("straight_on", "turn_left", "turn_right"))


def test_two_images_are_the_situation_again() -> None:
    mirror = mirror_of()
    names = BASIC_SITUATION.names
    images = dict(zip(names, (names[place] for place in mirror.order), strict=True))
    assert images["s1"] == "s5"
    assert images["s9"] == "s10"
    assert images["s11"] == "s11"
    assert images["maximum left"] == "maximum right"
    assert images["minimum front"] == "minimum front"
    assert images["orientation left s1>s2"] == "orientation right s5>s6"
    assert images["orientation front s9>s10"] == "orientation front s10>s9"
    assert images["wheel speed left"] == "wheel speed right"
    assert images["s15 (10 s average)"] == "s16 (10 s average)"
    assert (mirror.order[mirror.order] == np.arange(len(names))).all()


def test_actions_and_behaviours_are_paired_by_their_names() -> None:
    mirror = mirror_of()
    assert mirror.name("along_left_wall") == "along_right_wall"
    assert mirror.name("turn_right") == "turn_left"
    assert mirror.name("flee") == "flee"
    assert all(mirror.name(mirror.name(name)) == name for name in REPERTOIRE)


def test_a_sensor_without_an_image_is_refused() -> None:
    sensors = [each for each in ROBOT.infrared.sensors if each.name != "s5"]
    with pytest.raises(SettingsError, match="sensor s1 has no mirror image"):
        mirror_of(infrared=ROBOT.infrared.model_copy(update={"sensors": tuple(sensors)}))


def test_a_feature_without_an_image_is_refused() -> None:
    features = tuple(each for each in BASIC_SITUATION.features if each.name != "maximum right")
    with pytest.raises(SettingsError, match="feature 'maximum left' of situation basic has no mirror image"):
        mirror_of(BASIC_SITUATION.model_copy(update={"features": features}))


@pytest.mark.parametrize(
    ("actions", "problem"),
    [
        ({"lean_left": 0.2}, "lean_left"),
        ({"lean_left": 0.2, "lean_right": 0.1}, "action lean_left"),
        ({"drift": 0.2}, "action drift"),
    ],
)
def test_an_action_without_an_image_is_refused(actions: dict[str, float], problem: str) -> None:
    with pytest.raises(SettingsError, match=f"{problem} has no mirror image"):
        mirror_of(actions=actions)
