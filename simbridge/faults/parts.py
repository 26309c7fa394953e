"""What can fail on the robot's side of the driver, and what that does to the frames on their way."""

import random
import struct
from typing import Literal, get_args

import can

from hal.bus import CONTROL_ID
from hal.codec import Codec
from hal.frame import Frame
from simbridge.faults.disturbance import TimedFault
from simbridge.faults.event_time import EventScheduler
from simbridge.faults.way import FaultyLink, FrameLink
from simbridge.faults.way_out import FaultyTxLink

Part = Literal["sensor_board_1", "sensor_board_2", "encoders", "left_motor", "right_motor", "bus_in", "bus_out"]
"""What can fail on the robot's side of the driver."""

PARTS: tuple[Part, ...] = get_args(Part)

_BOARD_LETTERS = {"sensor_board_1": "ADC", "sensor_board_2": "BDC"}
_FLOOR_AND_PLATEAU = 620
"""Sum of the readings with nothing in view and with a wall in front of the sensor."""
_SOMEBODY_ELSES_ORDER = Frame(CONTROL_ID, struct.pack(">HhhH", 2, 20, 20, 1))
"""SPEED_CM, 0.2 m/s on both sides."""


def part_of(target: str) -> Part | None:
    """The part of that name; None for what is no part of robot or bus."""
    return next((each for each in PARTS if each == target), None)


def faulty_telemetry_link(
    part: Part | None, disturbance: TimedFault, time: EventScheduler, chance: random.Random, codec: Codec
) -> FrameLink | None:
    """The way from the robot's boards to the bus; None where this part does not disturb it."""
    if part == "encoders":
        encoder = codec.message("ENCODER")
        return FaultyLink(
            disturbance,
            time,
            chance,
            {encoder.frame_id},
            # What an encoder repeats is its count: no ticks since the last frame.
            freeze=lambda _: encoder.pack(0, 0),
            falsify=lambda frame: [encoder.pack(*(-ticks for ticks in encoder.unpack(frame.data)))],
        )
    if part not in ("sensor_board_1", "sensor_board_2"):
        return None
    letters = _BOARD_LETTERS[part]
    board = {each: message for each, message in codec.by_id.items() if message.name.startswith(letters)}

    def show_far_for_near(frame: can.Message) -> list[can.Message]:
        message = board[frame.arbitration_id]
        return [message.pack(*(max(0, _FLOOR_AND_PLATEAU - each) for each in message.unpack(frame.data)))]

    return FaultyLink(disturbance, time, chance, board.keys(), falsify=show_far_for_near)


def faulty_rx_link(
    part: Part | None, disturbance: TimedFault, time: EventScheduler, chance: random.Random, codec: Codec
) -> FrameLink | None:
    """The way from the bus to the driver; None where this part does not disturb it."""
    if part != "bus_in":
        return None
    last_of_a_cycle = codec.message("BUMPERC").frame_id

    def hear_somebody_else(frame: can.Message) -> list[can.Message]:
        return [frame, _SOMEBODY_ELSES_ORDER] if frame.arbitration_id == last_of_a_cycle else [frame]

    return FaultyLink(disturbance, time, chance, None, falsify=hear_somebody_else)


def faulty_tx_link(
    part: Part | None, disturbance: TimedFault, time: EventScheduler, chance: random.Random
) -> FrameLink | None:
    """The way from the driver to the bus; None where this part does not disturb it."""
    return FaultyTxLink(disturbance, time, chance) if part == "bus_out" else None
