from kurt2rt.teacher.page.page_connection import DeadmanSwitch

FRESH_S = 0.05


def test_press_renewed_in_time_does_not_expire() -> None:
    deadman = DeadmanSwitch(lease_s=0.25)
    assert deadman.press(1, FRESH_S, now_s=0.0)
    assert deadman.press(1, FRESH_S, now_s=0.2)
    assert not deadman.expired(now_s=0.44)
    assert deadman.expired(now_s=0.45)


def test_press_after_its_release_does_not_count() -> None:
    deadman = DeadmanSwitch()
    deadman.press(1, FRESH_S, now_s=0.0)
    deadman.release()
    assert not deadman.press(1, FRESH_S, now_s=0.1)
    assert not deadman.held
    assert deadman.press(2, FRESH_S, now_s=0.2)
    assert deadman.held


def test_press_on_an_aging_state_expires_earlier() -> None:
    deadman = DeadmanSwitch(lease_s=0.25, max_state_age_s=0.4)
    deadman.press(1, 0.3, now_s=0.0)
    assert not deadman.expired(now_s=0.09)
    assert deadman.expired(now_s=0.11)


def test_press_with_a_larger_id_ends_the_one_before() -> None:
    deadman = DeadmanSwitch()
    deadman.press(1, FRESH_S, now_s=0.0)
    assert deadman.press(2, FRESH_S, now_s=0.1)
    assert not deadman.press(1, FRESH_S, now_s=0.15)
    assert deadman.is_held_by(2)


def test_press_on_an_old_state_does_not_count() -> None:
    deadman = DeadmanSwitch(max_state_age_s=0.4)
    assert not any(deadman.press(1, 0.4, now_s=1.0) for _ in range(20))
    assert not deadman.held
    assert deadman.press(1, 0.39, now_s=1.0)
