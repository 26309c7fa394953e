from kurt2rt.teacher.page.operator_presence import OperatorPresence


def test_renew_holds_for_the_lease() -> None:
    presence = OperatorPresence(lease_s=0.3)
    assert not presence.is_present(now_s=0.0)
    presence.renew(0.05, now_s=0.0)
    assert presence.is_present(now_s=0.29)
    assert not presence.is_present(now_s=0.3)


def test_renew_on_an_old_state_holds_for_less() -> None:
    presence = OperatorPresence(max_state_age_s=0.5)
    presence.renew(0.5, now_s=0.0)
    assert not presence.is_present(now_s=0.0)
    presence.renew(0.4, now_s=0.0)
    assert presence.is_present(now_s=0.09)
    assert not presence.is_present(now_s=0.11)
    presence.renew(float("inf"), now_s=1.0)
    assert not presence.is_present(now_s=1.0)


def test_end_ends_the_presence() -> None:
    presence = OperatorPresence()
    presence.renew(0.0, now_s=0.0)
    presence.end()
    assert not presence.is_present(now_s=0.0)
