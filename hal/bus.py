"""The CAN bus: opening, draining without waiting, and the two ports through which frames go out."""

import contextlib
from collections.abc import Callable, Iterable
from pathlib import Path

import can

from hal.can_interface import CanInterface
from hal.errors import UserError
from hal.in_process_bus import InProcessBus
from hal.shared_bus import SharedBus
from hal.socketcan_bus import SocketCanBus
from hal.tap import Tap

CONTROL_ID = 0x01
"""Identifier of the only frame that moves the robot (docs/the-robot.md#messages)."""

_DRAIN_FRAMES = 4096
"""The most that one drain takes: a bus that is full for 10 ms carries about 200, so whatever waited when it began is
taken by it."""

_CAN_INTERFACE = "280"
"""ARPHRD_CAN, the kind of network interface that Linux shows for CAN."""
_INTERFACE_UP = 0x1
_LONGEST_FRAME = 8

_CONTROLLER_RESET = 0x040 | 0x100
"""Error frames (linux/can/error.h): bus-off, restarted. What waited in the controller then is never confirmed."""

_KINDS = "virtual:NAME, shared:NAME or a SocketCAN interface such as can0"


class BusError(UserError, OSError):
    """The bus cannot be opened or used."""


class CanBus:
    """One end of a CAN bus. CONTROL goes out through a port that exists once, all else through telemetry ports."""

    def __init__(self, name: str, open_end: Callable[[str], CanInterface]) -> None:
        """`open_end` opens the bus of that name, now and whenever it was lost. Raises what that raises: BusError."""
        self.name = name
        self.tap: Tap | None = None
        """Looks on, also after `reopen`; None: nobody."""
        self._open_bus_end = open_end
        self._bus_end: CanInterface | None = open_end(name)
        self._heard: frozenset[int] | None = None
        self._control_taken = False
        # Two counters, for each has one writer: the watchdog's thread may send while the loop drains.
        self._sent_controls = self._carried_controls = 0
        # While frames that nobody waits for any more may still be carried: the first one that was sent after them.
        self._forgotten = False
        self._first_since: bytes | None = None
        self._overruns = 0

    @property
    def overruns(self) -> int:
        """Frames since the bus was opened that were gone before the last drain, which came too late for them."""
        return self._overruns

    def set_id_filter(self, frame_ids: Iterable[int]) -> None:
        """From now on hear only frames with these standard identifiers, also after `reopen`. Raises BusError.

        CONTROL and error frames are always heard: whoever is on this bus has to know of them.
        """
        heard = frozenset(frame_ids) | {CONTROL_ID}
        self._filter(self._usable(), heard)
        self._heard = heard

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
                    if message.is_error_frame and message.arbitration_id & _CONTROLLER_RESET:
                        self._carried_controls = self._sent_controls
                        self._forgotten = False
                elif message.arbitration_id == CONTROL_ID and not message.is_extended_id:
                    self._note_carried(message)
            if end.overruns != self._overruns:
                self._overruns = end.overruns
                self._carried_controls = self._sent_controls  # their confirmations may be among the lost
                self._forgotten = False
        except (can.CanError, OSError, ValueError) as error:
            raise BusError(
                f"receiving failed ({error})", where=f"bus {self.name}", do="check adapter, cable and power"
            ) from error
        if self.tap is not None and messages:
            now_s = end.now_s()
            for message in messages:
                self.tap.on_rx(message, 0.0 if now_s is None else max(0.0, now_s - message.timestamp))
        return messages

    def telemetry_port(self) -> "FramePort":
        """A port for every frame except CONTROL."""
        return FramePort(self, is_control=False)

    def control_port(self) -> "FramePort":
        """The port for CONTROL, for the guard alone. Raises BusError when it was taken before."""
        if self._control_taken:
            raise BusError("the CONTROL port is taken", where=f"bus {self.name}", do="one guard drives one robot")
        self._control_taken = True
        return FramePort(self, is_control=True)

    def reopen(self) -> None:
        """Open the same bus anew after it was lost; ports stay valid. Raises BusError while it is still gone."""
        self.shutdown()
        end = self._open_bus_end(self.name)
        try:
            if self._heard is not None:
                self._filter(end, self._heard)
        except BusError:
            _close(end)
            raise
        self._bus_end = end

    def shutdown(self) -> None:
        """Give the bus back; may be called twice."""
        end, self._bus_end = self._bus_end, None
        self._carried_controls = self._sent_controls
        self._forgotten = False
        self._overruns = 0
        if end is not None:
            _close(end)

    def _usable(self) -> CanInterface:
        if self._bus_end is None:
            raise BusError("is shut down", where=f"bus {self.name}", do="open it again")
        return self._bus_end

    def _filter(self, end: CanInterface, heard: frozenset[int]) -> None:
        try:
            end.set_id_filter(heard)
        except (can.CanError, OSError, ValueError) as error:
            raise BusError(f"takes no receive filter ({error})", where=f"bus {self.name}") from error

    def _forget_unconfirmed(self) -> None:
        self._forgotten = self._forgotten or self._carried_controls < self._sent_controls
        self._first_since = None
        self._carried_controls = self._sent_controls

    def _note_carried(self, confirmed: can.Message) -> None:
        """One own CONTROL has been carried; one that was forgotten confirms none of those that were sent since."""
        if self._forgotten:
            if bytes(confirmed.data) != self._first_since:
                return
            self._forgotten = False  # frames keep their order: what was forgotten and has not come by now is lost
        self._carried_controls = min(self._carried_controls + 1, self._sent_controls)

    def _send(self, frame: can.Message, *, is_control: bool) -> None:
        end = self._usable()
        awaited = is_control and end.receives_own_frames
        first_since = awaited and self._forgotten and self._first_since is None
        if first_since:
            self._first_since = bytes(frame.data)
        if awaited:
            self._sent_controls += 1  # before it is out, for it may be back at once
        try:
            end.send(frame, timeout=0)
        except (can.CanError, OSError, ValueError) as error:
            if awaited:
                self._sent_controls -= 1
            if first_since:
                self._first_since = None  # a frame that did not go out is never confirmed
            raise BusError(
                f"sending failed ({error})", where=f"bus {self.name}", do="check adapter, cable and power"
            ) from error
        if self.tap is not None:
            self.tap.on_tx(frame)


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
        return self._bus._sent_controls - self._bus._carried_controls

    def forget_unconfirmed(self) -> None:
        """Count from none again: what was sent may have been lost without a word, and is then never confirmed.

        It may as well be late. Then it must not pass for what is sent from now on, as far as their payloads differ.
        """
        self._bus._forget_unconfirmed()

    def send(self, frame: can.Message) -> None:
        """Send without waiting. Raises BusError when it cannot, ValueError for a frame this port does not carry."""
        frame_id = frame.arbitration_id
        # Wider identifiers would lose their upper bits on the way out and could come out as CONTROL.
        if not 0 <= frame_id < (0x2000_0000 if frame.is_extended_id else 0x800):
            raise ValueError(f"identifier 0x{frame_id:X} does not fit its frame")
        if (frame_id == CONTROL_ID and not frame.is_extended_id) is not self._is_control:
            carries = "only CONTROL" if self._is_control else "all but CONTROL, which the guard sends"
            raise ValueError(f"bus {self._bus.name}: frame 0x{frame_id:X} refused, this port carries {carries}")
        if len(frame.data) > _LONGEST_FRAME or frame.dlc > _LONGEST_FRAME or frame.is_fd:
            raise ValueError(f"bus {self._bus.name}: frame 0x{frame_id:X} is not of classic CAN")
        self._bus._send(frame, is_control=self._is_control)


def open_bus(spec: str) -> CanBus:
    """Open one end of a bus. Raises BusError.

    `virtual:NAME` is within this process, `shared:NAME` among processes of this user on this machine, any other word is
    a SocketCAN interface such as can0.
    """
    return CanBus(spec, _end_of)


def _end_of(spec: str) -> CanInterface:
    kind, colon, name = spec.partition(":")
    if not colon:
        return _socketcan(spec)
    if kind not in ("virtual", "shared") or not name:
        raise BusError("no such kind", where=f"bus {spec!r}", do=f"give {_KINDS}")
    try:
        return InProcessBus(name) if kind == "virtual" else SharedBus(name)
    except (can.CanError, OSError) as error:
        raise BusError(f"cannot be opened ({error})", where=f"bus {spec!r}") from error


def _socketcan(interface: str) -> SocketCanBus:
    folder = Path("/sys/class/net") / interface
    try:
        kind = (folder / "type").read_text(encoding="ascii").strip()
        flags = int((folder / "flags").read_text(encoding="ascii"), base=16)
    except (OSError, ValueError) as error:
        raise BusError(
            "no such network interface",
            where=f"bus {interface!r}",
            do=(
                f"plug in the adapter, or set it up: ip link set {interface or 'can0'} up type can bitrate "
                f"1000000 (other kinds: {_KINDS})"
            ),
        ) from error
    if kind != _CAN_INTERFACE:
        raise BusError("is a network interface, but not of CAN", where=f"bus {interface!r}", do=f"give {_KINDS}")
    if not flags & _INTERFACE_UP:
        raise BusError("the interface is down", where=f"bus {interface!r}", do=f"ip link set {interface} up")
    try:
        return SocketCanBus(interface)
    except (can.CanError, OSError, AttributeError) as error:
        raise BusError(
            f"cannot be opened ({error})",
            where=f"bus {interface!r}",
            do="load the kernel's CAN modules: modprobe can_raw",
        ) from error


def _close(end: CanInterface) -> None:
    with contextlib.suppress(can.CanError, OSError):  # a bus that is gone cannot be closed any further
        end.shutdown()
