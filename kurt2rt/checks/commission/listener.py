"""Listener to all frames on its own CAN interface; the robot's driver filters for its own."""

import can

from hal.bus import CONTROL_ID, CanBus
from hal.codec import Codec, InvalidFrameError, MessageCodec
from hal.kurt2_settings import DISTANCE_CHANNEL
from hal.robot import HIGHEST_COUNTS
from kurt2rt.checks.commission.frame_statistics import EncoderFrame, FrameStatistics, Identity


class Listener:
    """Decoder of all frames of one CAN interface. It sends nothing."""

    def __init__(self, bus: CanBus, codec: Codec) -> None:
        """Take ownership of the interface."""
        self._bus = bus
        self._codec = codec
        named = {channel for each in codec.by_id.values() for channel in each.signals}
        self._distances = frozenset(filter(DISTANCE_CHANNEL.fullmatch, named))
        self.channels: set[str] = set()
        """Analog channels received so far."""
        self.has_bumpers = False
        """True once BUMPERC was received."""
        self.hardware_id: int | None = None
        """Hardware id of the last INFO_1."""

    def poll(self, now_s: float, heard: FrameStatistics) -> None:
        """Collect the waiting frames; their times are on the clock of `now_s`. Raises hal.bus.BusError."""
        messages = self._bus.drain()
        bus_now_s = self._bus.now_s() if messages else None
        for message in messages:
            age_s = 0.0 if bus_now_s is None else max(0.0, bus_now_s - message.timestamp)
            self._add(message, now_s - age_s, heard)

    def close(self) -> None:
        """Close the CAN interface; nothing is heard afterwards."""
        self._bus.shutdown()

    def _add(self, message: can.Message, at_s: float, heard: FrameStatistics) -> None:
        if message.is_error_frame:
            heard.junk["error frames of the bus"] += 1
            return
        if message.is_extended_id or message.is_remote_frame:
            heard.junk["extended or remote frames"] += 1
            return
        frame_id = message.arbitration_id
        heard.arrivals_s.setdefault(frame_id, []).append(at_s)
        if frame_id == CONTROL_ID:
            heard.control += 1
            return
        codec = self._codec.by_id.get(frame_id)
        if codec is None:
            return
        try:
            self._decode(codec, message.data, at_s, heard)
        except InvalidFrameError as error:
            heard.junk[str(error)] += 1

    def _decode(self, codec: MessageCodec, data: bytes | bytearray, at_s: float, heard: FrameStatistics) -> None:
        values = codec.unpack(data)
        if codec.name == "ENCODER":
            heard.encoder.append(EncoderFrame(at_s, *values))
        elif codec.name == "BUMPERC":
            heard.bumpers.append(values[0])
            self.has_bumpers = True
        elif codec.name in ("INFO_1", "INFO_2"):
            identity = Identity(*values)
            heard.identities.setdefault(codec.name, []).append(identity)
            if codec.name == "INFO_1":
                self.hardware_id = identity.hardware_id
        else:
            for channel, counts in zip(codec.signals, values, strict=True):
                if channel not in self._distances:
                    continue
                if counts > HIGHEST_COUNTS:
                    heard.junk[f"{channel} above {HIGHEST_COUNTS} counts"] += 1
                else:
                    heard.channels.setdefault(channel, []).append(counts)
                    self.channels.add(channel)
