from kurt2rt.teacher.page.auth_middleware import LoginThrottle


def test_is_allowed_after_the_limit_waits_for_a_refill() -> None:
    throttle = LoginThrottle(most=3, per_s=0.5)
    for _ in range(3):
        assert throttle.is_allowed("a", now_s=0.0)
        throttle.on_failure("a", now_s=0.0)
    assert not throttle.is_allowed("a", now_s=1.9)
    assert throttle.is_allowed("a", now_s=2.0)


def test_is_allowed_counts_each_address_alone() -> None:
    throttle = LoginThrottle(most=1)
    throttle.on_failure("a", now_s=0.0)
    assert not throttle.is_allowed("a", now_s=0.0)
    assert throttle.is_allowed("b", now_s=0.0)


def test_on_failure_stores_a_bounded_number_of_addresses() -> None:
    throttle = LoginThrottle(most=1, per_s=0.0, addresses=10)
    for i in range(10_000):
        throttle.on_failure(str(i), now_s=0.0)
    remembered = [i for i in range(10_000) if not throttle.is_allowed(str(i), now_s=0.0)]
    assert remembered == list(range(9_990, 10_000))
