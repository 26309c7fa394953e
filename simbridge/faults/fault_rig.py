"""Simulated robot, bus and driver with one fault between them."""

import random
import uuid
from collections.abc import Callable
from dataclasses import dataclass

import can

from hal.bus import CONTROL_ID, CanBus
from hal.codec import load_codec
from hal.guard_reason import GuardReason
from hal.in_process_bus import InProcessBus
from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings
from hal.tap import Tap
from hal.watchdog import POLL_S
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.faulty_interface import FaultyInterface
from simbridge.faults.frame_link import Deliver, FrameLink, IdealLink
from simbridge.faults.motors import FaultyWheels
from simbridge.faults.parts import Part, faulty_rx_link, faulty_telemetry_link, faulty_tx_link, part_of
from simbridge.faults.timed_fault import Kind, TimedFault
from simbridge.simulated_kurt2 import SimulatedKurt2
from simbridge.worlds.world_settings import StartPoseSettings, WorldSettings

_LENGTH_M, _WIDTH_M = 10.0, 4.0
_WALL_AT_M = 0.22
_HALF_WIDTH_M = 0.165

CORRIDOR_WORLD = WorldSettings(
    name="hall",
    size_m=(_LENGTH_M, _WIDTH_M),
    infrared_rays=1,
    outline=((0.0, 0.0), (_LENGTH_M, 0.0), (_LENGTH_M, _WIDTH_M), (0.0, _WIDTH_M), (0.0, 0.0)),
    start_poses=(StartPoseSettings(x_m=1.5, y_m=_WIDTH_M - _HALF_WIDTH_M - _WALL_AT_M, heading_deg=0.0),),
)
"""Corridor with one constant situation, so that a standstill is due to the fault."""


class SimulatedFaultRig:
    """Robot, bus and driver in simulated time (kurt2rt.checks.faults.fault_rig.FaultRig).

    Ticks, controller cycles and watchdog polls have independent phases. Events of simulated time replace the
    watchdog's thread.
    """

    def __init__(
        self, settings: Kurt2Settings, part: Part | None, disturbance: TimedFault, chance: random.Random
    ) -> None:
        """Place the robot in the corridor; `part` has the fault, None if it is not on this side of the driver."""
        self.time = EventScheduler()
        self.disturbance = disturbance
        self.on_sent: Callable[[int, bytes], None] = lambda _number, _payload: None
        """Callback with number and payload of each frame that the driver sends."""
        self.on_control: Callable[[int, bytes], None] = lambda _number, _payload: None
        """Callback with number and payload of each CONTROL that arrives at the robot."""
        self._settings = settings
        self._codec = load_codec(settings.can.database)
        self._part = part
        self._chance = chance
        self._spec = f"faults-{uuid.UUID(int=chance.getrandbits(128))}-{id(self)}"
        self._put = self._carried = 0
        self._notebooks_end: FaultyInterface | None = None
        self._robots_end: FaultyInterface | None = None
        self._robots_bus = CanBus(self._spec, self._open_robots_end)
        self.simulation = SimulatedKurt2(
            settings, CORRIDOR_WORLD, self._robots_bus, chance.getrandbits(32), wheels=self._wheels()
        )
        self.robot = self._driver()
        self.time.every(settings.cycle_s, 0.0, self.simulation.step)
        self.time.every(POLL_S, chance.uniform(0.0, POLL_S), self._poll_watchdog)

    def restart_driver(self) -> Kurt2:
        """Replace the driver by a new one, like a restart of its process; return the new driver."""
        self.robot.close()
        self.robot = self._driver()
        return self.robot

    def attach_tap(self, tap: Tap) -> None:
        """Let `tap` see each frame that passes the driver's interface."""
        self._notebooks_bus.tap = tap

    def close(self) -> None:
        """Close driver and bus."""
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
            outward=self._telemetry_link(),
            inward=_ObservedLink(self._on_arrival),
            receives_own_frames=False,
            on_carried=self._deliver_to_notebook,
        )
        return self._robots_end

    def _open_notebooks_end(self, name: str) -> FaultyInterface:
        self._notebooks_end = FaultyInterface(
            InProcessBus(name),
            self.time,
            outward=_NumberingLink(self._tx_link(), self._number, self._on_delivered),
            inward=self._rx_link(),
            receives_own_frames=True,
            on_carried=self._deliver_to_robot,
        )
        return self._notebooks_end

    def _deliver_to_notebook(self) -> None:
        if self._notebooks_end is not None:
            self._notebooks_end.receive()

    def _deliver_to_robot(self) -> None:
        if self._robots_end is not None:
            self._robots_end.receive()

    def _number(self, payload: bytes) -> int:
        self._put += 1
        self.on_sent(self._put, payload)
        return self._put

    def _on_delivered(self, number: int) -> None:
        self._carried = number

    def _on_arrival(self, frame: can.Message) -> None:
        if frame.arbitration_id == CONTROL_ID:
            self.on_control(self._carried, bytes(frame.data))

    def _telemetry_link(self) -> FrameLink:
        return faulty_telemetry_link(self._part, self.disturbance, self.time, self._chance, self._codec) or IdealLink()

    def _rx_link(self) -> FrameLink:
        return faulty_rx_link(self._part, self.disturbance, self.time, self._chance, self._codec) or IdealLink()

    def _tx_link(self) -> FrameLink:
        return faulty_tx_link(self._part, self.disturbance, self.time, self._chance) or IdealLink()

    def _wheels(self) -> FaultyWheels:
        wheels = FaultyWheels(self._settings)
        wheels.disturb(self._part, self.disturbance, self.time, self._chance)
        return wheels


@dataclass(frozen=True, slots=True)
class FaultRigFactory:
    """Factory of robots in a corridor with one fault; picklable."""

    settings: Kurt2Settings

    def open(
        self, target: str, kind: Kind, *, begin_s: float, end_s: float, period_s: float, delay_s: float, seed: int
    ) -> SimulatedFaultRig:
        """Return a rig with a fault from `begin_s` to `end_s`, shifted by the seed's phase within a cycle.

        A target that is no part of robot or bus is left to the caller; the rig's `disturbance` has the times. Times in
        s; `period_s` and `delay_s` are those of the fault's kind.
        """
        chance = random.Random(f"{target} {kind} {seed}")
        phase_s = chance.uniform(0.0, self.settings.cycle_s)
        disturbance = TimedFault(kind, begin_s + phase_s, end_s + phase_s, period_s, delay_s)
        return SimulatedFaultRig(self.settings, part_of(target), disturbance, chance)


class _ObservedLink:
    """Ideal link that reports each frame."""

    def __init__(self, on_frame: Callable[[can.Message], None]) -> None:
        self._on_frame = on_frame

    def carry(self, frame: can.Message, deliver: Deliver) -> None:
        """Report and deliver a frame."""
        self._on_frame(frame)
        deliver(frame)


class _NumberingLink:
    """Link that numbers the frames and reports the number of each one delivered."""

    def __init__(self, link: FrameLink, number: Callable[[bytes], int], on_delivered: Callable[[int], None]) -> None:
        self._link = link
        self._number = number
        self._on_delivered = on_delivered

    def carry(self, frame: can.Message, deliver: Deliver) -> None:
        """Carry a frame under a new number. Raises OSError."""
        number = self._number(bytes(frame.data))

        def deliver_numbered(each: can.Message) -> None:
            self._on_delivered(number)
            deliver(each)

        self._link.carry(frame, deliver_numbered)
