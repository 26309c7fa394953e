"""Faults of sensor boards, adapters and drivers at the ends of a cable."""

import random
import struct
from collections.abc import Callable

import can

from hal.bus import CONTROL_ID
from hal.codec import Codec
from hal.frame import Frame
from tests.faults.cable import SOUND, Cable, CableFaults, CableInterface
from tests.faults.fault import Fault, FaultInjection
from tests.faults.table import Target

Deliver = Callable[[Frame], None]

_OTHER_ID = 0x7E
"""Identifier without receiver."""
_FLOOR_AND_PLATEAU = 620
"""Sum of the counts with nothing in view and with a wall in front of the sensor."""
_FOREIGN_COMMAND = Frame(CONTROL_ID, struct.pack(">HhhH", 2, 20, 20, 1))
"""Foreign SPEED_CM command, 0.2 m/s on both sides."""
_ROUNDING_S = 1e-9


class _RobotsEnd(CableInterface):
    """Robot's end, before which a sensor board may fail."""

    def __init__(self, cable: Cable, faults: "EndFaults") -> None:
        super().__init__(cable)
        self._faults = faults

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        send = super().send
        self._faults.carry_from_board(Frame(msg.arbitration_id, bytes(msg.data)), lambda each: send(each, timeout))

    def deliver(self, frame: can.Message, at_s: float, *, own: bool) -> None:
        super().deliver(frame, at_s, own=own)
        if not own and frame.arbitration_id == CONTROL_ID:
            self._faults.on_arrived(self._faults.carried, bytes(frame.data), at_s)


class _NotebooksEnd(CableInterface):
    """Notebook's end, where frames may fail in both directions."""

    def __init__(self, cable: Cable, faults: "EndFaults") -> None:
        super().__init__(cable)
        self._faults = faults

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send a frame through the driver, or later. Raises OSError if the adapter is gone."""
        send = super().send
        self._faults.carry_from_notebook(Frame(msg.arbitration_id, bytes(msg.data)), lambda each: send(each, timeout))

    def deliver(self, frame: can.Message, at_s: float, *, own: bool) -> None:
        if own:
            super().deliver(frame, at_s, own=True)
            return
        # What waits in the notebook keeps its stamp and grows old; what is made there is stamped then.
        queue, now_s = super().deliver, self._cable.now_s
        arrived = Frame(frame.arbitration_id, bytes(frame.data))
        self._faults.carry(
            "bus_in", arrived, lambda each: queue(each, at_s if each is arrived else max(at_s, now_s()), own=False)
        )


class EndFaults:
    """Ends of one cable after the other, and their faults."""

    def __init__(self, injection: FaultInjection, codec: Codec, chance: random.Random) -> None:
        self.on_sent: Callable[[int, bytes], None] = lambda _number, _payload: None
        """Callback with number and payload of each CONTROL that the driver sends."""
        self.on_arrived: Callable[[int, bytes, float], None] = lambda _number, _payload, _at_s: None
        """Callback with number, payload and time of arrival of each CONTROL that arrives at the robot."""
        self.carried = 0
        """Number of the newest CONTROL that the cable carried."""
        self._time, self._injection = injection.time, injection
        self._codec, self._chance = codec, chance
        self._board_of: dict[int, Target] = {codec.message("ENCODER").frame_id: "encoders"}
        for frame_id, message in codec.by_id.items():
            if message.name.startswith(("ADC", "BDC")):
                self._board_of[frame_id] = "sensor_board_1" if message.name.startswith("ADC") else "sensor_board_2"
        self._newest: dict[tuple[Target, int], Frame] = {}
        self._passed_at_s: dict[tuple[Target, int], float] = {}
        self._next_out_s = 0.0
        self._sent = 0
        self.replace_cable(SOUND)

    def replace_cable(self, faults: CableFaults) -> None:
        """Take another cable; ends that are opened from now on are on it."""
        self._cable = Cable(self._time.now_s, faults, self._chance)

    def open_robots_end(self, _: str) -> CableInterface:
        return self._cable.join(_RobotsEnd(self._cable, self))

    def open_notebooks_end(self, _: str) -> CableInterface:
        return self._cable.join(_NotebooksEnd(self._cable, self))

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
                again = self._codec.message("ENCODER").pack(0, 0) if target == "encoders" else self._newest[key]
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
                send_numbered(Frame(CONTROL_ID, self._chance.randbytes(len(frame.data))))
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
