"""Wires at 1 Mbit/s, where a bit takes a microsecond, without faults unless a test adds some."""

from pathlib import Path
from typing import Any

import can
import yaml

from config import CONFIG_DIR
from hal.frame import Frame
from simbridge.wire.settings import LossSettings, NodeSettings, NoiseSettings, SendingOrder, WireSettings
from simbridge.wire.wire import Wire
from simbridge.wire.wire_interface import WireInterface

US = 1e-6
FIFO = NodeSettings(order=SendingOrder.FIFO, queue_frames=64, restart_s=0.1)
BY_IDENTIFIER = NodeSettings(order=SendingOrder.IDENTIFIER, queue_frames=64, restart_s=None)
MAILBOX = NodeSettings(order=SendingOrder.MAILBOX, queue_frames=64, restart_s=None)
CONTROL = "0002000000000001"
"""Payload that makes a frame of 122 bits with the identifier 0x01."""
NO_LOSS = LossSettings(share=0.0, shares_by_id=())
NO_NOISE = NoiseSettings(destroyed_share=0.0, bursts_s=(), burst_gap_s=0.0, burst_length_s=0.0)


def new_wire(seed: int = 1, *, bit_rate_bit_s: int = 1_000_000, loss: LossSettings = NO_LOSS, **noise: Any) -> Wire:
    """Return a wire; `noise` changes keys of NO_NOISE."""
    settings = WireSettings(
        name="test",
        bit_rate_bit_s=bit_rate_bit_s,
        notebook_phase_s=0.005,
        robot=FIFO,
        notebook=FIFO,
        loss=loss,
        noise=NO_NOISE.model_copy(update=noise),
    )
    return Wire(settings, seed)


def changed(folder: Path, **parts: dict[str, object]) -> str:
    """Return the path of a file like the shipped one_megabit, with some keys of its parts changed."""
    content = yaml.safe_load((CONFIG_DIR / "wires" / "one_megabit.yaml").read_text(encoding="utf-8"))
    for part, values in parts.items():
        content[part].update(values)
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return str(path)


def ends_on(wire: Wire, number: int, node: NodeSettings = FIFO) -> list[WireInterface]:
    return [WireInterface(wire, node) for _ in range(number)]


def joined(number: int, node: NodeSettings = FIFO) -> tuple[Wire, list[WireInterface]]:
    """Return a wire without faults, and interfaces on it."""
    wire = new_wire()
    return wire, ends_on(wire, number, node)


def frame(frame_id: int, payload: str = "0000000000000000") -> Frame:
    return Frame(frame_id, bytes.fromhex(payload))


def numbered(frame_id: int, number: int) -> Frame:
    return frame(frame_id, f"{number:016x}")


def waiting(end: WireInterface) -> list[can.Message]:
    """Return all frames that wait at an end, oldest first."""
    return list(iter(lambda: end.recv(0), None))


def waiting_ids(end: WireInterface) -> list[int]:
    return [message.arbitration_id for message in waiting(end)]


def waiting_numbers(end: WireInterface) -> list[int]:
    return [int.from_bytes(message.data, "big") for message in waiting(end)]


def others_frames(end: WireInterface) -> list[can.Message]:
    return [message for message in waiting(end) if message.is_rx and not message.is_error_frame]


def confirmations(end: WireInterface) -> list[can.Message]:
    return [message for message in waiting(end) if not message.is_rx]


def error_frames(end: WireInterface) -> list[can.Message]:
    return [message for message in waiting(end) if message.is_error_frame]


def stamp_us(message: can.Message) -> int:
    return round(message.timestamp / US)
