"""Simulated robot in a world for long runs with many faults and drivers."""

import math
import random
from collections.abc import Callable

import can

from hal.bus import CONTROL_ID, CanBus
from hal.can_interface import CanInterface
from hal.codec import load_codec
from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings
from hal.robot import WheelSpeeds
from hal.simulation import Pose
from hal.tap import Tap
from hal.watchdog import POLL_S
from simbridge.faults.cable import SOUND, Cable, CableFaults
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.motors import FaultyWheels
from simbridge.faults.parts import faulty_rx_link, faulty_telemetry_link, faulty_tx_link, part_of
from simbridge.faults.switchable_interface import Links, NumberedFrame, SwitchableInterface
from simbridge.faults.timed_fault import Kind, TimedFault
from simbridge.simulated_kurt2 import SimulatedKurt2
from simbridge.worlds.world_loading import load_world

_CABLES = {"none": SOUND, "slow": CableFaults(delay_s=0.002), "lossy": CableFaults(lost=0.1)}
"""Faults of the cable by the name of a wire."""


class LongRunRig:
    """Robot, bus and driver in simulated time (kurt2rt.checks.soak.long_run_rig.SoakRig).

    Ticks, controller cycles and watchdog polls have independent phases. Events of simulated time replace the
    watchdog's thread.
    """

    def __init__(self, settings: Kurt2Settings, world: str, seed: int) -> None:
        """Place the robot at a random start pose of the world, without a driver. Raises UserError."""
        self._chance = random.Random(f"lasting place in {world}, seed {seed}")
        self.time = EventScheduler()
        self.on_sent: Callable[[int, bytes], None] = lambda _number, _payload: None
        """Callback with number and payload of each CONTROL that the driver sends."""
        self.on_control: Callable[[int, bytes, float], None] = lambda _number, _payload, _at_s: None
        """Callback with number, payload and arrival time in s of each CONTROL that the robot receives."""
        self.turned_m = [0.0, 0.0]
        """Distance rolled by the rims, left and right, forward positive."""
        self.crashes = 0
        """Number of crashes of the micro-controller, each followed by a power cycle."""
        self._settings = settings
        self._codec = load_codec(settings.can.database)
        self._cycle_s = settings.cycle_s
        self._numbers = 0
        self._robots_links, self._notebooks_links = Links(), Links()
        self._open_bus("none")
        self._robots_bus = CanBus("soak", self._open_robots_end)
        self._robots_bus.set_id_filter({CONTROL_ID})
        world_settings = load_world(world, settings)
        self._starts = [start.pose for start in world_settings.start_poses]
        self._wheels = FaultyWheels(settings)
        self.simulation = SimulatedKurt2(
            settings,
            world_settings,
            self._robots_bus,
            self._chance.getrandbits(32),
            robot_seed=seed,
            wheels=self._wheels,
        )
        self.reposition()
        self._notebooks_bus: CanBus | None = None
        self.robot: Kurt2 | None = None
        self.time.every(self._cycle_s, 0.0, self._step)
        self.time.every(POLL_S, self._chance.uniform(0.0, POLL_S), self._poll_watchdog)

    def start_driver(self, wire: str) -> Kurt2:
        """Start a new driver over a wire given by name and return it."""
        self.end_driver()
        self._open_bus(wire)
        self._robots_bus.reopen()
        self._notebooks_bus = CanBus("soak", self._open_notebooks_end)
        self.robot = Kurt2(self._settings, self._notebooks_bus, watchdog_clock=self.time.now_s)
        return self.robot

    def end_driver(self) -> None:
        """End the driver, like the end of its process."""
        if self.robot is not None:
            self.robot.close()
            self.robot = None

    def begin(
        self, target: str, kind: Kind, *, begin_s: float, end_s: float, period_s: float, delay_s: float
    ) -> TimedFault:
        """Schedule a fault of `target` from `begin_s` to `end_s` and return it. Times in s of simulated time.

        A target that is no part of robot or bus is left to the caller. `period_s` and `delay_s` are those of the
        fault's kind.
        """
        disturbance = TimedFault(kind, begin_s, end_s, period_s, delay_s)
        part, time, chance = part_of(target), self.time, self._chance
        self._robots_links.outward = faulty_telemetry_link(part, disturbance, time, chance, self._codec)
        self._notebooks_links.inward = faulty_rx_link(part, disturbance, time, chance, self._codec)
        self._notebooks_links.outward = faulty_tx_link(part, disturbance, time, chance)
        self._wheels.disturb(part, disturbance, time, chance)
        return disturbance

    def end(self) -> None:
        """Remove the fault from robot and bus."""
        self._robots_links.outward = self._notebooks_links.inward = self._notebooks_links.outward = None
        self._wheels.disturb(None, TimedFault("off", 0.0, 0.0, 0.0, 0.0), self.time, self._chance)

    def attach_tap(self, tap: Tap | None) -> None:
        """Let `tap` see each frame that passes the driver's interface; None detaches it."""
        if self._notebooks_bus is not None:
            self._notebooks_bus.tap = tap

    def reposition(self) -> None:
        """Reposition the robot at a random start pose."""
        self.simulation.place(self._chance.choice(self._starts))

    def power_cycle(self) -> None:
        """Switch the robot's controller off and on."""
        self.simulation.controller.power_cycle()

    @property
    def position_m(self) -> tuple[float, float]:
        """True position (x, y) of the robot in m."""
        pose: Pose = self.simulation.pose
        return pose.x_m, pose.y_m

    @property
    def collisions(self) -> int:
        """Number of contacts with walls and obstacles so far."""
        return self.simulation.collisions

    @property
    def standing(self) -> bool:
        """Return whether the wheels stand still."""
        speeds: WheelSpeeds = self.simulation.wheel_speeds
        return math.hypot(*speeds) == 0.0

    def close(self) -> None:
        """End the driver and close the bus."""
        self.end_driver()
        self._robots_bus.shutdown()

    def _step(self) -> None:
        simulation = self.simulation
        simulation.step()
        left_m_s, right_m_s = simulation.wheel_speeds
        self.turned_m[0] += left_m_s * self._cycle_s
        self.turned_m[1] += right_m_s * self._cycle_s
        if simulation.controller.crashed:
            self.power_cycle()
            self.crashes += 1

    def _poll_watchdog(self) -> None:
        robot = self.robot
        if robot is not None and robot.watchdog.check(self.time.now_s()):
            robot.emergency_stop(GuardReason.TICKS_CEASED)

    def _open_bus(self, wire: str) -> None:
        """Select the wire that later opened interfaces join."""
        self._cable = Cable(self.time.now_s, _CABLES[wire], self._chance)

    def _open_robots_end(self, _: str) -> CanInterface:
        return SwitchableInterface(self._cable.open(), self._robots_links, self.time.now_s, on_heard=self._on_arrival)

    def _open_notebooks_end(self, _: str) -> CanInterface:
        return SwitchableInterface(self._cable.open(), self._notebooks_links, self.time.now_s, on_send=self._number)

    def _number(self, frame: can.Message) -> can.Message:
        self._numbers += 1
        payload = bytes(frame.data)
        self.on_sent(self._numbers, payload)
        return NumberedFrame(frame.arbitration_id, payload, self._numbers)

    def _on_arrival(self, frame: NumberedFrame) -> None:
        if frame.arbitration_id == CONTROL_ID:
            self.on_control(frame.number, frame.data, frame.timestamp)
