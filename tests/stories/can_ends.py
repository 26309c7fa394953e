"""Ends of KURT2's cable: faults of sensor boards, adapters, drivers and strangers."""

import random
import struct
from collections.abc import Callable, Iterable

import can

from hal.bus import CONTROL_ID, BusError, CanBus
from hal.codec import load_codec
from hal.frame import Frame
from hal.guarded_robot import GuardedRobot
from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings
from simbridge.robot.wheels import Wheels
from simbridge.simulated_robot import SimulatedKurt2, SimulatedRobot
from simbridge.worlds.world_settings import WorldSettings
from tests.stories.cable import Cable, CableInterface
from tests.stories.ends import Ends
from tests.stories.fault import FaultInjection
from tests.stories.poor_link import PoorLink
from tests.stories.table import Fault, Target
from tests.stories.wire import KURT2

Deliver = Callable[[Frame], None]

_OTHER_ID = 0x7E
"""Identifier without receiver."""
_FLOOR_AND_PLATEAU = 620
"""Sum of the counts with nothing in view and with a wall in front of the sensor."""
_FOREIGN_COMMAND = Frame(CONTROL_ID, struct.pack(">HhhH", 2, 20, 20, 1))
"""Foreign SPEED_CM command, 0.2 m/s on both sides."""
_BUS_OFF, _RESTARTED = 0x040, 0x100
"""Classes of error frames (linux/can/error.h)."""
_FRONT_BUMPER = 1
_MOST_TICKS = 32767


class _End(CableInterface):
    def __init__(self, cable: Cable, ends: "CanEnds") -> None:
        super().__init__(cable)
        self._ends = ends


class _RobotsEnd(_End):
    """Robot's end, before which a sensor board may fail."""

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        self._check_open()
        assert isinstance(msg, Frame)
        self._ends.carry_from_board(msg, self.send_if_open)

    def deliver(self, frame: can.Message, at_s: float, *, own: bool) -> None:
        super().deliver(frame, at_s, own=own)
        if not own and frame.arbitration_id == CONTROL_ID:
            self._ends.on_arrived(self._ends.carried, bytes(frame.data), at_s)


class _NotebooksEnd(_End):
    """Notebook's end, where frames may fail in both directions."""

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Send a frame through the driver, or later. Raises OSError if the adapter is gone."""
        self._require_plugged()
        self._check_open()
        assert isinstance(msg, Frame)
        self._ends.carry_from_notebook(msg, self.send_if_open)

    def deliver(self, frame: can.Message, at_s: float, *, own: bool) -> None:
        if own:
            super().deliver(frame, at_s, own=True)
            return
        # What waits in the notebook keeps its stamp and grows old; what is made there is stamped then.
        queue, now_s = super().deliver, self._cable.now_s

        def deliver(each: Frame) -> None:
            self._ends.on_heard(each.arbitration_id, each.data, now_s())
            queue(each, at_s if each is frame else max(at_s, now_s()), own=False)

        assert isinstance(frame, Frame)
        self._ends.carry_to_notebook(frame, deliver)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Return the oldest frame or None. Raises can.CanOperationError if the adapter is gone."""
        self._require_plugged()
        return super().recv(timeout)

    def hear(self, frame: Frame) -> None:
        """Receive a frame of another node; no receiver can tell who sent it."""
        self._ends.on_heard(frame.arbitration_id, frame.data, self._cable.now_s())
        super().deliver(frame, self._cable.now_s(), own=False)

    def tell_error(self, frame_id: int) -> None:
        """Deliver an error frame of this machine's CAN controller."""
        error = can.Message(arbitration_id=frame_id, is_error_frame=True, data=bytes(8))
        super().deliver(error, self._cable.now_s(), own=False)

    def _require_plugged(self) -> None:
        if self._ends.back_at_s:
            raise can.CanOperationError("the adapter is gone")


class CanEnds(Ends):
    """Ends of one cable after the other."""

    target = "controller"
    wire = KURT2
    speaks_every_s = 0.004

    def __init__(self, settings: Kurt2Settings, injection: FaultInjection, chance: random.Random) -> None:
        super().__init__(injection, chance)
        self.carried = 0
        """Number of the newest CONTROL that the cable carried."""
        self._settings, self._codec = settings, load_codec(settings.can.database)

        def poor(target: Target) -> PoorLink[Frame]:
            return PoorLink(injection, target, chance, self._instead)

        self._bus_in, self._bus_out, self._poor_cable = poor("bus_in"), poor("bus_out"), poor("cable")
        boards = {"ENCODER": poor("encoders"), "BUMPERC": poor("bumpers")}
        boards |= {"ADC": poor("sensor_board_1"), "BDC": poor("sensor_board_2")}
        self._board_of = {
            frame_id: board
            for frame_id, message in self._codec.by_id.items()
            for name, board in boards.items()
            if message.name.startswith(name)
        }
        self._next_out_s = 0.0
        self._cable = Cable(self._time.now_s)
        self._robots_bus = CanBus("cable", lambda _: self._cable.join(_RobotsEnd(self._cable, self)))
        self._robots_bus.set_id_filter({CONTROL_ID})
        self._end = _NotebooksEnd(self._cable, self)

    def simulated(self, world: WorldSettings, seed: int, wheels: Wheels) -> SimulatedRobot:
        return SimulatedKurt2(self._settings, world, self._robots_bus, seed, wheels=wheels)

    def start_driver(self) -> GuardedRobot:
        self._cable = Cable(self._time.now_s)
        self._robots_bus.reopen()
        self.bus = CanBus("cable", self._open_notebooks_end)
        return Kurt2(self._settings, self.bus, watchdog_clock=self._time.now_s)

    def begin(self, fault: Fault) -> None:
        super().begin(fault)
        if fault.kind == "bus_off":
            self._end.tell_error(_BUS_OFF)

    def finish(self, fault: Fault) -> None:
        super().finish(fault)
        if fault.kind == "bus_off":
            self._end.tell_error(_RESTARTED)

    def carry_from_board(self, frame: Frame, send: Deliver) -> None:
        """Carry a frame of a board of the robot."""
        board = self._board_of.get(frame.arbitration_id)
        if board is None:
            send(frame)
        else:
            board.carry(frame, send, frame.arbitration_id)

    def carry_to_notebook(self, frame: Frame, deliver: Deliver) -> None:
        """Carry a frame of the robot to the driver."""
        if not self._is_off:
            key, cable = frame.arbitration_id, self._poor_cable
            self._bus_in.carry(frame, lambda each: cable.carry(each, deliver, key), key)

    def carry_from_notebook(self, frame: Frame, send: Deliver) -> None:
        """Carry a CONTROL of the driver. Raises OSError if the interface is down."""
        number, now_s = self._note_sent(frame.data), self._time.now_s()

        def send_numbered(each: Frame) -> None:
            self.carried = number
            send(each)

        if self._is_off:
            return
        fault = self._injection.acting_on("bus_out")
        if fault is not None and fault.kind == "off":
            raise OSError("Network is down")
        if fault is not None and fault.kind in ("stuck", "slow"):  # a queue, from which none is lost
            self._next_out_s = max(self._next_out_s, now_s) + fault.period_s
            due_s = self._next_out_s if fault.kind == "slow" else fault.end_s
            self._time.at(min(due_s, fault.end_s), lambda: send_numbered(frame))
        else:
            self._bus_out.carry(frame, send_numbered)

    @property
    def _is_off(self) -> bool:
        """True while the notebook's controller is off the bus or gone: it hears nothing, and keeps what it is given."""
        fault = self._injection.acting_on("controller")
        return fault is not None and fault.kind != "restart"

    def _open_notebooks_end(self, _: str) -> CableInterface:
        """Return a new end of the notebook. Raises BusError while the adapter is gone."""
        if self.back_at_s:
            raise BusError("the adapter is gone")
        self._end = _NotebooksEnd(self._cable, self)
        return self._cable.join(self._end)

    def _say(self, fault: Fault, *, over: bool) -> None:
        """Send what only the robot should send, or anything."""
        chance, readings = self._chance, list(self._bus_in.newest.values())
        if not over and fault.kind == "garbage":
            self._end.hear(Frame(chance.randrange(0x100, 0x800), chance.randbytes(chance.randrange(9))))
        elif not over and readings:
            self._end.hear(chance.choice(readings))

    def _instead(self, fault: Fault, frame: Frame, newest: Frame) -> Iterable[Frame]:
        """Return what a faulty part gives in place of a frame: nonsense, or what is plausible, but false."""
        frame_id, messages, chance = frame.arbitration_id, self._codec.by_id, self._chance
        match fault.target, fault.kind:
            case "encoders", "stuck":
                return [messages[frame_id].pack(0, 0)]  # a count that stands still: no ticks since the last frame
            case "encoders", "wrong":
                return [messages[frame_id].pack(*(-ticks for ticks in messages[frame_id].unpack(frame.data)))]
            case "encoders", "jump":
                ticks = chance.choice((-_MOST_TICKS, _MOST_TICKS))
                return [messages[frame_id].pack(ticks, ticks)]
            case "bumpers", "pressed":
                return [messages[frame_id].pack(_FRONT_BUMPER, 0)]
            case "bus_in", "wrong":
                return [frame, _FOREIGN_COMMAND] if messages[frame_id].name == "BUMPERC" else [frame]
            case "bus_out", "wrong":
                return [Frame(_OTHER_ID, frame.data)]
            case "bus_out", "garbage":
                # Of no mode that moves it: a set point that chance makes is the cable's, and would be judged.
                return [Frame(CONTROL_ID, b"\xee" + chance.randbytes(len(frame.data) - 1))]
            case _, "wrong":
                counts = messages[frame_id].unpack(frame.data)
                return [messages[frame_id].pack(*(max(0, _FLOOR_AND_PLATEAU - each) for each in counts))]
            case _, "stuck":
                return [Frame(frame_id, newest.data)]
            case _, "garbage":
                return [Frame(frame_id, chance.randbytes(len(frame.data)))]
        return [frame]
