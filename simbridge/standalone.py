"""Simulated robot in real time, as hardware for a runtime in another process."""

import random
import time
from types import TracebackType
from typing import Self

from hal.bus import CONTROL_ID, BusError, CanBus
from hal.codec import load_codec
from hal.kurt2_settings import Kurt2Settings
from simbridge.controller.reconnecting_bus import ReconnectingBus
from simbridge.realtime import RealtimeSimulation
from simbridge.simulated_kurt2 import SimulatedKurt2
from simbridge.worlds.world_settings import WorldSettings

_LISTEN_S = 0.1
"""Ten times a robot's longest silence."""


class StandaloneRobot:
    """Running robot and the bus it owns; it survives the loss of the bus."""

    def __init__(
        self, settings: Kurt2Settings, world: WorldSettings, bus: CanBus, seed: int, *, start: int | None = None
    ) -> None:
        """Place a robot in a world.

        Args: `seed` selects sensors, noise and, if `start` is None, the start pose; `start` counts from 1.
        Raises BusError if a robot is on the bus already.
        """
        require_free_bus(settings, bus)
        bus.set_id_filter({CONTROL_ID})  # other frames must not cost the robot its cycle
        self._bus = bus
        self.bus = ReconnectingBus(bus)
        chance = random.Random(f"on a bus in world {world.name}, seed {seed}")
        self.robot = SimulatedKurt2(settings, world, self.bus, chance.getrandbits(32), robot_seed=seed)
        starts = [each.pose for each in world.start_poses]
        self.robot.place(chance.choice(starts) if start is None else starts[start - 1])
        self.simulation = RealtimeSimulation(self.robot, settings.cycle_s)

    def __enter__(self) -> Self:
        self.simulation.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.simulation.__exit__(kind, error, trace)
        finally:
            self._bus.shutdown()


def require_free_bus(settings: Kurt2Settings, bus: CanBus) -> None:
    """Listen for 0.1 s. If a robot sends on the bus, shut this end down and raise BusError.

    Two robots would both execute CONTROL, and their telemetry would mix.
    """
    encoder_id = load_codec(settings.can.database).message("ENCODER").frame_id
    bus.set_id_filter({encoder_id})
    time.sleep(_LISTEN_S)
    if any(frame.arbitration_id == encoder_id and not frame.is_error_frame for frame in bus.drain()):
        bus.shutdown()
        raise BusError("a robot is on it already", where=f"bus {bus.name}", do="end that one, or take another bus")
