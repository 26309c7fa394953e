"""The simulated robot, its bus and its driver in simulated time, with one fault somewhere between them."""

import random
import struct
import uuid
from collections.abc import Callable
from typing import Literal

import can

from hal.bus import CONTROL_ID, CanBus
from hal.codec import load_codec
from hal.frame import Frame
from hal.in_process_bus import InProcessBus
from hal.kurt2 import Kurt2
from hal.robot_settings import RobotSettings
from hal.tap import Tap
from hal.watchdog import POLL_S, TICKS_CEASED
from simbridge.faults.disturbance import Disturbance
from simbridge.faults.disturbed_end import DisturbedEnd
from simbridge.faults.event_time import EventTime
from simbridge.faults.hall import HALL
from simbridge.faults.motors import DisturbedWheels
from simbridge.faults.way import Arrive, DisturbedWay, StraightWay, Way
from simbridge.faults.way_out import DisturbedWayOut
from simbridge.simulated_robot import SimulatedRobot

Part = Literal["sensor_board_1", "sensor_board_2", "encoders", "left_motor", "right_motor", "bus_in", "bus_out"]
"""What can fail on the robot's side of the driver."""

_BOARD_LETTERS = {"sensor_board_1": "ADC", "sensor_board_2": "BDC"}
_FLOOR_AND_PLATEAU = 620
"""Sum of the readings with nothing in view and with a wall in front of the sensor."""
_SOMEBODY_ELSES_ORDER = Frame(CONTROL_ID, struct.pack(">HhhH", 2, 20, 20, 1))
"""SPEED_CM, 0.2 m/s on both sides."""


class FaultyPlace:
    """Robot, bus and driver. The loop's ticks, the controller's cycle and the watchdog have phases of their own.

    The watchdog's thread is replaced by a look at moments of simulated time.
    """

    def __init__(
        self, settings: RobotSettings, part: Part | None, disturbance: Disturbance, chance: random.Random
    ) -> None:
        """`part`: what the disturbance hits; None when that is not on this side of the driver."""
        self.time = EventTime()
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
        self._notebooks_end: DisturbedEnd | None = None
        self._robots_end: DisturbedEnd | None = None
        self._robots_bus = CanBus(self._spec, self._open_robots_end)
        self.simulation = SimulatedRobot(
            settings, HALL, self._robots_bus, chance.getrandbits(32), wheels=self._disturbed_wheels()
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
            self.robot.emergency_stop(TICKS_CEASED)

    def _open_robots_end(self, name: str) -> DisturbedEnd:
        self._robots_end = DisturbedEnd(
            InProcessBus(name),
            self.time,
            outward=self._way_of_telemetry(),
            inward=_Watched(StraightWay(), self._note_arrival),
            confirms=False,
            on_carried=self._notebook_hears,
        )
        return self._robots_end

    def _open_notebooks_end(self, name: str) -> DisturbedEnd:
        self._notebooks_end = DisturbedEnd(
            InProcessBus(name),
            self.time,
            outward=_Numbered(self._way_out(), self._note_put, self._note_coming_out),
            inward=self._way_in(),
            confirms=True,
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

    def _way_of_telemetry(self) -> Way:
        if self._part not in ("encoders", "sensor_board_1", "sensor_board_2"):
            return StraightWay()
        codec = load_codec(self._settings.can.database)
        if self._part == "encoders":
            encoder = codec.message("ENCODER")
            return DisturbedWay(
                self.disturbance,
                self.time,
                self._chance,
                {encoder.frame_id},
                # What an encoder repeats is its count: no ticks since the last frame.
                freeze=lambda _: encoder.pack(0, 0),
                falsify=lambda frame: [encoder.pack(*(-ticks for ticks in encoder.unpack(frame.data)))],
            )
        letters = _BOARD_LETTERS[self._part]
        board = {each: message for each, message in codec.by_id.items() if message.name.startswith(letters)}

        def show_far_for_near(frame: can.Message) -> list[can.Message]:
            message = board[frame.arbitration_id]
            return [message.pack(*(max(0, _FLOOR_AND_PLATEAU - each) for each in message.unpack(frame.data)))]

        return DisturbedWay(self.disturbance, self.time, self._chance, board.keys(), falsify=show_far_for_near)

    def _way_in(self) -> Way:
        if self._part != "bus_in":
            return StraightWay()
        last_of_a_cycle = load_codec(self._settings.can.database).message("BUMPERC").frame_id

        def hear_somebody_else(frame: can.Message) -> list[can.Message]:
            return [frame, _SOMEBODY_ELSES_ORDER] if frame.arbitration_id == last_of_a_cycle else [frame]

        return DisturbedWay(self.disturbance, self.time, self._chance, None, falsify=hear_somebody_else)

    def _way_out(self) -> Way:
        if self._part != "bus_out":
            return StraightWay()
        return DisturbedWayOut(self.disturbance, self.time, self._chance)

    def _disturbed_wheels(self) -> DisturbedWheels | None:
        match self._part:
            case "left_motor":
                return DisturbedWheels(self._settings, self.disturbance, "left", self.time, self._chance)
            case "right_motor":
                return DisturbedWheels(self._settings, self.disturbance, "right", self.time, self._chance)
        return None


class _Watched:
    """A way that tells of each frame that sets out on it."""

    def __init__(self, way: Way, note: Callable[[can.Message], None]) -> None:
        self._way = way
        self._note = note

    def carry(self, frame: can.Message, arrive: Arrive) -> None:
        """A frame sets out."""
        self._note(frame)
        self._way.carry(frame, arrive)


class _Numbered:
    """A way that numbers the frames that set out, and tells of each that comes out which one it is."""

    def __init__(self, way: Way, note: Callable[[bytes], int], note_coming_out: Callable[[int], None]) -> None:
        self._way = way
        self._note = note
        self._note_coming_out = note_coming_out

    def carry(self, frame: can.Message, arrive: Arrive) -> None:
        """A frame sets out. Raises OSError."""
        number = self._note(bytes(frame.data))

        def come_out(each: can.Message) -> None:
            self._note_coming_out(number)
            arrive(each)

        self._way.carry(frame, come_out)
