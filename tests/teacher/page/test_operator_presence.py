from kurt2rt.teacher.page.operator_presence import OperatorPresence


def test_somebody_looks_from_heartbeat_to_heartbeat() -> None:
    attention = OperatorPresence(lease_s=0.3)
    assert not attention.there(now_s=0.0)
    attention.beat(0.05, now_s=0.0)
    assert attention.there(now_s=0.29)
    assert not attention.there(now_s=0.3)


def test_who_has_an_old_picture_does_not_look_at_the_robot() -> None:
    attention = OperatorPresence(oldest_picture_s=0.5)
    attention.beat(0.5, now_s=0.0)
    assert not attention.there(now_s=0.0)
    attention.beat(0.4, now_s=0.0)
    assert attention.there(now_s=0.09)
    assert not attention.there(now_s=0.11)
    attention.beat(float("inf"), now_s=1.0)
    assert not attention.there(now_s=1.0)


def test_who_turns_away_does_not_look() -> None:
    attention = OperatorPresence()
    attention.beat(0.0, now_s=0.0)
    attention.lose()
    assert not attention.there(now_s=0.0)
