"""The poor link: what becomes of a row of messages under each fault."""

import random
from collections.abc import Iterable

import pytest

from tests.stories.fault import FaultInjection, SimulatedTime
from tests.stories.poor_link import PoorLink
from tests.stories.table import Fault, Kind

PERIOD_S = 0.1
BEFORE, DURING, AFTER = range(5), range(5, 25), range(25, 30)


def instead(fault: Fault, message: int, newest: int) -> Iterable[int]:
    return [newest] if fault.kind == "stuck" else [message]


def arrived(kind: Kind, *, delay_s: float = 0.25, jitters: bool = False) -> list[tuple[int, float]]:
    """Return which of thirty messages arrive, with their delays; those of `DURING` are sent under a fault."""
    time = SimulatedTime()
    injection = FaultInjection(time)
    half_s = PERIOD_S / 2
    begin_s, end_s = DURING.start * PERIOD_S - half_s, DURING.stop * PERIOD_S - half_s
    injection.plan(Fault("serial", kind, begin_s, end_s, period_s=0.45, delay_s=delay_s))
    link = PoorLink(injection, "serial", random.Random(1), instead, jitters=jitters)
    came: list[tuple[int, float]] = []
    for number in range(AFTER.stop):
        time.run_until(number * PERIOD_S)
        link.carry(number, lambda each: came.append((each, time.now_s() - each * PERIOD_S)))
    time.run_until(10.0)
    assert not link.late
    return came


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("off", [*BEFORE, *AFTER]),
        ("stuck", [*BEFORE, *[BEFORE[-1]] * len(DURING), *AFTER]),
        ("slow", [*BEFORE, 9, 14, 19, 24, *AFTER]),
        ("crlf", [*BEFORE, *DURING, *AFTER]),
    ],
)
def test_poor_link_in_order(kind: Kind, expected: list[int]) -> None:
    assert [each for each, _ in arrived(kind)] == expected


def test_some_are_lost_doubled_or_replayed() -> None:
    everything = {*BEFORE, *DURING, *AFTER}
    lost = everything - {each for each, _ in arrived("lost")}
    assert lost
    assert lost < {*DURING}
    twice = [each for each, _ in arrived("doubled")]
    assert sorted({*twice}) == sorted(everything)
    assert twice == sorted(twice)
    assert len(everything) < len(twice) < len(everything) + len(DURING)
    again = arrived("replayed")
    assert {each for each, _ in again} == everything
    assert max(late_s for _, late_s in again) > 1.0


@pytest.mark.parametrize("jitters", [False, True])
def test_late_messages_stay_in_order_until_the_fault_is_over(jitters: bool) -> None:
    came = arrived("delayed", jitters=jitters)
    assert [each for each, _ in came] == [*BEFORE, *DURING, *AFTER]
    delays_s = [round(late_s, 6) for each, late_s in came if each in DURING]
    assert (set(delays_s[:-2]) == {0.25}) is not jitters
    assert delays_s[-1] <= PERIOD_S / 2
    assert max(delays_s) <= 0.5


def test_reordered_messages_overtake_each_other() -> None:
    came = [each for each, _ in arrived("reordered")]
    assert sorted(came) == [*BEFORE, *DURING, *AFTER]
    assert came != sorted(came)
