from kurt2rt.teacher.page.control_lease import ControlLease


def test_the_first_page_has_the_pad_and_the_next_one_watches() -> None:
    seat = ControlLease()
    seat.arrive(1, now_s=0.0)
    seat.arrive(2, now_s=0.5)
    assert seat.holder == 1


def test_the_newest_that_takes_it_has_it() -> None:
    seat = ControlLease()
    seat.arrive(1, now_s=0.0)
    seat.take(2, now_s=0.1)
    seat.take(3, now_s=0.2)
    assert seat.holder == 3


def test_a_page_that_is_not_heard_of_gives_way_to_one_that_is_opened() -> None:
    seat = ControlLease(silent_s=1.0)
    seat.arrive(1, now_s=0.0)
    seat.hear(1, now_s=5.0)
    seat.arrive(2, now_s=5.9)
    assert seat.holder == 1
    seat.arrive(3, now_s=6.1)
    assert seat.holder == 3


def test_a_hidden_page_gives_way_at_once_unless_it_is_seen_again() -> None:
    seat = ControlLease()
    seat.arrive(1, now_s=0.0)
    seat.hide(1)
    seat.hear(1, now_s=0.1)
    seat.arrive(2, now_s=0.2)
    assert seat.holder == 1
    seat.hide(1)
    seat.arrive(3, now_s=0.2)
    assert seat.holder == 3


def test_nobody_moves_up_when_the_pad_is_left() -> None:
    seat = ControlLease()
    seat.arrive(1, now_s=0.0)
    seat.arrive(2, now_s=0.0)
    seat.leave(1)
    assert seat.holder is None
    seat.leave(2)
    seat.arrive(3, now_s=0.0)
    assert seat.holder == 3
