"""Links of simulated robots: to a driver in this program, and to other programs, as hardware would be."""

import contextlib
import os
import time
import tty
import uuid
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Protocol

from hal.bus import CONTROL_ID, BusError, CanBus, open_bus
from hal.codec import load_codec
from hal.kurt2_settings import Kurt2Settings
from hal.robot_settings import RobotSettings
from simbridge.controller.reconnecting_bus import ReconnectingBus
from simbridge.simulated_robot import MakeController, MakeSensors, SimulatedKurt2, SimulatedRobot, infrared_sensors
from simbridge.worlds.world_settings import WorldSettings


class SimulatedLink(Protocol):
    """Link between a simulated robot and its driver, which decides what a simulated cycle does on it."""

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """Simulate one cycle up to the runtime's tick; `step_robot` is called once within it."""
        ...

    def live(self) -> AbstractContextManager[None]:
        """Return a context in which the link follows the wall clock."""
        ...

    def close(self) -> None:
        """Close the robot's end, after the driver closed its own."""
        ...


class InstantLink:
    """Base of links in memory, over which reports arrive in the cycle that made them (SimulatedLink)."""

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """Step the robot; its reports arrive at once."""
        step_robot()

    def live(self) -> AbstractContextManager[None]:
        """Return an empty context, because nothing runs in real time."""
        return nullcontext()

    def close(self) -> None:
        """Close nothing: this link is in memory."""


_DELIVERY_PAUSES, _DELIVERY_PAUSE_S = 8, 0.0005
"""Pauses in which the kernel's own thread delivers the frames of a cycle. One alone can pass while the whole machine
stands still, and then the thread has not run."""


class CanLine(InstantLink):
    """Both ends of a CAN bus between a simulated KURT2 and its driver; frames take no simulated time."""

    def __init__(self, bus: str | None = None) -> None:
        """Open both ends of a bus (hal.bus.open_bus) that others may listen to; None: of a channel of their own.

        Raises BusError.
        """
        # A unique channel: two lines in one process must not share frames.
        spec = bus or f"virtual:{uuid.uuid4()}"
        self.robot_end, self.notebook_end = open_bus(spec), open_bus(spec)
        if bus is not None:
            self.robot_end.set_id_filter({CONTROL_ID})  # frames of others must not cost the robot its cycle
        self._pauses = 0 if ":" in spec else _DELIVERY_PAUSES

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """Step the robot, then wait until the bus has delivered its frames."""
        step_robot()
        for _ in range(self._pauses):
            time.sleep(_DELIVERY_PAUSE_S)

    def close(self) -> None:
        """Shut the robot's end of the bus down."""
        self.robot_end.shutdown()


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


_MOST_BYTES = 1 << 16


class PtyPort:
    """Pseudo-terminal as a robot's serial line (hal.byte_port.BytePort).

    Other programs open its path `device`.
    """

    waiting = 0

    def __init__(self, device: str = "") -> None:
        """Open a pseudo-terminal; `device`: path of a link to it. Raises hal.bus.BusError if the path is in use."""
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.device = device or os.ttyname(self._slave)
        self.name = f"pseudo-terminal {self.device}"
        self._link = Path(device) if device else None
        self._closed = False
        if self._link is not None:
            try:
                if self._link.is_symlink() and not self._link.exists():  # of a program that was killed
                    self._link.unlink()
                self._link.symlink_to(os.ttyname(self._slave))
            except OSError as error:
                self._link = None
                self.close()
                raise BusError(str(error.strerror), where=self.name, do="take another path, or delete it") from error

    def read(self) -> bytes:
        """Return all bytes that arrived."""
        with contextlib.suppress(BlockingIOError):
            return os.read(self._master, _MOST_BYTES)
        return b""

    def write(self, data: bytes) -> None:
        """Write bytes; they are lost while no other program reads the earlier ones."""
        with contextlib.suppress(BlockingIOError):
            os.write(self._master, data)

    def reopen(self) -> None:
        """Do nothing: this end is never lost."""

    def close(self) -> None:
        """Close both ends and remove the link, which is like unplugging the robot; may be called twice."""
        if self._closed:
            return
        self._closed = True
        own, link = os.ttyname(self._slave), self._link
        os.close(self._master)
        os.close(self._slave)
        if link is not None and link.is_symlink() and str(link.readlink()) == own:  # not the link of a later program
            link.unlink()
