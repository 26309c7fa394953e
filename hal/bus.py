"""CAN bus: opening, draining without waiting, and the two ports through which frames are sent."""

import contextlib
import errno
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Protocol

import can

from config.errors import UserError
from hal import points
from hal.frame import Frame
from hal.in_process_bus import InProcessBus
from hal.shared_bus import SharedBus
from hal.socketcan_bus import SocketCanBus
from hal.tap import Tap


class CanInterface(Protocol):
    """One end of a CAN bus of any kind: SocketCAN, between programs, or in memory (an interface of python-can).

    Nothing here waits; errors are can.CanError, OSError or ValueError.

    A frame arrives once at every other end, in the order in which the bus carried it. Error frames of the bus are
    delivered too (`is_error_frame`, laid out as Linux does).
    """

    receives_own_frames: bool
    """True if an end also receives its own frames (`is_rx` False), as soon as the bus has carried them."""

    overruns: int
    """Frames lost since the end was opened because it read too late."""

    def now_s(self) -> float | None:
        """Return the present in s on the clock that stamps the frames; None if frames count as just arrived."""
        ...

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Deliver only frames with these standard identifiers, and error frames.

        Raises can.CanError or OSError.
        """
        ...

    def recv(self, timeout: float | None) -> can.Message | None:
        """Return the oldest waiting frame, or None; called with `timeout` 0 seconds.

        Raises can.CanError or OSError on every call after the bus is lost, so silence is never taken for a quiet bus.
        """
        ...

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send a frame, also after failures; called with `timeout` 0 seconds.

        Raises can.CanError or OSError if the bus does not take it, ValueError for a frame that is not classic CAN.
        """
        ...

    def shutdown(self) -> None:
        """Close this end; may be called twice."""
        ...


CONTROL_ID = 0x01
"""Identifier of the only frame that moves the robot (docs/the-robot.md#messages)."""

DRAIN_FRAMES = 4096
"""Most frames of one drain. A full bus carries about 200 in 10 ms, so one drain takes all that waited at its start."""

_CAN_INTERFACE = "280"
"""ARPHRD_CAN, the kind of network interface that Linux shows for CAN."""
_INTERFACE_UP = 0x1
_LONGEST_FRAME = 8

_CONTROLLER_RESET = 0x040 | 0x100
"""Error frames (linux/can/error.h): bus-off, restarted. Frames in the controller are then never confirmed."""

_KINDS = "virtual:NAME, shared:NAME or a SocketCAN interface such as can0"


class BusError(UserError, OSError):
    """Link to the robot, of CAN or another kind, that cannot be opened or used."""


class CanBus:
    """One end of a CAN bus. CONTROL goes out through a port that exists once, all else through telemetry ports."""

    def __init__(self, name: str, open_interface: Callable[[str], CanInterface]) -> None:
        """Open the bus by `open_interface`, which opens it again after it was lost. Raises BusError."""
        self.name = name
        self.tap: Tap | None = None
        """Observer of all frames, also after `reopen`; None for no observer."""
        self._open_can_interface = open_interface
        self._can_interface: CanInterface | None = None
        self._in_process: InProcessBus | None = None
        """The interface, if it takes and gives many frames in one call; a subclass may want to see each frame."""
        self._connect(open_interface(name))
        self._filter_ids: frozenset[int] | None = None
        self._control_taken = False
        # Two counters, because each has one writer: the watchdog's thread may send while the loop drains.
        self._sent_controls = self._carried_controls = 0
        # True while forgotten frames may still be carried; then the payload of the first frame sent after them.
        self._forgotten = False
        self._first_since: bytes | None = None
        self._overruns = 0

    @property
    def overruns(self) -> int:
        """Frames lost since the bus was opened because they were not drained in time."""
        return self._overruns

    def set_id_filter(self, frame_ids: Iterable[int]) -> None:
        """Receive only frames with these standard identifiers, also after `reopen`. Raises BusError.

        CONTROL and error frames always pass: another sender of CONTROL must not go unnoticed.
        """
        ids = frozenset(frame_ids) | {CONTROL_ID}
        self._filter(self._usable(), ids)
        self._filter_ids = ids

    def now_s(self) -> float | None:
        """Return the present in s on the clock of the time stamps; None if frames count as just arrived.

        Raises BusError.
        """
        return self._usable().now_s()

    def drain(self) -> list[can.Message]:
        """Return the waiting frames of other senders, oldest first, without blocking. Raises BusError.

        Their sender may keep them, so they must not change.
        """
        interface = self._usable()
        if points.happens("frames wait a cycle"):
            return []
        try:
            if self._in_process is not None:
                messages = self._in_process.recv_all(DRAIN_FRAMES)  # an end that confirms no frames and loses none
            else:
                messages = self._receive(interface)
        except (can.CanError, OSError, ValueError) as error:
            raise BusError(
                f"receiving failed ({error})", where=f"bus {self.name}", do="check adapter, cable and power"
            ) from error
        if self.tap is not None and messages:
            now_s = interface.now_s()
            for message in messages:
                self.tap.on_rx(message, 0.0 if now_s is None else max(0.0, now_s - message.timestamp))
        return messages

    def telemetry_port(self) -> "FramePort":
        """Return a port for every frame except CONTROL."""
        return FramePort(self, is_control=False)

    def control_port(self) -> "FramePort":
        """Return the port for CONTROL, for the guard alone. Raises BusError if it was taken before."""
        if self._control_taken:
            raise BusError("the CONTROL port is taken", where=f"bus {self.name}", do="one guard drives one robot")
        self._control_taken = True
        return FramePort(self, is_control=True)

    def reopen(self) -> None:
        """Open the bus again after it was lost; ports stay valid. Raises BusError while it is still lost."""
        self.shutdown()
        interface = self._open_can_interface(self.name)
        try:
            if self._filter_ids is not None:
                self._filter(interface, self._filter_ids)
        except BusError:
            _close(interface)
            raise
        self._connect(interface)

    def shutdown(self) -> None:
        """Close the bus; may be called twice."""
        interface = self._can_interface
        self._connect(None)
        self._carried_controls = self._sent_controls
        self._forgotten = False
        self._overruns = 0
        if interface is not None:
            _close(interface)

    def _connect(self, interface: CanInterface | None) -> None:
        """Use an interface from now on; None: none."""
        self._can_interface = interface
        self._in_process = interface if type(interface) is InProcessBus else None

    def _receive(self, interface: CanInterface) -> list[can.Message]:
        """Return the waiting frames of other senders, and count own CONTROL frames that come back."""
        messages: list[can.Message] = []
        for _ in range(DRAIN_FRAMES):
            message = interface.recv(0)
            if message is None:
                break
            if message.is_rx:
                messages.append(message)
                if message.is_error_frame and message.arbitration_id & _CONTROLLER_RESET:
                    self._carried_controls = self._sent_controls
                    self._forgotten = False
            elif message.arbitration_id == CONTROL_ID and not message.is_extended_id:
                self._note_carried(message)
        if interface.overruns != self._overruns:
            self._overruns = interface.overruns
            self._carried_controls = self._sent_controls  # their confirmations may be among the lost
            self._forgotten = False
        return messages

    def _usable(self) -> CanInterface:
        if self._can_interface is None:
            raise BusError("is shut down", where=f"bus {self.name}", do="open it again")
        return self._can_interface

    def _filter(self, interface: CanInterface, frame_ids: frozenset[int]) -> None:
        try:
            interface.set_id_filter(frame_ids)
        except (can.CanError, OSError, ValueError) as error:
            raise BusError(f"takes no receive filter ({error})", where=f"bus {self.name}") from error

    def _forget_unconfirmed(self) -> None:
        self._forgotten = self._forgotten or self._carried_controls < self._sent_controls
        self._first_since = None
        self._carried_controls = self._sent_controls

    def _note_carried(self, confirmed: can.Message) -> None:
        """Count one own CONTROL as carried; a forgotten frame does not confirm a later one."""
        if self._forgotten:
            if bytes(confirmed.data) != self._first_since:
                return
            self._forgotten = False  # frames keep their order: what was forgotten and has not come by now is lost
        self._carried_controls = min(self._carried_controls + 1, self._sent_controls)

    def _send(self, frame: can.Message, *, is_control: bool) -> None:
        interface = self._usable()
        awaited = is_control and interface.receives_own_frames
        first_since = awaited and self._forgotten and self._first_since is None
        if first_since:
            self._first_since = bytes(frame.data)
        if awaited:
            self._sent_controls += 1  # before it is out, for it may be back at once
        try:
            if is_control:
                points.fail("the send queue is full", OSError, errno.ENOBUFS, "No buffer space available")
            interface.send(frame, timeout=0)
        except (can.CanError, OSError, ValueError) as error:
            if awaited:
                self._sent_controls -= 1
            if first_since:
                self._first_since = None  # a frame that did not go out is never confirmed
            raise self._sending_failed(error) from error
        if self.tap is not None:
            self.tap.on_tx(frame)

    def _send_all(self, frames: Sequence[Frame]) -> None:
        """Send frames that are not CONTROL, in order."""
        if self._in_process is None or self.tap is not None:
            for frame in frames:
                self._send(frame, is_control=False)
            return
        try:
            self._in_process.send_all(frames)
        except (can.CanError, OSError, ValueError) as error:
            raise self._sending_failed(error) from error

    def _sending_failed(self, error: Exception) -> BusError:
        return BusError(f"sending failed ({error})", where=f"bus {self.name}", do="check adapter, cable and power")


class FramePort:
    """Sender that carries either CONTROL alone or all other frames."""

    def __init__(self, bus: CanBus, *, is_control: bool) -> None:
        self._bus = bus
        self._is_control = is_control

    @property
    def unconfirmed(self) -> int:
        """Own CONTROL frames that the bus had not carried at the last drain.

        Always 0 on a bus whose ends do not receive their own frames.
        """
        return self._bus._sent_controls - self._bus._carried_controls

    def forget_unconfirmed(self) -> None:
        """Count unconfirmed frames from 0 again, because frames that were lost silently are never confirmed.

        A late frame must not confirm a newer one; their payloads tell them apart.
        """
        self._bus._forget_unconfirmed()

    def send(self, frame: can.Message) -> None:
        """Send without waiting. Raises BusError if it fails, ValueError for a frame that this port does not carry."""
        self._require_carried(frame)
        self._bus._send(frame, is_control=self._is_control)

    def send_all(self, frames: Sequence[Frame]) -> None:
        """Send frames in order, as one call of `send` for each would, but check all of them first.

        Raises BusError at the first that fails, ValueError for a frame that this port does not carry.
        """
        for frame in frames:
            self._require_carried(frame)
        if self._is_control:
            for frame in frames:
                self._bus._send(frame, is_control=True)
        else:
            self._bus._send_all(frames)

    def _require_carried(self, frame: can.Message) -> None:
        """Raise ValueError for a frame that this port does not carry."""
        frame_id = frame.arbitration_id
        is_plain = type(frame) is Frame and CONTROL_ID < frame_id < 0x800 and frame.dlc <= _LONGEST_FRAME
        if is_plain and not self._is_control:
            return  # nearly all frames: a simulated robot sends eight in each tick
        # Wider identifiers would lose their upper bits on the way out and could come out as CONTROL.
        if not 0 <= frame_id < (0x2000_0000 if frame.is_extended_id else 0x800):
            raise ValueError(f"identifier 0x{frame_id:X} does not fit its frame")
        if (frame_id == CONTROL_ID and not frame.is_extended_id) is not self._is_control:
            carries = "only CONTROL" if self._is_control else "all but CONTROL, which the guard sends"
            raise ValueError(f"bus {self._bus.name}: frame 0x{frame_id:X} refused, this port carries {carries}")
        if len(frame.data) > _LONGEST_FRAME or frame.dlc > _LONGEST_FRAME or frame.is_fd:
            raise ValueError(f"bus {self._bus.name}: frame 0x{frame_id:X} is not of classic CAN")


def open_bus(spec: str) -> CanBus:
    """Open one end of a bus. Raises BusError.

    `virtual:NAME` is within this process, `shared:NAME` among processes of this user on this machine, any other word is
    a SocketCAN interface such as can0.
    """
    return CanBus(spec, _interface_of)


def _interface_of(spec: str) -> CanInterface:
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


def _close(interface: CanInterface) -> None:
    with contextlib.suppress(can.CanError, OSError):  # a bus that is gone cannot be closed any further
        interface.shutdown()
