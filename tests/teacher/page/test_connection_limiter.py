from kurt2rt.teacher.page.uvicorn_protocols import ConnectionLimiter


def test_add_at_the_limit_closes_the_oldest() -> None:
    gone: list[int] = []
    limiter = ConnectionLimiter(most=3, per_address=2)
    for number, address in enumerate(["a", "b", "c", "d", "e"]):
        limiter.add(number, address, lambda number=number: gone.append(number))  # type: ignore[misc]
    assert gone == [0, 1]
    assert len(limiter) == 3


def test_add_at_the_limit_of_an_address_closes_its_oldest() -> None:
    gone: list[int] = []
    limiter = ConnectionLimiter(most=10, per_address=2)
    limiter.add(-1, "teacher", lambda: gone.append(-1))
    for number in range(5):
        limiter.add(number, "flood", lambda number=number: gone.append(number))  # type: ignore[misc]
    assert gone == [0, 1, 2]


def test_remove_ends_the_count() -> None:
    gone: list[int] = []
    limiter = ConnectionLimiter(most=2, per_address=2)
    for number in range(5):
        limiter.add(number, "phone", lambda number=number: gone.append(number))  # type: ignore[misc]
        limiter.remove(number)
    limiter.remove("never came")
    assert gone == []
    assert len(limiter) == 0
