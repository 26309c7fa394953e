import pytest

from kurt2rt.teacher.page.access import Access

TOKEN = "abcdefghijklmnopqrstuvwxyz012345"


def access(token: str = TOKEN, device: str = "phone") -> Access:
    return Access(device, token, ["desk"])


def test_accepts_token_only_the_token() -> None:
    assert access().accepts_token(TOKEN)
    for wrong in ("", TOKEN[:-1], TOKEN + "x", TOKEN.upper(), "\udcff", "ä"):
        assert not access().accepts_token(wrong)


def test_accepts_cookies_only_of_this_token_and_device() -> None:
    rules = access()
    assert rules.accepts_cookies({rules.cookie_name: rules.cookie})
    renewed = access(token=TOKEN[::-1])
    assert not renewed.accepts_cookies({rules.cookie_name: rules.cookie})
    other = access(device="tablet")
    assert not other.accepts_cookies({rules.cookie_name: rules.cookie})


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
def test_is_own_origin_only_this_host_and_port(origin: str, *, ours: bool) -> None:
    assert access().is_own_origin({"host": "desk:8642", "origin": origin}) is ours
