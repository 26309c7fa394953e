"""Frames of the analog channels, repacked only if a reading changed."""

from collections.abc import Sequence

from hal.codec import Codec
from hal.frame import Frame
from hal.kurt2_settings import Kurt2InfraredSettings
from hal.settings import SettingsError

_MESSAGES = ("ADC00_03", "ADC04_07", "ADC08_11", "BDC00_03", "BDC04_07", "BDC08_11", "BDC12_15")
"""Messages with sensor channels. ADC12_15 carries motor currents and the board's temperature."""


class AnalogFrames:
    """Newest frame of each analog message; channels without a sensor are grounded and read 0."""

    def __init__(self, infrared: Kurt2InfraredSettings, codec: Codec) -> None:
        """Find each sensor's frame and position. Raises SettingsError for a sensor on another channel."""
        self._messages = [codec.message(name) for name in _MESSAGES]
        self._values = [[0] * len(message.signals) for message in self._messages]
        where = {
            channel: (number, place)
            for number, message in enumerate(self._messages)
            for place, channel in enumerate(message.signals)
        }
        for sensor in infrared.sensors:
            if sensor.channel not in where:
                raise SettingsError(
                    f"infrared.sensors {sensor.name}: the simulated robot has no distance sensor on {sensor.channel}",
                    do=f"use one of: {', '.join(where)}",
                )
        self._places = [where[sensor.channel] for sensor in infrared.sensors]
        self.frames: list[Frame] = [
            message.pack(*values) for message, values in zip(self._messages, self._values, strict=True)
        ]
        self.with_sensor = sorted({number for number, _ in self._places})
        """Indices of the frames that carry a distance sensor."""
        self.without_sensor = [number for number in range(len(_MESSAGES)) if number not in self.with_sensor]

    def update(self, fresh: Sequence[int], counts: Sequence[int]) -> None:
        """Repack the frames of sensors with new readings.

        `fresh`: indexes of these sensors. `counts`: readings of all sensors, in counts, in the order of the sensor
        table.
        """
        changed = set()
        for sensor in fresh:
            number, place = self._places[sensor]
            self._values[number][place] = counts[sensor]
            changed.add(number)
        for number in changed:
            self.frames[number] = self._messages[number].pack(*self._values[number])
