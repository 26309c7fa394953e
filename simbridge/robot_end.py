"""A simulated robot's end of a link that other programs reach: for `kurt2rt sim`, as hardware would be."""

import time
from typing import Protocol

from hal.bus import CONTROL_ID, BusError, CanBus
from hal.codec import load_codec
from hal.kurt2_settings import Kurt2Settings
from hal.robot_settings import RobotSettings
from simbridge.controller.reconnecting_bus import ReconnectingBus
from simbridge.simulated_kurt2 import SimulatedKurt2
from simbridge.simulated_robot import MakeController, MakeSensors, SimulatedRobot, infrared_sensors
from simbridge.worlds.world_settings import WorldSettings

_LISTEN_S = 0.1
"""Ten times a robot's longest silence."""


class RobotEnd(Protocol):
    """Robot's end of a link that `kurt2rt sim` opens, and the maker of the simulated robot there.

    A lost link raises nothing: the robot stands until it is back.
    """

    @property
    def name(self) -> str:
        """Name of the link in messages, such as `bus vcan0`."""
        ...

    @property
    def error_text(self) -> str:
        """Cause of the present interruption; empty without one."""
        ...

    @property
    def lost(self) -> int:
        """Number of messages that the link refused."""
        ...

    def simulate(self, world: WorldSettings, seed: int, robot_seed: int) -> SimulatedRobot:
        """Return the robot at this end (simbridge.simulated_robot.SimulatedRobot has the seeds)."""
        ...

    def close(self) -> None:
        """Close this end; may be called twice."""
        ...


class ClosablePort(Protocol):
    """Robot's end of a plug-in's link, as far as `LinkRobotEnd` needs it; it is never lost."""

    @property
    def name(self) -> str:
        """Name of the link in messages, such as `serial port /dev/ttyACM0`."""
        ...

    def close(self) -> None:
        """Close this end; may be called twice."""
        ...


class CanRobotEnd:
    """Simulated KURT2's end of a CAN bus that other programs use, for `kurt2rt sim`."""

    def __init__(self, settings: Kurt2Settings, bus: CanBus) -> None:
        """Own a bus from now on. Raises BusError if a robot is on the bus already."""
        require_free_bus(settings, bus)
        bus.set_id_filter({CONTROL_ID})  # other frames must not cost the robot its cycle
        self.name = f"bus {bus.name}"
        self._settings = settings
        self._bus = bus
        self._reconnecting = ReconnectingBus(bus)

    @property
    def error_text(self) -> str:
        """Cause of the interruption at the last drain; empty without one."""
        return self._reconnecting.error_text

    @property
    def lost(self) -> int:
        """Number of frames that the bus refused."""
        return self._reconnecting.lost

    def simulate(self, world: WorldSettings, seed: int, robot_seed: int) -> SimulatedKurt2:
        """Return a KURT2 at this end of the bus."""
        return SimulatedKurt2(self._settings, world, self._reconnecting, seed, robot_seed=robot_seed)

    def close(self) -> None:
        """Shut the robot's end of the bus down."""
        self._bus.shutdown()


class LinkRobotEnd:
    """Robot's end of the link of a plug-in, with the makers of its simulated electronics and sensors."""

    error_text, lost = "", 0

    def __init__(
        self,
        settings: RobotSettings,
        port: ClosablePort,
        make_controller: MakeController,
        make_sensors: MakeSensors = infrared_sensors,
    ) -> None:
        """Own `port` from now on, at which the electronics of `make_controller` is."""
        self.name = port.name
        self._settings, self._port = settings, port
        self._make_controller, self._make_sensors = make_controller, make_sensors

    def simulate(self, world: WorldSettings, seed: int, robot_seed: int) -> SimulatedRobot:
        """Return the robot at this end."""
        return SimulatedRobot(
            self._settings,
            world,
            self._make_controller,
            seed,
            robot_seed=robot_seed,
            make_sensors=self._make_sensors,
        )

    def close(self) -> None:
        """Close the robot's end of the link."""
        self._port.close()


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
