import pytest

from kurt2rt.teacher.page.public_address import PageError, public_address


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("https://Robot.Example", "robot.example"),
        ("https://robot.example/", "robot.example"),
        ("https://robot.example:443", "robot.example"),
        ("https://robot.example:8443", "robot.example:8443"),
        ("https://[fe80::7]:8443", "[fe80::7]:8443"),
    ],
)
def test_public_address_is_written_as_browsers_do(text: str, place: str) -> None:
    assert public_address(text).place == place
    assert public_address(text).origin == f"https://{place}"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "robot.example",
        "http://robot.example",
        "https://",
        "https://robot.example/page",
        "https://me@robot.example",
        "https://robot.example:port",
        "https://robot.example; script-src *",
        "https://[",
    ],
)
def test_public_address_invalid_is_refused(text: str) -> None:
    with pytest.raises(PageError):
        public_address(text)
