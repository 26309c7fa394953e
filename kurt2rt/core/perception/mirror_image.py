"""Mirror images of a robot's features and actions, from the places of its sensors and the names of its actions."""

from collections.abc import Iterable, Mapping

import numpy as np

from behaviors.behaviour import Behaviour, HasSetPoints
from config.settings import SettingsError
from hal.robot_settings import InfraredSettings
from kurt2rt.core.perception.definition import SituationDefinition
from kurt2rt.core.rla.mirror import Mirror

_SIDES = {"left": "right", "right": "left"}
_DECIMALS = 6
"""Decimals of metres and degrees to which places of sensors are compared."""


def build_mirror(
    definition: SituationDefinition,
    infrared: InfraredSettings,
    repertoire: Mapping[str, Behaviour],
    behaviours: Iterable[str],
) -> Mirror:
    """Return the exchange of left and right for a robot, a situation and a repertoire.

    Sensors are paired by their places, actions and behaviours by their names: turn_left is the image of turn_right, and
    an action without left or right in its name is its own image.

    Raises config.settings.SettingsError: a sensor, a feature or an action has no image.
    """
    sensors = _mirrored_sensors(infrared)
    identity = {name: name for name in (*sensors, *_SIDES)}
    place = {feature.measured(identity): index for index, feature in enumerate(definition.features)}
    order = []
    for feature in definition.features:
        image = place.get(feature.measured({**sensors, **_SIDES}))
        if image is None:
            raise _no_image(f"feature {feature.name!r} of situation {definition.name}")
        order.append(image)
    names = _mirrored_names((*repertoire, *behaviours))
    for name, action in repertoire.items():
        image_action = repertoire[names.get(name, name)]
        if isinstance(action, HasSetPoints) and isinstance(image_action, HasSetPoints):
            left_m_s, right_m_s = action.wheel_speeds
            if tuple(image_action.wheel_speeds) != (right_m_s, left_m_s):
                raise _no_image(f"action {name}")
    recent = np.array(order, dtype=np.intp)
    return Mirror(np.concatenate((recent, recent + len(recent))), names)


def _mirrored_sensors(infrared: InfraredSettings) -> dict[str, str]:
    """Return the name of the sensor in the mirror image of each sensor's place, by name."""
    at = {_place(each.x_m, each.y_m, each.heading_deg): each.name for each in infrared.sensors}
    images = {each.name: at.get(_place(each.x_m, -each.y_m, -each.heading_deg)) for each in infrared.sensors}
    return {name: _required(image, f"sensor {name}") for name, image in images.items()}


def _place(x_m: float, y_m: float, heading_deg: float) -> tuple[float, float, float]:
    return round(x_m, _DECIMALS), round(y_m, _DECIMALS), round(heading_deg % 360.0, _DECIMALS)


def _mirrored_names(names: Iterable[str]) -> dict[str, str]:
    """Return the image of each name that has left or right among its words."""
    known = tuple(names)
    images = {name: "_".join(_SIDES.get(word, word) for word in name.split("_")) for name in known}
    changed = {name: image for name, image in images.items() if name != image}
    return {name: _required(image if image in known else None, name) for name, image in changed.items()}


def _required(image: str | None, what: str) -> str:
    if image is None:
        raise _no_image(what)
    return image


def _no_image(what: str) -> SettingsError:
    return SettingsError(
        f"learning.mirrored: {what} has no mirror image", do="leave learning.mirrored out, or add what is missing"
    )
