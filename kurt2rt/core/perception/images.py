"""Images of a robot's situations and actions: in a mirror, and in a place of another width."""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from behaviors.behaviour import Behaviour, HasSetPoints
from config.settings import SettingsError
from hal.robot_settings import InfraredSettings
from kurt2rt.core.perception.definition import Reading, SituationDefinition
from kurt2rt.core.perception.perception import compile_features
from kurt2rt.core.perception.sensor_words import infrared_law
from kurt2rt.core.rla.image import Change, Image

_SIDES = {"left": "right", "right": "left"}
_DECIMALS = 6
"""Decimals of metres and degrees to which places of sensors are compared."""


def build_images(
    definition: SituationDefinition,
    infrared: InfraredSettings,
    repertoire: Mapping[str, Behaviour],
    behaviours: Iterable[str],
    *,
    mirrored: bool,
    widths: Iterable[float],
) -> tuple[Image, ...]:
    """Return the images in which each RLA of a task answers: in a mirror, at other widths, and at these in a mirror.

    `widths`: factors of the distances. Raises config.settings.SettingsError: a sensor, a feature or an action has no
    image.
    """
    wider = tuple(_at_width(factor, definition, infrared) for factor in widths)
    if not mirrored:
        return wider
    mirror = build_mirror(definition, infrared, repertoire, behaviours)
    return mirror, *wider, *(mirror.then(each) for each in wider)


def build_mirror(
    definition: SituationDefinition,
    infrared: InfraredSettings,
    repertoire: Mapping[str, Behaviour],
    behaviours: Iterable[str],
) -> Image:
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
    exchanged = np.concatenate((recent, recent + len(recent)))

    def exchange(situation: NDArray[np.float64]) -> NDArray[np.float64]:
        return situation[exchanged]

    return Image("mirrored", exchange, exchange, False, names)


def _at_width(factor: float, definition: SituationDefinition, infrared: InfraredSettings) -> Image:
    """Return the view of a place in which all that a sensor sees is `factor` times as far from it.

    Actions stay as they are. Raises config.settings.SettingsError if a sensor's reading is no feature.
    """
    name = f"x{factor:g}"
    return Image(name, _farther(factor, definition, infrared), _farther(1.0 / factor, definition, infrared), True, {})


def _farther(factor: float, definition: SituationDefinition, infrared: InfraredSettings) -> Change:
    """Return the function from a situation to the one of `factor` times the distances, by the law of the sensors.

    Features of readings are computed again; others, and all averages, stay as they are.
    """
    features, law = definition.features, infrared_law(infrared)
    reading = {each.sensor: index for index, each in enumerate(features) if isinstance(each, Reading)}
    missing = [sensor for sensor in infrared.names if sensor not in reading]
    if missing:
        raise SettingsError(
            f"learning.widths: situation {definition.name} lacks the reading of sensor {missing[0]}",
            do="leave learning.widths out, or add the reading",
        )
    places = [index for index, feature in enumerate(features) if feature.sensors_used]
    compute = compile_features((features[index] for index in places), infrared.names)

    def farther(situation: NDArray[np.float64]) -> NDArray[np.float64]:
        counts = [situation.item(reading[sensor]) for sensor in infrared.names]
        seen = [
            round(infrared.counts_at(max(infrared.near_m, law.distance_m(each) * factor)))
            if law.detects(each)
            else each
            for each in counts
        ]
        image = situation.copy()
        image[places] = compute(None, None, *seen)
        return image

    return farther


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
