"""The CAN bus: opening, draining without waiting, and the two ports through which frames go out."""

import contextlib
import time
from pathlib import Path
from queue import Empty, Full, SimpleQueue

import can
from can.interfaces.virtual import VirtualBus, channels_lock

CONTROL_ID = 0x01
"""Identifier of the only frame that moves the robot (reference 1.2)."""

_QUEUE_FRAMES = 4096
"""Frames that wait for a listener of the in-process bus, and the most that one drain takes: a bus that is full for
10 ms carries about 200, so whatever waited when a drain began is taken by it."""

_CAN_INTERFACE = "280"
"""ARPHRD_CAN, the kind of network interface that Linux shows for CAN."""


class BusError(OSError):
    """The bus cannot be opened or used. The message is one line: bus, what happened, what to do."""


class CanBus:
    """One end of a CAN bus. CONTROL goes out through a port that exists once, all else through telemetry ports."""

    def __init__(self, spec: str) -> None:
        """Open `virtual:NAME` or a SocketCAN interface. Raises BusError."""
        self.name = spec
        self._python_can_bus: can.BusABC | None = _open_raw(spec)
        self._control_taken = False

    def drain(self) -> list[can.Message]:
        """Every frame that waits, oldest first, without blocking. Raises BusError when the bus is gone."""
        raw = self._usable()
        messages: list[can.Message] = []
        try:
            for _ in range(_QUEUE_FRAMES):
                # No software filters are set: with them recv(0) gives None when a filtered frame was next.
                message = raw.recv(0)
                if message is None:
                    break
                messages.append(message)
        except (can.CanError, OSError, ValueError) as error:
            raise BusError(f"bus {self.name}: receiving failed ({error}); check adapter, cable and power") from error
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
        self._python_can_bus = _open_raw(self.name)

    def shutdown(self) -> None:
        """Give the bus back; may be called twice."""
        raw, self._python_can_bus = self._python_can_bus, None
        if raw is not None:
            with contextlib.suppress(can.CanError, OSError):  # a bus that is gone cannot be closed any further
                raw.shutdown()

    def _usable(self) -> can.BusABC:
        if self._python_can_bus is None:
            raise BusError(f"bus {self.name}: is shut down; open it again")
        return self._python_can_bus

    def _send(self, frame: can.Message) -> None:
        raw = self._usable()
        try:
            raw.send(frame, timeout=0)
        except (can.CanError, OSError, ValueError) as error:
            raise BusError(f"bus {self.name}: sending failed ({error}); check adapter, cable and power") from error


class FramePort:
    """A way out to the bus that lets through either CONTROL alone or everything else."""

    def __init__(self, bus: CanBus, *, is_control: bool) -> None:
        self._bus = bus
        self._is_control = is_control

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


class _InProcessBus(VirtualBus):
    """One end of python-can's in-process bus, with a queue that is written in C.

    Any other listener of python-can on the channel hears the same frames. The queue of its own end, the general
    `deepcopy` for every listener and the log call for every frame took a third of a simulated tick.
    """

    def __init__(self, name: str) -> None:
        super().__init__(channel=name)
        waiting: SimpleQueue[can.Message] = SimpleQueue()
        with channels_lock:
            self.channel[self.channel.index(self.queue)] = waiting  # type: ignore[call-overload]  # same put and get
            self.queue = waiting  # type: ignore[assignment]

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """The frame that waits longest; None when there is none. Raises can.CanOperationError after shutdown."""
        if timeout != 0:
            return super().recv(timeout)
        self._check_if_open()
        try:
            return self.queue.get_nowait()
        except Empty:
            return None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        """Give all others a copy. Raises can.CanOperationError when one has too many waiting, and after shutdown."""
        self._check_if_open()
        all_took_it = True
        sent_at_s = time.time()
        for queue in self.channel:
            if queue is self.queue:
                continue
            copy = msg.__deepcopy__(None)
            copy.timestamp = sent_at_s
            copy.channel = self.channel_id
            full = queue.qsize() >= _QUEUE_FRAMES  # a SimpleQueue has no limit of its own
            if not full:
                try:
                    queue.put_nowait(copy)
                except Full:
                    full = True
            if full:
                all_took_it = False
        if not all_took_it:
            raise can.CanOperationError("a listener has too many frames waiting")


def open_bus(spec: str) -> CanBus:
    """Open one end of a bus: `virtual:NAME` within this process, or a SocketCAN interface such as can0. BusError."""
    return CanBus(spec)


def _open_raw(spec: str) -> can.BusABC:
    kind, colon, name = spec.partition(":")
    if colon:
        if kind != "virtual" or not name:
            raise BusError(f"bus {spec!r}: no such kind; give virtual:NAME or a SocketCAN interface such as can0")
        return _InProcessBus(name)
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
        return can.Bus(interface="socketcan", channel=spec, ignore_config=True)
    except (can.CanError, OSError, AttributeError) as error:
        raise BusError(
            f"bus {spec!r}: cannot be opened ({error}); load the kernel's CAN modules: modprobe can_raw"
        ) from error
