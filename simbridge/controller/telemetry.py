"""Schedule of the frames from the robot to the notebook, and the robot's end of the bus."""

from collections.abc import Callable, Sequence
from typing import Protocol

import can

from config.settings import SettingsError
from hal.codec import SIMULATED_HARDWARE_ID, Codec, MessageCodec
from hal.frame import Frame
from hal.kurt2_settings import Kurt2InfraredSettings, Kurt2Settings
from simbridge.robot.instruments import Instruments


class SendingPort(Protocol):
    """Sender of the frames of a simulated KURT2, except CONTROL (hal.bus.FramePort)."""

    def send(self, frame: can.Message) -> None:
        """Send a frame without blocking. Raises hal.bus.BusError."""
        ...

    def send_all(self, frames: Sequence[Frame]) -> None:
        """Send frames in order without blocking. Raises hal.bus.BusError."""
        ...


class ControllerBus(Protocol):
    """CAN bus as the simulated micro-controller uses it: frames in, telemetry out (hal.bus.CanBus)."""

    def drain(self) -> list[can.Message]:
        """Return the received frames, oldest first, without blocking. Raises hal.bus.BusError."""
        ...

    def telemetry_port(self) -> SendingPort:
        """Return a sender of all frames except CONTROL; may be called several times."""
        ...


SLOW_CYCLES = 10
"""Period, in cycles, of frames that do not steer the robot. A source has 10 ms for ENCODER alone
(docs/the-robot.md#messages). All seventeen frames in each cycle would double the bus load and the simulation's cost."""
_FIRMWARE_VERSION = 1


_MESSAGES = ("ADC00_03", "ADC04_07", "ADC08_11", "BDC00_03", "BDC04_07", "BDC08_11", "BDC12_15")
"""Messages with sensor channels. ADC12_15 carries motor currents and the board's temperature."""


class AnalogFrames:
    """Frames that carry the sensors' counts, packed with their newest readings.

    Channels without a sensor are grounded and read 0.
    """

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


class Telemetry:
    """Sender of ENCODER, BUMPERC and the sensors' analog frames in every cycle, of all others in every tenth.

    The slow frames are spread over the ten cycles, so that none carries a burst.
    """

    def __init__(self, robot: Kurt2Settings, codec: Codec, port: SendingPort, instruments: Instruments) -> None:
        self._port = port
        self._instruments = instruments
        self._analog = AnalogFrames(robot.infrared, codec)
        self._encoder = codec.message("ENCODER")
        self._bumperc = codec.message("BUMPERC")
        self._bumpers = 0
        self._bumper_frame = self._bumperc.pack(0, 0)
        slow: list[tuple[MessageCodec, Callable[[], Sequence[int]]]] = [
            (codec.message("INFO_1"), self._info),
            (codec.message("ADC12_15"), instruments.currents),
            (codec.message("DEADRECK"), instruments.deadreck),
            (codec.message("GETSPEED"), instruments.getspeed),
            (codec.message("TILT_COMP"), instruments.tilt),
            (codec.message("GYRO_MC1"), instruments.gyro),
            (codec.message("INFO_2"), self._info),
            (codec.message("GYRO_MC2"), instruments.gyro),
        ]
        self._slow_turns = [slow[turn::SLOW_CYCLES] for turn in range(SLOW_CYCLES)]
        # Continued after the slow frames, to fill the free cycles.
        idle = self._analog.without_sensor
        self._idle_turns = [idle[(turn - len(slow)) % SLOW_CYCLES :: SLOW_CYCLES] for turn in range(SLOW_CYCLES)]

    def update_readings(self, fresh: Sequence[int], counts: Sequence[int]) -> None:
        """Apply the new readings of some sensors.

        `fresh`: indexes of these sensors. `counts`: readings of all sensors, in counts.
        """
        self._analog.update(fresh, counts)

    def send(self, left_ticks: int, right_ticks: int, bumpers: int) -> None:
        """Send the frames of one cycle.

        Args:
            left_ticks: Encoder ticks of the left side since the previous cycle, forward positive.
            right_ticks: Encoder ticks of the right side.
            bumpers: Bit n is set if bumper n touches.

        Raises:
            hal.bus.BusError: the bus is closed or down.
        """
        analog = self._analog.frames
        frames = [analog[number] for number in self._analog.with_sensor]
        turn = self._instruments.cycles % SLOW_CYCLES
        for message, source in self._slow_turns[turn]:
            frames.append(message.pack(*source()))
        for number in self._idle_turns[turn]:
            frames.append(analog[number])
        if bumpers != self._bumpers:
            self._bumpers = bumpers
            self._bumper_frame = self._bumperc.pack(bumpers, 0)
        frames.append(self._encoder.pack(left_ticks, right_ticks))
        frames.append(self._bumper_frame)  # last: old hosts take it as the end of a cycle
        self._port.send_all(frames)

    def _info(self) -> tuple[int, ...]:
        return SIMULATED_HARDWARE_ID, _FIRMWARE_VERSION, self._instruments.cycles % (1 << 32)
