"""Error counters of a controller and its withdrawal from the bus (CAN specification 2.0, section 7)."""

from enum import IntEnum

WARNING_LIMIT = 96
PASSIVE_LIMIT = 128
BUS_OFF_LIMIT = 256
_SEND_ERROR = 8
_RECOVERED_RECEIVE = 119
"""Receive count of a passive receiver after a good frame; 119 to 127 are allowed."""


class ErrorState(IntEnum):
    """Error state of a controller, ordered by severity."""

    ACTIVE = 0
    WARNING = 1
    PASSIVE = 2
    BUS_OFF = 3


class ErrorCounters:
    """Transmit and receive error counter of one controller."""

    def __init__(self) -> None:
        self.transmit = 0
        self.receive = 0

    def sent(self) -> None:
        """Count a frame of this controller that the bus carried."""
        if self.transmit:
            self.transmit -= 1

    def received(self) -> None:
        """Count a frame that this controller received whole."""
        if self.receive >= PASSIVE_LIMIT:
            self.receive = _RECOVERED_RECEIVE
        elif self.receive:
            self.receive -= 1

    def send_failed(self, *, unacknowledged: bool) -> None:
        """Count a destroyed frame of this controller.

        `unacknowledged`: whether only the acknowledgement was missing, which alone never leads to bus-off.
        """
        if not (unacknowledged and self.state is ErrorState.PASSIVE):
            self.transmit += _SEND_ERROR

    def receive_failed(self) -> None:
        """Count a destroyed frame of another node."""
        if self.receive < BUS_OFF_LIMIT - 1:  # a counter of eight bits
            self.receive += 1

    @property
    def transmit_state(self) -> ErrorState:
        """Error state by the transmit counter."""
        return ErrorState.BUS_OFF if self.transmit >= BUS_OFF_LIMIT else _state(self.transmit)

    @property
    def receive_state(self) -> ErrorState:
        """Error state by the receive counter, which never leads to bus-off."""
        return _state(self.receive)

    @property
    def state(self) -> ErrorState:
        """More severe of both error states."""
        if not (self.transmit or self.receive):
            return ErrorState.ACTIVE
        return max(self.transmit_state, self.receive_state)


def _state(errors: int) -> ErrorState:
    if errors >= PASSIVE_LIMIT:
        return ErrorState.PASSIVE
    return ErrorState.WARNING if errors >= WARNING_LIMIT else ErrorState.ACTIVE
