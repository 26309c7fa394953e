import pytest

from kurt2rt.teacher.page.access import Access

TOKEN = "abcdefghijklmnopqrstuvwxyz012345"


def access(token: str = TOKEN, device: str = "phone") -> Access:
    return Access(device, token, ["desk"])


def test_the_token_opens_and_nothing_else_does() -> None:
    assert access().opens(TOKEN)
    for wrong in ("", TOKEN[:-1], TOKEN + "x", TOKEN.upper(), "\udcff", "ä"):
        assert not access().opens(wrong)


def test_the_cookie_is_known_again_but_not_under_another_token_or_device() -> None:
    door = access()
    assert door.knows({door.cookie_name: door.cookie})
    renewed = access(token=TOKEN[::-1])
    assert not renewed.knows({door.cookie_name: door.cookie})
    other = access(device="tablet")
    assert not other.knows({door.cookie_name: door.cookie})


@pytest.mark.parametrize("cookies", [{}, {"kurt2rt-phone": ""}, {"kurt2rt-phone": TOKEN}, {"kurt2rt-phone": "\udcff"}])
def test_no_other_cookie_is(cookies: dict[str, str]) -> None:
    assert not access().knows(cookies)


def test_the_cookie_does_not_tell_the_token() -> None:
    assert TOKEN not in access().cookie


@pytest.mark.parametrize(
    ("origin", "ours"),
    [
        ("http://desk:8642", True),
        ("HTTP://Desk:8642", True),
        ("http://desk", False),
        ("https://desk:8642", False),
        ("http://evil.example", False),
        ("null", False),
        ("", False),
    ],
)
def test_a_websocket_has_to_come_from_a_page_of_ours(origin: str, *, ours: bool) -> None:
    assert access().comes_from_us({"host": "desk:8642", "origin": origin}) is ours


def test_a_websocket_without_an_origin_is_no_browser_s() -> None:
    assert not access().comes_from_us({"host": "desk:8642"})
