"""The CAN bus: opening, draining without waiting, and the two ports through which frames go out."""

import contextlib
from collections.abc import Callable, Iterable
from pathlib import Path

import can

from hal.bus_end import BusEnd
from hal.in_process_bus import InProcessBus
from hal.socketcan_bus import SocketCanBus
from hal.tap import Tap

CONTROL_ID = 0x01
"""Identifier of the only frame that moves the robot (reference 1.2)."""

_DRAIN_FRAMES = 4096
"""The most that one drain takes: a bus that is full for 10 ms carries about 200, so whatever waited when it began is
taken by it."""

_CAN_INTERFACE = "280"
"""ARPHRD_CAN, the kind of network interface that Linux shows for CAN."""


class BusError(OSError):
    """The bus cannot be opened or used. The message is one line: bus, what happened, what to do."""


class CanBus:
    """One end of a CAN bus. CONTROL goes out through a port that exists once, all else through telemetry ports."""

    def __init__(self, name: str, open_end: Callable[[str], BusEnd]) -> None:
        """`open_end` opens the bus of that name, now and whenever it was lost. Raises what that raises: BusError."""
        self.name = name
        self.tap: Tap | None = None
        """Looks on, also after `reopen`; None: nobody."""
        self._open_bus_end = open_end
        self._bus_end: BusEnd | None = open_end(name)
        self._heard: frozenset[int] | None = None
        self._control_taken = False
        self._unconfirmed = 0

    def listen_to(self, frame_ids: Iterable[int]) -> None:
        """From now on hear only frames with these standard identifiers, and error frames; also after `reopen`."""
        self._heard = frozenset(frame_ids)
        self._usable().listen_to(self._heard)

    def now_s(self) -> float | None:
        """The present on the clock of the frames' time stamps; None where they count as just arrived. BusError."""
        return self._usable().now_s()

    def drain(self) -> list[can.Message]:
        """Every frame of others that waits, oldest first, without blocking. Raises BusError when the bus is gone."""
        end = self._usable()
        messages: list[can.Message] = []
        try:
            for _ in range(_DRAIN_FRAMES):
                message = end.recv(0)
                if message is None:
                    break
                if message.is_rx:
                    messages.append(message)
                elif message.arbitration_id == CONTROL_ID and self._unconfirmed:
                    self._unconfirmed -= 1
        except (can.CanError, OSError, ValueError) as error:
            raise BusError(f"bus {self.name}: receiving failed ({error}); check adapter, cable and power") from error
        if self.tap is not None and messages:
            now_s = end.now_s()
            for message in messages:
                self.tap.heard(message, 0.0 if now_s is None else max(0.0, now_s - message.timestamp))
        return messages

    def telemetry_port(self) -> "FramePort":
        """A port for every frame except CONTROL."""
        return FramePort(self, is_control=False)

    def control_port(self) -> "FramePort":
        """The port for CONTROL, for the guard alone. Raises BusError when it was taken before."""
        if self._control_taken:
            raise BusError(f"bus {self.name}: the CONTROL port is taken; one guard drives one robot")
        self._control_taken = True
        return FramePort(self, is_control=True)

    def reopen(self) -> None:
        """Open the same bus anew after it was lost; ports stay valid. Raises BusError while it is still gone."""
        self.shutdown()
        end = self._bus_end = self._open_bus_end(self.name)
        if self._heard is not None:
            end.listen_to(self._heard)

    def shutdown(self) -> None:
        """Give the bus back; may be called twice."""
        end, self._bus_end = self._bus_end, None
        self._unconfirmed = 0
        if end is not None:
            with contextlib.suppress(can.CanError, OSError):  # a bus that is gone cannot be closed any further
                end.shutdown()

    def _usable(self) -> BusEnd:
        if self._bus_end is None:
            raise BusError(f"bus {self.name}: is shut down; open it again")
        return self._bus_end

    def _send(self, frame: can.Message) -> None:
        end = self._usable()
        try:
            end.send(frame, timeout=0)
        except (can.CanError, OSError, ValueError) as error:
            raise BusError(f"bus {self.name}: sending failed ({error}); check adapter, cable and power") from error
        if end.confirms and frame.arbitration_id == CONTROL_ID:
            self._unconfirmed += 1
        if self.tap is not None:
            self.tap.sent(frame)


class FramePort:
    """A way out to the bus that lets through either CONTROL alone or everything else."""

    def __init__(self, bus: CanBus, *, is_control: bool) -> None:
        self._bus = bus
        self._is_control = is_control

    @property
    def unconfirmed(self) -> int:
        """CONTROL frames that were sent and that the bus has not carried yet, as far as the last drain knows.

        Always 0 on a bus that does not confirm.
        """
        return self._bus._unconfirmed

    def send(self, frame: can.Message) -> None:
        """Send without waiting. Raises BusError when it cannot, ValueError for a frame this port does not carry."""
        frame_id = frame.arbitration_id
        # Wider identifiers would lose their upper bits on the way out and could come out as CONTROL.
        if not 0 <= frame_id < (0x2000_0000 if frame.is_extended_id else 0x800):
            raise ValueError(f"identifier 0x{frame_id:X} does not fit its frame")
        if (frame_id == CONTROL_ID and not frame.is_extended_id) is not self._is_control:
            carries = "only CONTROL" if self._is_control else "all but CONTROL, which the guard sends"
            raise ValueError(f"bus {self._bus.name}: frame 0x{frame_id:X} refused, this port carries {carries}")
        self._bus._send(frame)


def open_bus(spec: str) -> CanBus:
    """Open one end of a bus: `virtual:NAME` within this process, or a SocketCAN interface such as can0. BusError."""
    return CanBus(spec, _end_of)


def _end_of(spec: str) -> BusEnd:
    kind, colon, name = spec.partition(":")
    if colon:
        if kind != "virtual" or not name:
            raise BusError(f"bus {spec!r}: no such kind; give virtual:NAME or a SocketCAN interface such as can0")
        return InProcessBus(name)
    try:
        kind = Path(f"/sys/class/net/{spec}/type").read_text(encoding="ascii").strip()
    except (OSError, ValueError) as error:
        raise BusError(
            f"bus {spec!r}: no such network interface; plug in the adapter, or set it up: "
            f"ip link set {spec or 'can0'} up type can bitrate 1000000"
        ) from error
    if kind != _CAN_INTERFACE:
        raise BusError(f"bus {spec!r}: is a network interface, but not of CAN; give one such as can0")
    try:
        return SocketCanBus(spec)
    except (can.CanError, OSError, AttributeError) as error:
        raise BusError(
            f"bus {spec!r}: cannot be opened ({error}); load the kernel's CAN modules: modprobe can_raw"
        ) from error
