from kurt2rt.teacher.page.control_lease import ControlLease


def test_connect_second_page_leaves_the_lease() -> None:
    lease = ControlLease()
    lease.connect(1, now_s=0.0)
    lease.connect(2, now_s=0.5)
    assert lease.holder == 1


def test_claim_newest_page_has_the_lease() -> None:
    lease = ControlLease()
    lease.connect(1, now_s=0.0)
    lease.claim(2, now_s=0.1)
    lease.claim(3, now_s=0.2)
    assert lease.holder == 3


def test_connect_after_a_silent_holder_takes_the_lease() -> None:
    lease = ControlLease(silent_s=1.0)
    lease.connect(1, now_s=0.0)
    lease.renew(1, now_s=5.0)
    lease.connect(2, now_s=5.9)
    assert lease.holder == 1
    lease.connect(3, now_s=6.1)
    assert lease.holder == 3


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
