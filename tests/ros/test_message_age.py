"""Ages of messages by the stamps of their headers; tests/hal/test_sender_clock.py has the clocks."""

import pytest

from kurt2rt.ros.inbox import StampedAge
from kurt2rt.ros.messages import Header, Message, TwistStamped, to_time
from tests.ros.examples import TWIST

NOW_S, WALL_S = 50.0, 1_700_000_000.0


def stamped(stamp_s: float) -> Message:
    return TwistStamped(Header(to_time(stamp_s), ""), TWIST)


def test_age_with_agreeing_clocks_is_present_minus_stamp() -> None:
    assert StampedAge(NOW_S, WALL_S).on_arrival(stamped(WALL_S + 1.0), NOW_S + 1.25) == pytest.approx(0.25)
