import pytest

from kurt2rt.teacher.page.host_names import host_name, is_own_host, own_names

NAMES = {"robot-desk", "robot-desk.local"}


@pytest.mark.parametrize(
    ("host", "name"),
    [
        ("localhost:8642", "localhost"),
        ("192.168.1.7", "192.168.1.7"),
        ("[::1]:8642", "::1"),
        ("Robot-Desk.local.:80", "robot-desk.local"),
        ("", ""),
        (":80", ""),
        ("[", ""),
    ],
)
def test_host_name_returns_name_or_address(host: str, name: str) -> None:
    assert host_name(host) == name


@pytest.mark.parametrize(
    ("host", "local_address"),
    [
        ("127.0.0.1:8642", "127.0.0.1"),
        ("localhost:8642", "127.0.0.1"),
        ("localhost:8642", "::1"),
        ("[::1]:8642", "::1"),
        ("192.168.1.7:8642", "192.168.1.7"),
        ("192.168.1.7:8642", "::ffff:192.168.1.7"),
        ("robot-desk:8642", "192.168.1.7"),
        ("ROBOT-DESK.local:8642", "192.168.1.7"),
    ],
)
def test_is_own_host_local_address_and_names_are_own(host: str, local_address: str) -> None:
    assert is_own_host(host, local_address, NAMES)


@pytest.mark.parametrize(
    ("host", "local_address"),
    [
        ("evil.example:8642", "127.0.0.1"),
        ("evil.example", "192.168.1.7"),
        ("127.0.0.1.evil.example", "127.0.0.1"),
        ("localhost.evil.example", "127.0.0.1"),
        ("localhost", "192.168.1.7"),
        ("192.168.1.8", "192.168.1.7"),
        ("", "127.0.0.1"),
        ("localhost", ""),
    ],
)
def test_is_own_host_foreign_name_is_not_own(host: str, local_address: str) -> None:
    assert not is_own_host(host, local_address, NAMES)


@pytest.mark.parametrize("domain", ["", ".local", ".lan", ".fritz.box", ".home.arpa"])
def test_own_names_have_the_domains_of_routers(domain: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("socket.gethostname", lambda: "Robot-Desk.office.example")
    assert is_own_host(f"robot-desk{domain}:8642", "192.168.1.7", own_names())
    assert not is_own_host(f"evil{domain}", "192.168.1.7", own_names())
