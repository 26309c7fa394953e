"""State of this machine's CAN controller, from Linux's error frames (linux/can/error.h)."""

from enum import StrEnum

import can


class ControllerState(StrEnum):
    """Error state of the controller, by the errors that it counted (ISO 11898-1)."""

    ACTIVE = "error-active"
    WARNING = "error-warning"
    PASSIVE = "error-passive"
    OFF = "bus-off"


_OFF = ControllerState.OFF
"""A name for each tick, because Python 3.11 looks a member up in its enumeration ten times slower than a global."""


# Classes of error: bits of the identifier.
_CONTROLLER = 0x004
_BUS_OFF = 0x040
_RESTARTED = 0x100
_COUNTERS = 0x200
_KINDS = (
    (0x020, "not acknowledged"),
    (0x088, "broken"),
    (0x010, "transceiver"),
    (0x001, "not sent in time"),
    (0x002, "lost arbitration"),
)
_OVERFLOWS = "overflow"  # frames that the controller lost because they were not fetched in time
# Status of the controller, data[1] of class CONTROLLER: a bit for receiving and one for sending, ACTIVE for both.
_OVERFLOW = 0x03
_STATES = ((0x30, ControllerState.PASSIVE), (0x0C, ControllerState.WARNING), (0x40, ControllerState.ACTIVE))


class BusState:
    """State of one bus, from its error frames. An invalid error frame changes only the count."""

    def __init__(self, bus: str) -> None:
        """Start error-active; `bus` is the name in messages."""
        self._bus = bus
        # All kinds from the start, because another thread may iterate over them.
        self._kinds = {word: 0 for _, word in _KINDS} | {_OVERFLOWS: 0}
        self.error_frames = 0
        """Error frames so far."""
        self.controller = ControllerState.ACTIVE
        self.sending_errors = 0
        """The controller's own counter; from 96 on it warns, from 128 on it is passive, from 256 on it is off."""
        self.receiving_errors = 0

    def note(self, frame: can.Message) -> None:
        """Read one error frame of Linux's layout. Cheap, because a broken cable makes thousands a second."""
        classes = frame.arbitration_id
        self.error_frames += 1
        for bits, kind in _KINDS:
            if classes & bits:
                self._kinds[kind] += 1
        data = frame.data
        if len(data) >= 8:
            # Kernels before 6.0 fill in the counters without the bit that says so.
            if classes & (_COUNTERS | _CONTROLLER):
                self.sending_errors, self.receiving_errors = data[6], data[7]
            if classes & _CONTROLLER:
                self._note_status(data[1])
        if classes & _RESTARTED:
            self.controller = ControllerState.ACTIVE
        if classes & _BUS_OFF:
            self.controller = ControllerState.OFF

    def note_traffic(self) -> None:
        """Leave bus-off: received frames prove that the controller takes part in the bus."""
        if self.off:
            self.controller = ControllerState.ACTIVE

    @property
    def off(self) -> bool:
        """True while nothing can be sent."""
        return self.controller is _OFF

    @property
    def kinds(self) -> dict[str, int]:
        """Number of error frames by kind, without the kinds that never came."""
        return {kind: count for kind, count in self._kinds.items() if count}

    @property
    def trouble(self) -> str:
        """Fault and remedy in one line; empty while the controller is error-active."""
        if self.controller is ControllerState.ACTIVE:
            return ""
        if self.off:
            return (
                f"bus {self._bus}: bus-off, the adapter left the bus after too many errors; check cable, termination "
                f"and bit rate, then: ip link set {self._bus} type can restart (or once: restart-ms 100)"
            )
        kinds = ", ".join(f"{count} {word}" for word, count in self.kinds.items())
        return (
            f"bus {self._bus}: {self.controller}, {self.sending_errors} errors sending and {self.receiving_errors} "
            f"receiving; check cable, termination and bit rate; error frames: {kinds or self.error_frames}"
        )

    def _note_status(self, status: int) -> None:
        if status & _OVERFLOW:
            self._kinds[_OVERFLOWS] += 1
        for bits, state in _STATES:
            if status & bits:
                self.controller = state
                return
