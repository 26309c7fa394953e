"""The simulated robot, its bus and its driver in simulated time, with one fault somewhere between them."""

import random
import uuid
from collections.abc import Callable

import can

from hal.bus import CONTROL_ID, CanBus
from hal.codec import load_codec
from hal.guard_reason import GuardReason
from hal.in_process_bus import InProcessBus
from hal.kurt2 import Kurt2
from hal.robot_settings import RobotSettings
from hal.tap import Tap
from hal.watchdog import POLL_S
from simbridge.faults.disturbance import TimedFault
from simbridge.faults.disturbed_end import FaultyInterface
from simbridge.faults.event_time import EventScheduler
from simbridge.faults.hall import CORRIDOR_WORLD
from simbridge.faults.motors import FaultyWheels
from simbridge.faults.parts import Part, faulty_rx_link, faulty_telemetry_link, faulty_tx_link
from simbridge.faults.way import Deliver, FrameLink, IdealLink
from simbridge.simulated_robot import SimulatedRobot


class SimulatedFaultRig:
    """Robot, bus and driver. The loop's ticks, the controller's cycle and the watchdog have phases of their own.

    The watchdog's thread is replaced by a look at moments of simulated time.
    """

    def __init__(
        self, settings: RobotSettings, part: Part | None, disturbance: TimedFault, chance: random.Random
    ) -> None:
        """`part`: what the disturbance hits; None when that is not on this side of the driver."""
        self.time = EventScheduler()
        self.disturbance = disturbance
        self.on_put: Callable[[int, bytes], None] = lambda _number, _payload: None
        """Called for each frame that the driver hands to its bus, before anything can happen to it."""
        self.on_control: Callable[[int, bytes], None] = lambda _number, _payload: None
        """Called for each of them that arrives at the robot's end as CONTROL, with the same number."""
        self._settings = settings
        self._part = part
        self._chance = chance
        self._spec = f"faults-{uuid.UUID(int=chance.getrandbits(128))}-{id(self)}"
        self._put = self._carried = 0
        self._notebooks_end: FaultyInterface | None = None
        self._robots_end: FaultyInterface | None = None
        self._robots_bus = CanBus(self._spec, self._open_robots_end)
        self.simulation = SimulatedRobot(
            settings, CORRIDOR_WORLD, self._robots_bus, chance.getrandbits(32), wheels=self._wheels()
        )
        self.robot = self._driver()
        self.time.every(settings.can.cycle_s, 0.0, self.simulation.step)
        self.time.every(POLL_S, chance.uniform(0.0, POLL_S), self._poll_watchdog)

    def start_anew(self) -> Kurt2:
        """The driver's process has ended and a new one comes, which knows nothing of what was."""
        self.robot.close()
        self.robot = self._driver()
        return self.robot

    def look_on(self, tap: Tap) -> None:
        """Somebody looks on at the driver's end."""
        self._notebooks_bus.tap = tap

    def close(self) -> None:
        """Give the bus back."""
        self.robot.close()
        self._robots_bus.shutdown()

    def _driver(self) -> Kurt2:
        self._notebooks_bus = CanBus(self._spec, self._open_notebooks_end)
        return Kurt2(self._settings, self._notebooks_bus, watchdog_clock=self.time.now_s)

    def _poll_watchdog(self) -> None:
        if self.robot.watchdog.check(self.time.now_s()):
            self.robot.emergency_stop(GuardReason.TICKS_CEASED)

    def _open_robots_end(self, name: str) -> FaultyInterface:
        self._robots_end = FaultyInterface(
            InProcessBus(name),
            self.time,
            outward=self._way_of_telemetry(),
            inward=_Watched(IdealLink(), self._note_arrival),
            receives_own_frames=False,
            on_carried=self._notebook_hears,
        )
        return self._robots_end

    def _open_notebooks_end(self, name: str) -> FaultyInterface:
        self._notebooks_end = FaultyInterface(
            InProcessBus(name),
            self.time,
            outward=_Numbered(self._way_out(), self._note_put, self._note_coming_out),
            inward=self._way_in(),
            receives_own_frames=True,
            on_carried=self._robot_hears,
        )
        return self._notebooks_end

    def _notebook_hears(self) -> None:
        if self._notebooks_end is not None:
            self._notebooks_end.take_in()

    def _robot_hears(self) -> None:
        if self._robots_end is not None:
            self._robots_end.take_in()

    def _note_put(self, payload: bytes) -> int:
        self._put += 1
        self.on_put(self._put, payload)
        return self._put

    def _note_coming_out(self, number: int) -> None:
        self._carried = number

    def _note_arrival(self, frame: can.Message) -> None:
        if frame.arbitration_id == CONTROL_ID:
            self.on_control(self._carried, bytes(frame.data))

    def _way_of_telemetry(self) -> FrameLink:
        codec = load_codec(self._settings.can.database)
        return faulty_telemetry_link(self._part, self.disturbance, self.time, self._chance, codec) or IdealLink()

    def _way_in(self) -> FrameLink:
        codec = load_codec(self._settings.can.database)
        return faulty_rx_link(self._part, self.disturbance, self.time, self._chance, codec) or IdealLink()

    def _way_out(self) -> FrameLink:
        return faulty_tx_link(self._part, self.disturbance, self.time, self._chance) or IdealLink()

    def _wheels(self) -> FaultyWheels:
        wheels = FaultyWheels(self._settings)
        wheels.disturb(self._part, self.disturbance, self.time, self._chance)
        return wheels


class _Watched:
    """A way that tells of each frame that sets out on it."""

    def __init__(self, way: FrameLink, note: Callable[[can.Message], None]) -> None:
        self._way = way
        self._note = note

    def carry(self, frame: can.Message, arrive: Deliver) -> None:
        """A frame sets out."""
        self._note(frame)
        self._way.carry(frame, arrive)


class _Numbered:
    """A way that numbers the frames that set out, and tells of each that comes out which one it is."""

    def __init__(self, way: FrameLink, note: Callable[[bytes], int], note_coming_out: Callable[[int], None]) -> None:
        self._way = way
        self._note = note
        self._note_coming_out = note_coming_out

    def carry(self, frame: can.Message, arrive: Deliver) -> None:
        """A frame sets out. Raises OSError."""
        number = self._note(bytes(frame.data))

        def come_out(each: can.Message) -> None:
            self._note_coming_out(number)
            arrive(each)

        self._way.carry(frame, come_out)
