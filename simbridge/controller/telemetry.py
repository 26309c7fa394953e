"""Schedule of the frames from the robot to the notebook."""

from collections.abc import Callable, Sequence

from hal.codec import Codec, MessageCodec
from hal.identity import SIMULATED_HARDWARE_ID
from hal.kurt2_settings import Kurt2Settings
from simbridge.controller.analog_frames import AnalogFrames
from simbridge.controller.controller_bus import SendingPort
from simbridge.robot.instruments import Instruments

SLOW_CYCLES = 10
"""Period, in cycles, of frames that do not steer the robot. A source has 10 ms for ENCODER alone
(docs/the-robot.md#messages). All seventeen frames in each cycle would double the bus load and the simulation's cost."""
_FIRMWARE_VERSION = 1


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
