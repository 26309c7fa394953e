"""A controller's error counters: how it withdraws from a wire that it disturbs (CAN specification 2.0, section 7)."""

from enum import IntEnum

WARNING_LIMIT = 96
PASSIVE_LIMIT = 128
BUS_OFF_LIMIT = 256
_SEND_ERROR = 8
_RECOVERED_RECEIVE = 119
"""Where the receive counter goes on from after a frame that a passive receiver understood; 119 to 127 are allowed."""


class ErrorState(IntEnum):
    """How much of a say a controller still has. Compared by severity."""

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
        """A frame of its own was carried."""
        if self.transmit:
            self.transmit -= 1

    def received(self) -> None:
        """A frame of another node was understood."""
        if self.receive >= PASSIVE_LIMIT:
            self.receive = _RECOVERED_RECEIVE
        elif self.receive:
            self.receive -= 1

    def send_failed(self, *, unacknowledged: bool) -> None:
        """Count a destroyed own frame; a missing acknowledgement alone never leads to bus-off."""
        if not (unacknowledged and self.state is ErrorState.PASSIVE):
            self.transmit += _SEND_ERROR

    def receive_failed(self) -> None:
        """A frame of another node was destroyed."""
        if self.receive < BUS_OFF_LIMIT - 1:  # a counter of eight bits
            self.receive += 1

    @property
    def transmit_state(self) -> ErrorState:
        """State by the transmit counter."""
        return ErrorState.BUS_OFF if self.transmit >= BUS_OFF_LIMIT else _state(self.transmit)

    @property
    def receive_state(self) -> ErrorState:
        """State by the receive counter, which takes no node off the bus."""
        return _state(self.receive)

    @property
    def state(self) -> ErrorState:
        """The graver of both."""
        if not (self.transmit or self.receive):
            return ErrorState.ACTIVE
        return max(self.transmit_state, self.receive_state)


def _state(errors: int) -> ErrorState:
    if errors >= PASSIVE_LIMIT:
        return ErrorState.PASSIVE
    return ErrorState.WARNING if errors >= WARNING_LIMIT else ErrorState.ACTIVE
