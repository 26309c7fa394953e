import math

from kurt2rt.teacher.page.page_connection import SentStates


def test_may_send_without_acknowledgement_ends_at_the_window() -> None:
    states = SentStates(window=3)
    for i in range(3):
        assert states.may_send
        states.add(b"boot", i, now_s=0.0)
    assert not states.may_send
    states.acknowledge(2)
    assert states.may_send


def test_age_s_unknown_or_forgotten_state_is_infinite() -> None:
    states = SentStates(history=2)
    first = states.add(b"boot", 1, now_s=0.0)
    states.add(b"boot", 2, now_s=0.0)
    assert states.get(first) is not None
    states.add(b"boot", 3, now_s=0.0)
    assert states.get(first) is None
    for number in (None, 0, first, 4):
        assert states.age_s(number, now_s=0.0) == math.inf
