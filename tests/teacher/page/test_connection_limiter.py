from kurt2rt.teacher.page.connection_limiter import ConnectionLimiter


def test_the_oldest_gives_way() -> None:
    gone: list[int] = []
    crowd = ConnectionLimiter(most=3, per_address=2)
    for number, address in enumerate(["a", "b", "c", "d", "e"]):
        crowd.enter(number, address, lambda number=number: gone.append(number))  # type: ignore[misc]
    assert gone == [0, 1]
    assert len(crowd) == 3


def test_who_opens_many_pushes_out_his_own() -> None:
    gone: list[int] = []
    crowd = ConnectionLimiter(most=10, per_address=2)
    crowd.enter(-1, "teacher", lambda: gone.append(-1))
    for number in range(5):
        crowd.enter(number, "flood", lambda number=number: gone.append(number))  # type: ignore[misc]
    assert gone == [0, 1, 2]


def test_who_has_shown_the_cookie_is_not_counted() -> None:
    gone: list[int] = []
    crowd = ConnectionLimiter(most=2, per_address=2)
    for number in range(5):
        crowd.enter(number, "phone", lambda number=number: gone.append(number))  # type: ignore[misc]
        crowd.leave(number)
    crowd.leave("never came")
    assert gone == []
    assert len(crowd) == 0
