"""Motion envelope under any requests and sensor readings.

Counted are ticks: a stream is a hundred of them, against a guard of its own. The fast suite plays 10 000 ticks
(100 streams) and 480 shorter streams of 16 robots, the deep one 120 000 (1200 streams) and 10^8 (10^6 streams). Every
four hundred streams have a robot of their own: one of the three speed modes, and in most cases other limits, another
cycle and other bumpers.
"""

import numpy as np
import pytest

from hal.guard_reason import GuardReason
from hal.kurt2_settings import SpeedMode
from kurt2rt.platform.gc_control import gc_frozen
from tests.hal.careless_guards import CARELESS
from tests.hal.envelope import APPROACHES_FOR, STANDS_FOR, violations
from tests.hal.playing import SIGNAL, Played, play
from tests.hal.streams import Streams, draw_streams

STREAMS_PER_SEED = 400
FAST_STREAMS = 100
MORE_SEEDS = np.arange(3)
DEEP_SEEDS = np.arange(100, 2600)


def hold_the_envelope(seed: int, streams_drawn: int = STREAMS_PER_SEED) -> None:
    """Play the streams of a seed; what fails is named by its seed, stream and tick."""
    streams = draw_streams(seed, streams_drawn)
    found = violations(streams, play(streams))
    assert not found, f"seed {seed}, {found[0]}; {len(found)} in all"


def test_the_envelope_holds_for_ten_thousand_ticks() -> None:
    with gc_frozen():
        hold_the_envelope(0, FAST_STREAMS)


@pytest.mark.deep
def test_the_envelope_holds_for_a_hundred_thousand_ticks() -> None:
    with gc_frozen():
        for seed in MORE_SEEDS:
            hold_the_envelope(int(seed))


@pytest.mark.deep
@pytest.mark.parametrize("seeds", np.split(DEEP_SEEDS, 100), ids=lambda seeds: f"from seed {seeds[0]}")
def test_the_envelope_holds_for_a_hundred_million_ticks(seeds: list[int]) -> None:
    with gc_frozen():
        for seed in seeds:
            hold_the_envelope(int(seed))


@pytest.fixture(scope="module")
def some() -> list[tuple[Streams, Played]]:
    return [(streams, play(streams)) for streams in (draw_streams(seed, 30, 40) for seed in range(16))]


def test_the_envelope_holds_for_some(some: list[tuple[Streams, Played]]) -> None:
    assert [found for streams, played in some for found in violations(streams, played)] == []


def test_every_reason_is_met_and_most_ticks_drive(some: list[tuple[Streams, Played]]) -> None:
    met: dict[str, int] = {}
    for _, played in some:
        for number, count in zip(*np.unique(played.reasons, return_counts=True), strict=True):
            for reason in played.reasons_of[number]:
                met[reason] = met.get(reason, 0) + int(count)
    latches = {GuardReason.BUS_LOST, GuardReason.BUS_BLOCKED, GuardReason.TICKS_CEASED, SIGNAL}
    assert {reason for reason, count in met.items() if count >= 50} >= {*STANDS_FOR, *APPROACHES_FOR, *latches}
    moves = [(played.applied_left_m_s != 0.0) | (played.applied_right_m_s != 0.0) for _, played in some]
    assert np.mean(moves) > 0.4


def test_robots_differ(some: list[tuple[Streams, Played]]) -> None:
    robots = [streams.robot for streams, _ in some]
    assert {robot.can.speed_mode for robot in robots} == set(SpeedMode)
    assert len({robot.guard.maximum_speed_m_s for robot in robots}) > 3
    assert any(not robot.bumpers for robot in (draw_streams(seed, 1).robot for seed in range(100)))


@pytest.mark.parametrize("careless", CARELESS)
def test_a_careless_guard_is_found_out(careless: str, some: list[tuple[Streams, Played]]) -> None:
    make_guard, rule = CARELESS[careless]
    assert any(found.rule == rule for streams, _ in some for found in violations(streams, play(streams, make_guard))), (
        f"a guard that is careless ({careless}) breaks no rule: {rule}"
    )
