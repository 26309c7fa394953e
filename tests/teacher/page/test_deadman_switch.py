from kurt2rt.teacher.page.deadman_switch import DeadmanSwitch

FRESH_S = 0.05


def test_a_press_lasts_as_long_as_it_is_renewed() -> None:
    grip = DeadmanSwitch(lease_s=0.25)
    assert grip.press(1, FRESH_S, now_s=0.0)
    assert grip.press(1, FRESH_S, now_s=0.2)
    assert not grip.expired(now_s=0.44)
    assert grip.expired(now_s=0.45)


def test_a_press_that_ended_never_begins_again() -> None:
    grip = DeadmanSwitch()
    grip.press(1, FRESH_S, now_s=0.0)
    grip.release()
    assert not grip.press(1, FRESH_S, now_s=0.1)
    assert not grip.held
    assert grip.press(2, FRESH_S, now_s=0.2)
    assert grip.held


def test_a_burst_of_late_presses_does_not_count() -> None:
    grip = DeadmanSwitch(oldest_picture_s=0.4)
    assert not any(grip.press(1, 0.4, now_s=1.0) for _ in range(20))
    assert not grip.held
    assert grip.press(1, 0.39, now_s=1.0)


def test_a_press_on_a_picture_that_is_not_new_is_good_for_less() -> None:
    grip = DeadmanSwitch(lease_s=0.25, oldest_picture_s=0.4)
    grip.press(1, 0.3, now_s=0.0)
    assert not grip.expired(now_s=0.09)
    assert grip.expired(now_s=0.11)


def test_a_late_renewal_neither_lengthens_nor_ends_the_press() -> None:
    grip = DeadmanSwitch(lease_s=0.25, oldest_picture_s=0.4)
    grip.press(1, FRESH_S, now_s=0.0)
    assert not grip.press(1, 0.5, now_s=0.1)
    assert grip.held
    assert grip.expired(now_s=0.25)


def test_a_new_press_ends_the_one_before() -> None:
    grip = DeadmanSwitch()
    grip.press(1, FRESH_S, now_s=0.0)
    assert grip.press(2, FRESH_S, now_s=0.1)
    assert not grip.press(1, FRESH_S, now_s=0.15)
    assert grip.is_on(2)


def test_nothing_expires_while_nothing_is_held() -> None:
    grip = DeadmanSwitch()
    assert not grip.expired(now_s=1e9)
