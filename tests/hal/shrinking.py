"""Shrinking of a stream that leaves the envelope to the few ticks that still leave it."""

import dataclasses

import numpy as np

from tests.hal.envelope import Violation, violations
from tests.hal.helpers import guard_on
from tests.hal.playing import MakeGuard, play
from tests.hal.streams import Streams


def shrunk(streams: Streams, violation: Violation, make_guard: MakeGuard = guard_on) -> Streams:
    """Return the stream of the violation without the ticks that are not needed to break the same rule."""
    ticks = np.arange(violation.tick + 1)
    size = len(ticks)
    while size > 1:
        size = (size + 1) // 2
        start = 0
        while start < len(ticks):
            fewer = np.delete(ticks, slice(start, start + size))
            if len(fewer) and _breaks(violation.rule, streams.only(violation.stream, fewer), make_guard):
                ticks = fewer
            else:
                start += size
    return streams.only(violation.stream, ticks)


def told(streams: Streams, make_guard: MakeGuard = guard_on) -> str:
    """Return the text of a short stream: settings, and inputs and outputs of each tick."""
    played = play(streams, make_guard)
    lines = [f"{streams.robot.can.speed_mode}, {streams.robot.cycle_s} s, {streams.robot.guard}"]
    for tick in range(streams.shape[1]):
        comes_in = {
            field.name: value[0, tick]
            for field in dataclasses.fields(streams)
            if isinstance(value := getattr(streams, field.name), np.ndarray) and (value.dtype != bool or value[0, tick])
        }
        goes_out = [
            frame.tobytes().hex() for frame in played.payloads[played.first_frame[0, tick] : played.end[0, tick]]
        ]
        said = ", ".join(f"{name} {value}" for name, value in comes_in.items())
        lines.append(f"tick {tick}: {said} -> {goes_out} {played.reasons_of[played.reasons[0, tick]]}")
    return "\n".join(lines)


def _breaks(rule: str, streams: Streams, make_guard: MakeGuard) -> bool:
    return any(violation.rule == rule for violation in violations(streams, play(streams, make_guard)))
