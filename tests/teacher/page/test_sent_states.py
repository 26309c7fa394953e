import math

from kurt2rt.teacher.page.sent_states import SentState, SentStates


def test_a_page_that_does_not_answer_gets_no_more_pictures_until_it_does() -> None:
    pictures = SentStates(window=3)
    for i in range(3):
        assert pictures.may_send
        pictures.send(b"boot", i, now_s=0.0)
    assert not pictures.may_send
    pictures.see(2)
    assert pictures.may_send


def test_what_was_said_on_a_picture_is_known_by_its_number() -> None:
    pictures = SentStates()
    number = pictures.send(b"boot", 1234, now_s=5.0)
    assert pictures.get(number) == SentState(b"boot", 1234, 5.0)
    assert pictures.age_s(number, now_s=5.25) == 0.25


def test_a_picture_that_was_never_sent_or_long_ago_is_infinitely_old() -> None:
    pictures = SentStates(kept=2)
    first = pictures.send(b"boot", 1, now_s=0.0)
    pictures.send(b"boot", 2, now_s=0.0)
    assert pictures.get(first) is not None
    pictures.send(b"boot", 3, now_s=0.0)
    assert pictures.get(first) is None
    for number in (None, 0, first, 4):
        assert pictures.age_s(number, now_s=0.0) == math.inf


def test_nobody_sees_a_picture_before_it_was_sent() -> None:
    pictures = SentStates(window=1)
    pictures.see(100)
    pictures.send(b"boot", 1, now_s=0.0)
    assert not pictures.may_send
