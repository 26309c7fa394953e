from kurt2rt.teacher.page.login_throttle import LoginThrottle


def test_only_so_many_wrong_tries_and_then_one_in_a_while() -> None:
    attempts = LoginThrottle(most=3, per_s=0.5)
    for _ in range(3):
        assert attempts.allowed("a", now_s=0.0)
        attempts.failed("a", now_s=0.0)
    assert not attempts.allowed("a", now_s=1.9)
    assert attempts.allowed("a", now_s=2.0)


def test_who_guesses_locks_out_nobody_else() -> None:
    attempts = LoginThrottle(most=1)
    attempts.failed("a", now_s=0.0)
    assert not attempts.allowed("a", now_s=0.0)
    assert attempts.allowed("b", now_s=0.0)


def test_asking_whether_one_may_is_no_try() -> None:
    attempts = LoginThrottle(most=1)
    assert all(attempts.allowed("a", now_s=0.0) for _ in range(100))


def test_a_flood_of_addresses_is_not_remembered() -> None:
    attempts = LoginThrottle(most=1, per_s=0.0, addresses=10)
    for i in range(10_000):
        attempts.failed(str(i), now_s=0.0)
    remembered = [i for i in range(10_000) if not attempts.allowed(str(i), now_s=0.0)]
    assert remembered == list(range(9_990, 10_000))
