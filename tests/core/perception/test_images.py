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
from kurt2rt.core.perception.images import build_images
from kurt2rt.core.rla.image import Image
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.task_repertoire import load_task_repertoire

ROBOT = load_robot("kurt2")
BASIC_SITUATION = load_situation("basic", ROBOT.infrared.names)
REPERTOIRE = load_task_repertoire(load_task("eight"), ROBOT)


def images_at(widths: tuple[float, ...], definition: SituationDefinition = BASIC_SITUATION) -> tuple[Image, ...]:
    return build_images(definition, ROBOT.infrared, REPERTOIRE, ("",), mirrored=False, widths=widths)


def mirror_of(
    definition: SituationDefinition = BASIC_SITUATION,
    infrared: InfraredSettings = ROBOT.infrared,
    actions: Mapping[str, float] = MappingProxyType({}),
) -> Image:
    more = {name: MotorPrimitive(WheelSpeeds(left_m_s, 0.3)) for name, left_m_s in actions.items()}
    (mirror,) = build_images(
        definition,
        infrared,
        {**REPERTOIRE, **more},
        ("straight_on", "turn_left", "turn_right"),
        mirrored=True,
        widths=(),
    )
    return mirror


def test_two_images_are_the_situation_again() -> None:
    mirror = mirror_of()
    names = BASIC_SITUATION.names
    order = mirror.of_taught(np.arange(float(len(names)))).astype(int)
    images = dict(zip(names, (names[place] for place in order), strict=True))
    assert images["s1"] == "s5"
    assert images["s9"] == "s10"
    assert images["s11"] == "s11"
    assert images["maximum left"] == "maximum right"
    assert images["minimum front"] == "minimum front"
    assert images["orientation left s1>s2"] == "orientation right s5>s6"
    assert images["orientation front s9>s10"] == "orientation front s10>s9"
    assert images["wheel speed left"] == "wheel speed right"
    assert images["s15 (10 s average)"] == "s16 (10 s average)"
    assert (order[order] == np.arange(len(names))).all()
    assert mirror.as_taught is mirror.of_taught


def test_actions_and_behaviours_are_paired_by_their_names() -> None:
    mirror = mirror_of()
    assert mirror.name_of("along_left_wall") == "along_right_wall"
    assert mirror.name_of("turn_right") == "turn_left"
    assert mirror.name_of("flee") == "flee"
    assert all(mirror.name_of(mirror.name_of(name)) == name for name in REPERTOIRE)


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


def test_a_wider_place_is_seen_farther_by_the_law_of_sensors() -> None:
    infrared, names = ROBOT.infrared, BASIC_SITUATION.names
    (image,) = images_at((1.5,))
    situation = np.full(len(names), 200.0)
    for name, distance_m in (("s1", 0.2), ("s2", 0.3), ("s9", 0.5)):
        situation[names.index(name)] = infrared.counts_at(distance_m)
    situation[names.index("s10")] = infrared.floor_counts + 2.0
    seen = dict(zip(names, image.of_taught(situation).tolist(), strict=True))
    assert (seen["s1"], seen["s2"]) == (round(infrared.counts_at(0.3)), round(infrared.counts_at(0.45)))
    assert (seen["s9"], seen["s10"]) == (infrared.floor_counts, infrared.floor_counts + 2.0)
    assert seen["orientation left s1>s2"] == seen["s1"] - seen["s2"]
    assert seen["wheel speed left"] == seen["s1 (10 s average)"] == 200.0
    assert image.name == "x1.5"
    back = image.as_taught(image.of_taught(situation))[names.index("s1")]
    assert abs(back - infrared.counts_at(0.2)) < 3.0


def test_nearer_than_the_law_reaches_is_seen_at_its_end() -> None:
    (image,) = images_at((0.6,))
    situation = np.full(len(BASIC_SITUATION.names), ROBOT.infrared.counts_at(0.12))
    assert image.of_taught(situation)[0] == round(ROBOT.infrared.counts_at(ROBOT.infrared.near_m))


def test_each_width_is_mirrored_as_well() -> None:
    images = build_images(BASIC_SITUATION, ROBOT.infrared, REPERTOIRE, ("",), mirrored=True, widths=(1.2, 1.4))
    assert [each.name for each in images] == ["mirrored", "x1.2", "x1.4", "mirrored x1.2", "mirrored x1.4"]


def test_widths_need_the_reading_of_each_sensor() -> None:
    features = tuple(each for each in BASIC_SITUATION.features if each.name != "s3")
    with pytest.raises(SettingsError, match="situation basic lacks the reading of sensor s3"):
        images_at((1.2,), BASIC_SITUATION.model_copy(update={"features": features}))


def test_widths_leave_no_weight_to_averages() -> None:
    with pytest.raises(SettingsError, match="widths need history_weight 0"):
        load_task("streets", changes={"learning.history_weight": "0.1"})
