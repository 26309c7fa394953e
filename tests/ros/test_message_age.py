"""Ages of messages by the stamps of their headers; tests/hal/test_sender_clock.py has the clocks."""

import pytest

from kurt2rt.ros.message_age import StampedAge
from kurt2rt.ros.messages import Header, Message, String, TwistStamped, to_time
from tests.ros.examples import TWIST

NOW_S, WALL_S = 50.0, 1_700_000_000.0


def stamped(stamp_s: float) -> Message:
    return TwistStamped(Header(to_time(stamp_s), ""), TWIST)


def test_age_with_agreeing_clocks_is_present_minus_stamp() -> None:
    assert StampedAge(NOW_S, WALL_S).on_arrival(stamped(WALL_S + 1.0), NOW_S + 1.25) == pytest.approx(0.25)


@pytest.mark.parametrize("message", [stamped(0.0), String("unstamped")])
def test_age_without_a_stamp_is_counted_from_arrival(message: Message) -> None:
    ages = StampedAge(NOW_S, WALL_S)
    assert [ages.on_arrival(message, NOW_S + late_s) for late_s in (0.0, 5.0)] == [0.0, 0.0]
