"""The simulated robot as a process: `python -m tests.hil.simulated_time.robot BUS SECONDS [INFRARED_SECONDS]`.

It sends no infra-red readings any more after so many seconds.
"""

import sys
import time
from collections.abc import Sequence

import can

from hal.bus import CanBus, FramePort, open_bus
from hal.frame import Frame
from hal.kurt2_settings import load_kurt2
from simbridge.realtime import RealtimeSimulation
from simbridge.simulated_robot import SimulatedKurt2
from simbridge.worlds.world_loading import load_world
from tests.hal.helpers import CODEC, INFRARED_FRAMES


class FallingSilent:
    """The robot's end of a bus, on which the readings cease at some time of the monotonic clock."""

    def __init__(self, bus: CanBus, silent_from_s: float) -> None:
        self._bus = bus
        self._silent_from_s = silent_from_s

    def drain(self) -> list[can.Message]:
        return self._bus.drain()

    def telemetry_port(self) -> "FallingSilentPort":
        return FallingSilentPort(self._bus.telemetry_port(), self._silent_from_s)


class FallingSilentPort:
    _infrared_ids = frozenset(CODEC.message(name).frame_id for name in INFRARED_FRAMES)

    def __init__(self, port: FramePort, silent_from_s: float) -> None:
        self._port = port
        self._silent_from_s = silent_from_s

    def send(self, frame: can.Message) -> None:
        if frame.arbitration_id not in self._infrared_ids or time.monotonic() < self._silent_from_s:
            self._port.send(frame)

    def send_all(self, frames: Sequence[Frame]) -> None:
        for frame in frames:
            self.send(frame)


def main() -> None:
    name, seconds, *infrared_seconds = sys.argv[1:]
    settings = load_kurt2()
    bus = open_bus(name)
    silent_from_s = time.monotonic() + (float(infrared_seconds[0]) if infrared_seconds else float("inf"))
    robot = SimulatedKurt2(settings, load_world("a", settings), FallingSilent(bus, silent_from_s), seed=7)
    with RealtimeSimulation(robot) as simulation:
        simulation.wait(float(seconds))
    bus.shutdown()


if __name__ == "__main__":
    main()
