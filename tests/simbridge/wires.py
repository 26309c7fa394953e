"""Wires for the tests: 1 Mbit/s, where a bit is a microsecond, and nothing wrong unless a test wants it."""

import can

from hal.frame import Frame
from simbridge.wire.end import WireInterface
from simbridge.wire.settings import LossSettings, NodeSettings, NoiseSettings, SendingOrder, WireSettings
from simbridge.wire.wire import Wire

US = 1e-6
FIFO = NodeSettings(order=SendingOrder.FIFO, queue_frames=64, restart_s=0.1)
BY_IDENTIFIER = NodeSettings(order=SendingOrder.IDENTIFIER, queue_frames=64, restart_s=None)
MAILBOX = NodeSettings(order=SendingOrder.MAILBOX, queue_frames=64, restart_s=None)
ONE_MEGABIT = 1_000_000

Shares = tuple[tuple[int, float], ...]
Bursts = tuple[tuple[float, float], ...]


def settings(
    *,
    missed: float = 0.0,
    missed_by_id: Shares = (),
    destroyed: float = 0.0,
    bursts_s: Bursts = (),
    gap_s: float = 0.0,
    length_s: float = 0.0,
    bit_rate_bit_s: int = ONE_MEGABIT,
    phase_s: float = 0.005,
) -> WireSettings:
    return WireSettings(
        name="of a test",
        bit_rate_bit_s=bit_rate_bit_s,
        notebook_phase_s=phase_s,
        robot=FIFO,
        notebook=FIFO,
        loss=LossSettings(share=missed, shares_by_id=missed_by_id),
        noise=NoiseSettings(destroyed_share=destroyed, bursts_s=bursts_s, burst_gap_s=gap_s, burst_length_s=length_s),
    )


def quiet_wire() -> Wire:
    return Wire(settings(), seed=1)


def ends_on(wire: Wire, number: int, node: NodeSettings = FIFO) -> list[WireInterface]:
    return [WireInterface(wire, node) for _ in range(number)]


def frame(frame_id: int, payload: str = "0000000000000000") -> Frame:
    return Frame(frame_id, bytes.fromhex(payload))


def waiting(end: WireInterface) -> list[can.Message]:
    """All that waits at an end, oldest first."""
    found = []
    while (message := end.recv(0)) is not None:
        found.append(message)
    return found


def others_frames(end: WireInterface) -> list[can.Message]:
    return [message for message in waiting(end) if message.is_rx and not message.is_error_frame]


def confirmations(end: WireInterface) -> list[can.Message]:
    return [message for message in waiting(end) if not message.is_rx]


def error_frames(end: WireInterface) -> list[can.Message]:
    return [message for message in waiting(end) if message.is_error_frame]


def stamp_us(message: can.Message) -> int:
    return round(message.timestamp / US)
