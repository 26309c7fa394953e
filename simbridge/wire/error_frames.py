"""Error frames with the state of the own controller, laid out as in linux/can/error.h."""

import can

from simbridge.wire.error_counters import ErrorCounters, ErrorState

CLASS_CONTROLLER = 0x004
CLASS_BUS_OFF = 0x040
CLASS_RESTARTED = 0x100
CLASS_COUNTERS = 0x200
"""Identifier bits; with CLASS_COUNTERS, bytes 6 and 7 hold the counters."""

_ACTIVE_AGAIN = 0x40
_TRANSMIT_BITS = {ErrorState.ACTIVE: _ACTIVE_AGAIN, ErrorState.WARNING: 0x08, ErrorState.PASSIVE: 0x20}
_RECEIVE_BITS = {ErrorState.ACTIVE: _ACTIVE_AGAIN, ErrorState.WARNING: 0x04, ErrorState.PASSIVE: 0x10}
"""Bits of byte 1, the controller's status."""


def state_frame(counters: ErrorCounters, time_s: float) -> can.Message:
    """Return the frame that reports the state of these counters; `time_s` in s."""
    by_transmit, by_receive = counters.transmit_state, counters.receive_state
    if by_transmit is ErrorState.BUS_OFF:
        return _error_frame(CLASS_BUS_OFF, 0, counters, time_s)
    status = _TRANSMIT_BITS[by_transmit] if by_transmit >= by_receive else 0
    if by_receive >= by_transmit:
        status |= _RECEIVE_BITS[by_receive]
    return _error_frame(CLASS_CONTROLLER, status, counters, time_s)


def restarted_frame(counters: ErrorCounters, time_s: float) -> can.Message:
    """Return the frame that reports a restart after bus-off; `time_s` in s."""
    return _error_frame(CLASS_RESTARTED, 0, counters, time_s)


def _error_frame(error_class: int, status: int, counters: ErrorCounters, time_s: float) -> can.Message:
    sent, received = min(255, counters.transmit), min(255, counters.receive)
    return can.Message(
        timestamp=time_s,
        arbitration_id=error_class | CLASS_COUNTERS,
        is_extended_id=False,
        is_error_frame=True,
        data=bytes((0, status, 0, 0, 0, 0, sent, received)),
    )
