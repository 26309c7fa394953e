"""Faults of sensor boards, adapters, drivers and strangers at the ends of a cable."""

import random
import struct
from collections.abc import Callable

import can

from hal.bus import CONTROL_ID, BusError
from hal.codec import Codec
from hal.frame import Frame
from tests.stories.cable import Cable, CableInterface
from tests.stories.fault import FaultInjection
from tests.stories.table import Fault, Target

Deliver = Callable[[Frame], None]

_OTHER_ID = 0x7E
"""Identifier without receiver."""
_FLOOR_AND_PLATEAU = 620
"""Sum of the counts with nothing in view and with a wall in front of the sensor."""
_FOREIGN_COMMAND = Frame(CONTROL_ID, struct.pack(">HhhH", 2, 20, 20, 1))
"""Foreign SPEED_CM command, 0.2 m/s on both sides."""
_ROUNDING_S = 1e-9
_BUS_OFF, _RESTARTED = 0x040, 0x100
"""Classes of error frames (linux/can/error.h)."""
_STRANGER_EVERY_S = 0.004
_FRONT_BUMPER = 1
_MOST_TICKS = 32767
_SHARE = 0.3
"""Share of the frames that a poor cable loses or doubles."""


class _RobotsEnd(CableInterface):
    """Robot's end, before which a sensor board may fail."""

    def __init__(self, cable: Cable, faults: "EndFaults") -> None:
        super().__init__(cable)
        self._faults = faults

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        if self._faults.are_quiet_for(msg):
            super().send(msg, timeout)
            return
        self._check_open()
        self._faults.carry_from_board(Frame(msg.arbitration_id, bytes(msg.data)), self.send_if_open)

    def deliver(self, frame: can.Message, at_s: float, *, own: bool) -> None:
        super().deliver(frame, at_s, own=own)
        if not own and frame.arbitration_id == CONTROL_ID:
            self._faults.on_arrived(self._faults.carried, bytes(frame.data), at_s)


class _NotebooksEnd(CableInterface):
    """Notebook's end, where frames may fail in both directions."""

    def __init__(self, cable: Cable, faults: "EndFaults") -> None:
        super().__init__(cable)
        self._faults = faults

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Send a frame through the driver, or later. Raises OSError if the adapter is gone."""
        self._faults.require_plugged()
        self._check_open()
        self._faults.carry_from_notebook(Frame(msg.arbitration_id, bytes(msg.data)), self.send_if_open)

    def deliver(self, frame: can.Message, at_s: float, *, own: bool) -> None:
        if own:
            super().deliver(frame, at_s, own=True)
            return
        if self._faults.is_quiet:
            self._faults.on_heard(frame.arbitration_id, at_s)
            super().deliver(frame, at_s, own=False)
            return
        if self._faults.is_off or self._faults.is_unplugged:
            return
        # What waits in the notebook keeps its stamp and grows old; what is made there is stamped then.
        queue, now_s = super().deliver, self._cable.now_s
        arrived = Frame(frame.arbitration_id, bytes(frame.data))

        def deliver(each: Frame) -> None:
            self._faults.on_heard(each.arbitration_id, now_s())
            queue(each, at_s if each is arrived else max(at_s, now_s()), own=False)

        self._faults.carry("bus_in", arrived, lambda each: self._faults.carry("cable", each, deliver))

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Return the oldest frame or None. Raises can.CanOperationError if the adapter is gone."""
        self._faults.require_plugged()
        return super().recv(timeout)

    def hear(self, frame: Frame) -> None:
        """Receive a frame of another node; no receiver can tell who sent it."""
        self._faults.on_heard(frame.arbitration_id, self._cable.now_s())
        super().deliver(frame, self._cable.now_s(), own=False)

    def tell_error(self, frame_id: int) -> None:
        """Deliver an error frame of this machine's CAN controller."""
        error = can.Message(arbitration_id=frame_id, is_error_frame=True, data=bytes(8))
        super().deliver(error, self._cable.now_s(), own=False)


class EndFaults:
    """Ends of one cable after the other, and their faults."""

    def __init__(self, injection: FaultInjection, codec: Codec, chance: random.Random) -> None:
        self.on_sent: Callable[[int, bytes], None] = lambda _number, _payload: None
        """Callback with number and payload of each CONTROL that the driver sends."""
        self.on_arrived: Callable[[int, bytes, float], None] = lambda _number, _payload, _at_s: None
        """Callback with number, payload and time of arrival of each CONTROL that arrives at the robot."""
        self.on_heard: Callable[[int, float], None] = lambda _frame_id, _at_s: None
        """Callback with identifier and time of each frame that arrives at the notebook."""
        self.carried = 0
        """Number of the newest CONTROL that the cable carried."""
        self.is_off = False
        """True while the notebook's CAN controller is off the bus: it hears nothing, and what it sends stays in it."""
        self.is_unplugged = False
        """True while the notebook has no CAN adapter."""
        self._time, self._injection = injection.time, injection
        self._codec, self._chance = codec, chance
        self._board_of: dict[int, Target] = {
            codec.message("ENCODER").frame_id: "encoders",
            codec.message("BUMPERC").frame_id: "bumpers",
        }
        self._end: _NotebooksEnd | None = None
        self._held: dict[int, Frame] = {}
        for frame_id, message in codec.by_id.items():
            if message.name.startswith(("ADC", "BDC")):
                self._board_of[frame_id] = "sensor_board_1" if message.name.startswith("ADC") else "sensor_board_2"
        self._sound: dict[int, Frame] = {}
        """Newest frame of each identifier while nothing failed."""
        self._newest: dict[tuple[Target, int], Frame] = {}
        """Newest frame that passed a target since something fails."""
        self._passed_at_s: dict[tuple[Target, int], float] = {}
        self._next_out_s = 0.0
        self._sent = 0
        self.replace_cable()

    def replace_cable(self) -> None:
        """Take another cable; ends that are opened from now on are on it."""
        self._cable = Cable(self._time.now_s)

    def open_robots_end(self, _: str) -> CableInterface:
        return self._cable.join(_RobotsEnd(self._cable, self))

    def open_notebooks_end(self, _: str) -> CableInterface:
        """Return a new end of the notebook. Raises BusError while the adapter is gone."""
        if self.is_unplugged:
            raise BusError("the adapter is gone")
        self._end = _NotebooksEnd(self._cable, self)
        return self._cable.join(self._end)

    @property
    def is_quiet(self) -> bool:
        """True if no fault is planned or under way."""
        return self._injection.is_quiet

    def are_quiet_for(self, frame: can.Message) -> bool:
        """Return whether nothing fails, and note the frame if so: most frames need no more."""
        if not self._injection.is_quiet or not isinstance(frame, Frame):
            return False
        self._sound[frame.arbitration_id] = frame
        if self._newest:
            self._newest.clear()
        return True

    def begin(self, fault: Fault) -> None:
        """Do what a fault does at its beginning: a controller leaves the bus, a stranger begins to send."""
        self._set_controller(fault, acts=True)
        if fault.kind == "bus_off" and self._end is not None:
            self._end.tell_error(_BUS_OFF)
        if fault.target == "stranger":
            self._send_as_stranger(fault)

    def finish(self, fault: Fault) -> None:
        """Do what a fault does at its end: a controller comes back to the bus."""
        self._set_controller(fault, acts=False)
        if fault.kind == "bus_off" and self._end is not None:
            self._end.tell_error(_RESTARTED)

    def require_plugged(self) -> None:
        """Raise can.CanOperationError while the adapter is gone."""
        if self.is_unplugged:
            raise can.CanOperationError("the adapter is gone")

    def _set_controller(self, fault: Fault, *, acts: bool) -> None:
        if fault.target == "controller":
            self.is_off, self.is_unplugged = acts and fault.kind == "bus_off", acts and fault.kind == "unplugged"
            self._injection.acted.add(fault)

    def _send_as_stranger(self, fault: Fault) -> None:
        """Send what only the robot should send, or anything, until the fault is over."""
        now_s, chance = self._time.now_s(), self._chance
        if now_s >= fault.end_s or self._end is None:
            return
        readings = list(self._sound.values())
        if fault.kind == "telemetry" and readings:
            self._end.hear(chance.choice(readings))
        elif fault.kind == "garbage":
            self._end.hear(Frame(chance.randrange(0x100, 0x800), chance.randbytes(chance.randrange(9))))
        self._injection.acted.add(fault)
        self._time.at(now_s + _STRANGER_EVERY_S, lambda: self._send_as_stranger(fault))

    def carry_from_board(self, frame: Frame, send: Deliver) -> None:
        """Carry a frame of a board of the robot."""
        board = self._board_of.get(frame.arbitration_id)
        if board is None:
            send(frame)
        else:
            self.carry(board, frame, send)

    def carry(self, target: Target, frame: Frame, deliver: Deliver) -> None:
        """Deliver a frame of the robot, changed, late or never while the fault of a target acts."""
        key, now_s = (target, frame.arbitration_id), self._time.now_s()
        fault = self._injection.acting_on(target)
        if fault is None:
            self._newest[key] = frame
            deliver(frame)
            return
        match fault.kind:
            case "off" | "intermittent":
                return
            case "stuck":
                # A stuck encoder repeats its count: no ticks since the last frame.
                again = (
                    self._codec.message("ENCODER").pack(0, 0)
                    if target == "encoders"
                    else self._newest.get(key) or self._sound[frame.arbitration_id]
                )
                deliver(Frame(frame.arbitration_id, again.data))
            case "garbage":
                deliver(Frame(frame.arbitration_id, self._chance.randbytes(len(frame.data))))
            case "wrong":
                for each in self._falsify(target, frame):
                    deliver(each)
            case "slow":
                passed_at_s = max(self._passed_at_s.get(key, 0.0), fault.begin_s)
                if now_s - passed_at_s > fault.period_s - _ROUNDING_S:
                    self._passed_at_s[key] = now_s
                    deliver(frame)
            case "delayed":
                self._deliver_late(fault, now_s + fault.delay_s, lambda: deliver(frame))
            case "pressed":
                deliver(self._codec.by_id[frame.arbitration_id].pack(_FRONT_BUMPER, 0))
            case "jump":
                ticks = self._chance.choice((-_MOST_TICKS, _MOST_TICKS))
                deliver(self._codec.by_id[frame.arbitration_id].pack(ticks, ticks))
            case "lost" | "doubled" | "reordered":
                self._carry_poorly(fault, frame, deliver)

    def _carry_poorly(self, fault: Fault, frame: Frame, deliver: Deliver) -> None:
        """Lose or double some frames, or let two with the same identifier change places."""
        held = self._held.pop(frame.arbitration_id, None)
        if fault.kind == "reordered" and held is None:
            self._held[frame.arbitration_id] = frame
            return
        chosen = fault.kind != "reordered" and self._chance.random() < _SHARE
        if not (chosen and fault.kind == "lost"):
            deliver(frame)
        if held is not None or (chosen and fault.kind == "doubled"):
            deliver(held or frame)

    def _falsify(self, target: Target, frame: Frame) -> list[Frame]:
        """Return plausible, but false frames in place of a right one."""
        message = self._codec.by_id[frame.arbitration_id]
        if target == "encoders":
            return [message.pack(*(-ticks for ticks in message.unpack(frame.data)))]
        if target == "bus_in":
            return [frame, _FOREIGN_COMMAND] if message.name == "BUMPERC" else [frame]
        return [message.pack(*(max(0, _FLOOR_AND_PLATEAU - each) for each in message.unpack(frame.data)))]

    def carry_from_notebook(self, frame: Frame, send: Deliver) -> None:
        """Carry a CONTROL of the driver. Raises OSError if the adapter is gone."""
        self._sent += 1
        number, now_s = self._sent, self._time.now_s()
        self.on_sent(number, frame.data)

        def send_numbered(each: Frame) -> None:
            self.carried = number
            send(each)

        if self.is_off:
            return
        fault = self._injection.acting_on("bus_out")
        if fault is None:
            send_numbered(frame)
            return
        match fault.kind:
            case "off":
                raise OSError("Network is down")
            case "stuck":
                self._deliver_late(fault, fault.end_s, lambda: send_numbered(frame))
            case "garbage":
                # Of no mode that moves it: a set point that chance makes is the cable's, and would be judged.
                send_numbered(Frame(CONTROL_ID, b"\xee" + self._chance.randbytes(len(frame.data) - 1)))
            case "wrong":
                send_numbered(Frame(_OTHER_ID, frame.data))
            case "slow":
                self._next_out_s = max(self._next_out_s, now_s) + fault.period_s
                self._deliver_late(fault, self._next_out_s, lambda: send_numbered(frame))
            case "delayed":
                self._deliver_late(fault, now_s + fault.delay_s, lambda: send_numbered(frame))
            case "intermittent":
                return

    def _deliver_late(self, fault: Fault, at_s: float, deliver: Callable[[], None]) -> None:
        """Deliver at `at_s`; the end of the fault delivers what is left, in order."""
        self._time.at(min(at_s, fault.end_s), deliver)
