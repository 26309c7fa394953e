from kurt2rt.teacher.page.control_lease import ControlLease, OperatorPresence


def test_connect_after_a_hidden_holder_takes_the_lease() -> None:
    lease = ControlLease()
    lease.connect(1, now_s=0.0)
    lease.hide(1)
    lease.renew(1, now_s=0.1)
    lease.connect(2, now_s=0.2)
    assert lease.holder == 1
    lease.hide(1)
    lease.connect(3, now_s=0.2)
    assert lease.holder == 3


def test_disconnect_does_not_pass_the_lease_on() -> None:
    lease = ControlLease()
    lease.connect(1, now_s=0.0)
    lease.connect(2, now_s=0.0)
    lease.disconnect(1)
    assert lease.holder is None
    lease.disconnect(2)
    lease.connect(3, now_s=0.0)
    assert lease.holder == 3


def test_renew_holds_for_the_lease() -> None:
    presence = OperatorPresence(lease_s=0.3)
    assert not presence.is_present(now_s=0.0)
    presence.renew(0.05, now_s=0.0)
    assert presence.is_present(now_s=0.29)
    assert not presence.is_present(now_s=0.3)
