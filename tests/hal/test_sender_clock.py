"""Ages by a sender's clock in virtual time: clocks that are set, queues, and messages that lie."""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.sender_clock import SenderClock

DRIFT, SLACK_S = 0.0005, 0.1
BLIND_S = 5.0
STEPS_S = (-3600.0, -5.0, -2.0, -0.3, 0.3, 2.0, 5.0, 3600.0)
PERIODS_S = (0.02, 0.05, 0.2)


class Message(NamedTuple):
    """Message as it arrives."""

    stamp_s: float
    arrival_s: float
    delay_s: float


def stream(
    period_s: float, until_s: float, clock: Callable[[float], float], delay: Callable[[float], float]
) -> Iterator[Message]:
    """Yield messages in their order: `clock` is the sender's by the true time in s, `delay` that of the way."""
    arrival_s = -math.inf
    for number in range(round(until_s / period_s)):
        sent_s = number * period_s
        arrival_s = max(arrival_s, sent_s + delay(sent_s))
        yield Message(clock(sent_s), arrival_s, arrival_s - sent_s)


def short(sent_s: float) -> float:
    """Return a delay that repeats itself seldom, from 5 to 25 ms."""
    return 0.015 + 0.01 * math.sin(100 * sent_s)


@pytest.mark.parametrize("step_s", [*STEPS_S, None])
@given(at_s=st.floats(1.0, 4.0), period_s=st.sampled_from(PERIODS_S))
def test_sender_clock_that_is_set_is_believed_soon(step_s: float | None, at_s: float, period_s: float) -> None:
    """A step of None is a simulation that begins again: its stamps are near 0."""

    def clock(sent_s: float) -> float:
        past_s = sent_s - at_s
        return 1000.0 + sent_s if past_s < 0 else past_s if step_s is None else 1000.0 + sent_s + step_s

    ages, sender = [], SenderClock(DRIFT, SLACK_S)
    for each in stream(period_s, at_s + 8.0, clock, short):
        age_s = sender.age_s(each.stamp_s, each.arrival_s)
        ages.append((each.arrival_s, age_s))
        assert age_s is None or age_s >= 0.0
    blind = [arrival_s for arrival_s, age_s in ages if age_s is None or age_s > 0.25]
    assert all(0 <= arrival_s - at_s < BLIND_S for arrival_s in blind)
    assert sender.jumps == 1
    jump_s = step_s if step_s is not None else -1000.0 - at_s
    assert f"set by {round(jump_s, 1):+.1f}"[:-2] in sender.notice(at_s + 8.0)


@pytest.mark.parametrize("lie_s", [0.0, -7.0, -0.3, 0.3, 0.6, 5.0])
@given(queue_s=st.floats(0.6, 9.0), period_s=st.sampled_from(PERIODS_S))
def test_sender_clock_queue_stays_old_whatever_lies_in_it(lie_s: float, queue_s: float, period_s: float) -> None:
    sender, lies_from_s, until_s = SenderClock(DRIFT, SLACK_S), 6.0, 12.0
    for each in stream(period_s, until_s, lambda sent_s: sent_s, lambda sent_s: short(sent_s) + queue_s * (sent_s > 2)):
        lies = lie_s != 0 and lies_from_s <= each.stamp_s < lies_from_s + period_s
        age_s = sender.age_s(each.stamp_s + lies * lie_s, each.arrival_s)
        oldest_s = each.delay_s - 0.025 - DRIFT * until_s
        assert lies or (age_s is not None and age_s > oldest_s)
    assert sender.jumps == 0
    assert sender.notice(each.arrival_s) == f"comes {age_s:.1f} s late; look at the network"


@given(lie_s=st.floats(-1e5, 1e5).filter(lambda lie_s: abs(lie_s) > 0.25), period_s=st.sampled_from(PERIODS_S))
def test_sender_clock_one_lie_is_forgotten(lie_s: float, period_s: float) -> None:
    messages = list(stream(period_s, 10.0, lambda sent_s: sent_s, short))
    truthful, deceived = SenderClock(DRIFT, SLACK_S), SenderClock(DRIFT, SLACK_S)
    for number, each in enumerate(messages):
        age_s = truthful.age_s(each.stamp_s, each.arrival_s)
        if number == len(messages) // 2:
            assert deceived.age_s(each.stamp_s + lie_s, each.arrival_s) is None
        else:
            assert deceived.age_s(each.stamp_s, each.arrival_s) == pytest.approx(age_s, abs=1e-4)


def test_sender_clock_that_lies_first_is_found_out() -> None:
    sender = SenderClock(DRIFT, SLACK_S)
    sender.age_s(1005.0, 0.0)
    ages = [sender.age_s(1000.0 + 0.05 * number, 0.05 * number) for number in range(1, 20)]
    assert ages[-1] == pytest.approx(0.0, abs=0.001)


def test_sender_clock_repeated_and_late_messages_do_not_count() -> None:
    sender = SenderClock(DRIFT, SLACK_S)
    assert sender.age_s(1.0, 11.0) == 0.0
    assert sender.age_s(1.0, 11.2) is None
    assert sender.age_s(0.8, 11.2) is None
    assert sender.age_s(1.3, 11.3) == 0.0


def test_sender_clock_that_repeats_itself_is_never_believed() -> None:
    sender = SenderClock(DRIFT, SLACK_S)
    for number in range(100):
        sender.age_s(min(number, 50) * 0.2, number * 0.2)
    assert sender.jumps == 0
    assert "repeat" in sender.notice(20.0)


def test_sender_clock_that_a_command_proves_wrong_counts_at_once() -> None:
    sender = SenderClock(DRIFT, SLACK_S)
    sender.age_s(0.5, 10.0)
    assert sender.age_s(0.6, 12.0) == pytest.approx(1.9, abs=0.01)  # by itself it came late
    assert sender.age_s(0.62, 12.02, at_most_s=0.03) == pytest.approx(0.03)
    assert sender.jumps == 1
    assert sender.age_s(0.64, 12.04) == pytest.approx(0.03, abs=0.001)


def test_sender_clock_that_agrees_tells_the_age_itself() -> None:
    sender = SenderClock(DRIFT, SLACK_S, agreed_offset_s=-500.0)
    assert sender.age_s(600.0, 100.4) == pytest.approx(0.4)
    assert sender.age_s(600.2, 100.5) == pytest.approx(0.3, abs=1e-4)
    assert sender.age_s(600.4, 101.1) == pytest.approx(0.7, abs=1e-4)
    assert sender.age_s(600.6, 101.1) == pytest.approx(0.5, abs=1e-4)  # it came much sooner than the one before


@pytest.mark.parametrize("apart_s", [-5.0, -0.1, 1.1, 5.0])
def test_sender_clock_apart_is_the_delay_against_the_quickest(apart_s: float) -> None:
    sender = SenderClock(DRIFT, SLACK_S, agreed_offset_s=-500.0)
    assert sender.age_s(600.0 - apart_s, 100.0) == 0.0
    assert sender.age_s(600.2 - apart_s, 100.7) == pytest.approx(0.5, abs=0.001)


@pytest.mark.parametrize("drift", [-5e-5, 5e-5])
@pytest.mark.parametrize("agreed_offset_s", [0.0, math.inf])
def test_sender_clock_that_drifts_stays_young(drift: float, agreed_offset_s: float) -> None:
    sender = SenderClock(DRIFT, SLACK_S, agreed_offset_s)
    ages = [sender.age_s(sent * (1 - drift), sent + 0.001) for sent in range(1, 40_000, 5)]
    assert max(math.inf if age_s is None else age_s for age_s in ages) < 0.01


def test_own_clock_that_begins_again_is_followed() -> None:
    sender = SenderClock(DRIFT, SLACK_S)
    assert [sender.age_s(at_s, at_s) for at_s in (50.0, 50.2, 0.1, 0.3)] == [0.0] * 4


@given(st.lists(st.tuples(st.floats(0.001, 0.3), st.floats(0.0, 0.9)), max_size=40), st.floats(-1e6, 1e6))
def test_sender_clock_message_is_as_old_as_its_delay(ways: list[tuple[float, float]], offset_s: float) -> None:
    sender, arrival_s, sent_s = SenderClock(DRIFT, SLACK_S), 0.0, 0.0
    for gap_s, delay_s in [(0.1, 0.0), *ways]:
        sent_s += gap_s
        arrival_s = max(arrival_s, sent_s + delay_s)
        age_s = sender.age_s(sent_s + offset_s, arrival_s)
        assert age_s is not None
        assert age_s >= arrival_s - sent_s - DRIFT * arrival_s - 1e-6
