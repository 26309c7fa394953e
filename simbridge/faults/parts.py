"""Parts on the robot's side of the driver, and their faults on the frame links."""

import random
import struct
from typing import Literal, get_args

import can

from hal.bus import CONTROL_ID
from hal.codec import Codec
from hal.frame import Frame
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.frame_link import FaultyLink, FrameLink
from simbridge.faults.timed_fault import TimedFault
from simbridge.faults.tx_link import FaultyTxLink

Part = Literal["sensor_board_1", "sensor_board_2", "encoders", "left_motor", "right_motor", "bus_in", "bus_out"]
"""Part on the robot's side of the driver."""

PARTS: tuple[Part, ...] = get_args(Part)

_BOARD_LETTERS = {"sensor_board_1": "ADC", "sensor_board_2": "BDC"}
_FLOOR_AND_PLATEAU = 620
"""Sum of the counts with nothing in view and with a wall in front of the sensor."""
_FOREIGN_COMMAND = Frame(CONTROL_ID, struct.pack(">HhhH", 2, 20, 20, 1))
"""Foreign SPEED_CM command, 0.2 m/s on both sides."""


def part_of(target: str) -> Part | None:
    """Return the part of robot or bus with the name of a fault's target; None if it is no such part."""
    return next((each for each in PARTS if each == target), None)


def faulty_telemetry_link(
    part: Part | None, fault: TimedFault, time: EventScheduler, chance: random.Random, codec: Codec
) -> FrameLink | None:
    """Return the link from the robot's boards to the bus; None if the part does not affect it.

    `part`: with the fault; None: no part. `time`: of the fault. `chance`: of its garbage. `codec`: of the messages.
    """
    if part == "encoders":
        encoder = codec.message("ENCODER")
        return FaultyLink(
            fault,
            time,
            chance,
            {encoder.frame_id},
            # A stuck encoder repeats its count: no ticks since the last frame.
            freeze=lambda _: encoder.pack(0, 0),
            falsify=lambda frame: [encoder.pack(*(-ticks for ticks in encoder.unpack(frame.data)))],
        )
    if part not in ("sensor_board_1", "sensor_board_2"):
        return None
    letters = _BOARD_LETTERS[part]
    board = {each: message for each, message in codec.by_id.items() if message.name.startswith(letters)}

    def mirror_distances(frame: can.Message) -> list[can.Message]:
        message = board[frame.arbitration_id]
        return [message.pack(*(max(0, _FLOOR_AND_PLATEAU - each) for each in message.unpack(frame.data)))]

    return FaultyLink(fault, time, chance, board.keys(), falsify=mirror_distances)


def faulty_rx_link(
    part: Part | None, fault: TimedFault, time: EventScheduler, chance: random.Random, codec: Codec
) -> FrameLink | None:
    """Return the link from the bus to the driver; None if the part does not affect it.

    `part`: with the fault; None: no part. `time`: of the fault. `chance`: of its garbage. `codec`: of the messages.
    """
    if part != "bus_in":
        return None
    last_of_a_cycle = codec.message("BUMPERC").frame_id

    def add_foreign_command(frame: can.Message) -> list[can.Message]:
        return [frame, _FOREIGN_COMMAND] if frame.arbitration_id == last_of_a_cycle else [frame]

    return FaultyLink(fault, time, chance, None, falsify=add_foreign_command)


def faulty_tx_link(
    part: Part | None, fault: TimedFault, time: EventScheduler, chance: random.Random
) -> FrameLink | None:
    """Return the link from the driver to the bus; None if the part does not affect it.

    `part`: with the fault; None: no part. `time`: of the fault. `chance`: of its garbage.
    """
    return FaultyTxLink(fault, time, chance) if part == "bus_out" else None
