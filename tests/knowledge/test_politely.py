from kurt2rt.knowledge.politely import politely


def test_the_items_are_the_same() -> None:
    assert list(politely(iter(range(10_000)))) == list(range(10_000))
    assert list(politely([])) == []
