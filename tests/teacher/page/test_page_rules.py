"""Rules of the page that need no browser: access, lease, deadman switch, addresses, limits."""

import json
import math
import shutil
import socket
import subprocess
import sys
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import psutil
import pytest

from kurt2rt.teacher.page import own_addresses
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.auth_middleware import LoginThrottle
from kurt2rt.teacher.page.control_lease import ControlLease, OperatorPresence
from kurt2rt.teacher.page.host_names import is_own_host, own_names
from kurt2rt.teacher.page.own_addresses import AUTO, NO_ADDRESS, addresses_for_phones
from kurt2rt.teacher.page.page_connection import DeadmanSwitch, PageConnection, SentStates
from kurt2rt.teacher.page.public_address import PageError, public_address
from kurt2rt.teacher.page.uvicorn_protocols import ConnectionLimiter

LAN, TUNNEL = "up,broadcast,running,multicast", "up,pointopoint,running,noarp"
Table = dict[str, tuple[str, ...]]


@pytest.fixture(autouse=True)
def _no_sysfs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Keep the interfaces of this machine out, and describe one that is a bridge of containers."""
    monkeypatch.setattr(own_addresses, "_INTERFACES", tmp_path)
    (tmp_path / "docker0").mkdir()


def set_interfaces(monkeypatch: pytest.MonkeyPatch, table: Table) -> None:
    """Let psutil tell these interfaces; of each its flags, empty for one that is down, and its addresses."""
    stats = {name: SimpleNamespace(isup=bool(flags), flags=flags) for name, (flags, *_) in table.items()}
    addresses = {
        name: [SimpleNamespace(family=socket.AF_INET, address=each) for each in (*rest, "02:fc:00:00:00:01")]
        for name, (_, *rest) in table.items()
    }
    monkeypatch.setattr(psutil, "net_if_stats", lambda: stats)
    monkeypatch.setattr(psutil, "net_if_addrs", lambda: addresses)


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ({"lo": ("up,loopback,running", "127.0.0.1", "10.9.9.9")}, ()),
        ({"lo": ("up,loopback,running", "::1"), "wlan0": (LAN, "10.42.0.1", "fd00::1")}, ("10.42.0.1",)),
        ({"tun0": (TUNNEL, "10.8.0.2"), "eth0": (LAN, "192.168.1.5")}, ("192.168.1.5", "10.8.0.2")),
        ({"eth0": (LAN, "93.184.216.34"), "wlan0": (LAN, "192.168.1.5")}, ("192.168.1.5", "93.184.216.34")),
        ({"docker0": (LAN, "172.17.0.1"), "wlan0": (LAN, "192.168.1.5")}, ("192.168.1.5", "172.17.0.1")),
        ({"eth0": (LAN, "169.254.3.4"), "wlan0": (LAN, "192.168.1.5")}, ("192.168.1.5", "169.254.3.4")),
        ({"wlan0": (LAN, "fe80::1%wlan0", "2a02:8108::7", "fd00::1")}, ("fd00::1", "2a02:8108::7")),
        ({"wlan0": (LAN, "fe80::1%wlan0")}, ()),
        ({"wlan0": ("", "192.168.1.5")}, ()),
    ],
)
def test_addresses_for_phones_come_by_reach(
    table: Table, told: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    set_interfaces(monkeypatch, table)
    assert addresses_for_phones(AUTO) == told


@pytest.mark.deep
@pytest.mark.parametrize(
    ("interface", "told"),
    [
        ("ip addr add 10.42.0.1/24 dev wlan0", ["http://10.42.0.1:8642/pair"]),
        ("ip addr add fd00::7/64 dev wlan0 nodad", ["http://[fd00::7]:8642/pair"]),
        ("ip link set wlan0 down", []),
    ],
)
def test_pair_in_a_namespace_tells_its_address(interface: str, told: list[str], tmp_path: Path) -> None:
    if shutil.which("unshare") is None or subprocess.run(["unshare", "-rn", "true"], check=False).returncode:
        pytest.skip("no network namespaces here")
    words = f"{sys.executable} -m kurt2rt.cli.main pair phone"
    link = "ip link set lo up; ip link add wlan0 type veth peer name phone; ip link set phone up; ip link set wlan0 up"
    script = f"{link}; {interface}; exec {words}"
    said = subprocess.run(
        ["unshare", "-rn", "sh", "-ec", script], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=True
    ).stdout
    assert [line.split()[-1].partition("?")[0] for line in said.splitlines() if "?token=" in line] == told
    assert (NO_ADDRESS in said) == (not told)
    assert ("█" in said) == bool(told)


def test_age_s_unknown_or_forgotten_state_is_infinite() -> None:
    states = SentStates(history=2)
    first = states.add(b"boot", 1, now_s=0.0)
    states.add(b"boot", 2, now_s=0.0)
    assert states.get(first) is not None
    states.add(b"boot", 3, now_s=0.0)
    assert states.get(first) is None
    for number in (None, 0, first, 4):
        assert states.age_s(number, now_s=0.0) == math.inf


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
        *("", "robot.example", "http://robot.example", "https://", "https://robot.example/page"),
        *("https://me@robot.example", "https://robot.example:port", "https://robot.example; script-src *"),
        "https://[",
    ],
)
def test_public_address_invalid_is_refused(text: str) -> None:
    with pytest.raises(PageError):
        public_address(text)


def sent_by(connection: PageConnection, now_s: float = 0.0) -> list[dict[str, Any]]:
    found = []
    while (text := connection.pop(now_s)) is not None:
        found.append(json.loads(text))
    return found


def visible() -> PageConnection:
    connection = PageConnection(1)
    connection.visible = True
    return connection


def test_pop_slow_page_gets_the_newest_state_next() -> None:
    connection = visible()
    sent: list[dict[str, Any]] = []
    for tick in range(100):
        connection.set_state(b"boot", {"kind": "state", "tick": tick})
        sent += sent_by(connection)
    assert len(sent) == 8
    connection.states.acknowledge(sent[-1]["picture"])
    assert [each["tick"] for each in sent_by(connection)] == [99]


def test_send_of_one_topic_replaces_the_message_that_waits() -> None:
    connection = PageConnection(1)
    for number in range(1000):
        connection.send({"kind": "lessons", "number": number}, topic="lessons")
    connection.send({"kind": "answer"})
    assert [each.get("number") for each in sent_by(connection)] == [999, None]
    assert not connection.lost


def test_send_to_a_full_queue_loses_the_page() -> None:
    connection = PageConnection(1)
    for number in range(1000):
        connection.send({"kind": "answer", "number": number})
    assert connection.lost
    assert len(sent_by(connection)) == 64


NAMES = {"robot-desk", "robot-desk.local"}


@pytest.mark.parametrize(
    ("local_address", "own", "foreign"),
    [
        ("127.0.0.1", ["127.0.0.1:8642", "localhost:8642"], ["evil.example:8642", "127.0.0.1.evil.example"]),
        ("127.0.0.1", [], ["localhost.evil.example", "", ":80", "["]),
        ("::1", ["localhost:8642", "[::1]:8642"], []),
        ("192.168.1.7", ["192.168.1.7", "192.168.1.7:8642"], ["evil.example", "localhost", "192.168.1.8"]),
        ("192.168.1.7", ["robot-desk:8642", "Robot-Desk.local.:80"], []),
        ("::ffff:192.168.1.7", ["192.168.1.7:8642"], []),
        ("", [], ["localhost"]),
    ],
)
def test_is_own_host_tells_own_addresses_and_names(local_address: str, own: list[str], foreign: list[str]) -> None:
    assert [each for each in (*own, *foreign) if is_own_host(each, local_address, NAMES)] == own


@pytest.mark.parametrize("domain", ["", ".local", ".lan", ".fritz.box", ".home.arpa"])
def test_own_names_have_the_domains_of_routers(domain: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("socket.gethostname", lambda: "Robot-Desk.office.example")
    assert is_own_host(f"robot-desk{domain}:8642", "192.168.1.7", own_names())
    assert not is_own_host(f"evil{domain}", "192.168.1.7", own_names())


FRESH_S = 0.05


def test_press_renewed_in_time_does_not_expire() -> None:
    deadman = DeadmanSwitch(lease_s=0.25)
    assert deadman.press(1, FRESH_S, now_s=0.0)
    assert deadman.press(1, FRESH_S, now_s=0.2)
    assert not deadman.expired(now_s=0.44)
    assert deadman.expired(now_s=0.45)


def test_press_after_its_release_or_a_later_press_does_not_count() -> None:
    deadman = DeadmanSwitch()
    deadman.press(1, FRESH_S, now_s=0.0)
    deadman.release()
    assert not deadman.press(1, FRESH_S, now_s=0.1)
    assert not deadman.held
    assert deadman.press(2, FRESH_S, now_s=0.2)
    assert deadman.press(3, FRESH_S, now_s=0.3)
    assert not deadman.press(2, FRESH_S, now_s=0.35)
    assert deadman.is_held_by(3)


def test_press_on_an_aging_state_expires_earlier() -> None:
    deadman = DeadmanSwitch(lease_s=0.25, max_state_age_s=0.4)
    deadman.press(1, 0.3, now_s=0.0)
    assert not deadman.expired(now_s=0.09)
    assert deadman.expired(now_s=0.11)


def test_press_on_an_old_state_does_not_count() -> None:
    deadman = DeadmanSwitch(max_state_age_s=0.4)
    assert not any(deadman.press(1, 0.4, now_s=1.0) for _ in range(20))
    assert not deadman.held
    assert deadman.press(1, 0.39, now_s=1.0)


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


def test_renew_holds_for_the_lease() -> None:
    presence = OperatorPresence(lease_s=0.3)
    assert not presence.is_present(now_s=0.0)
    presence.renew(0.05, now_s=0.0)
    assert presence.is_present(now_s=0.29)
    assert not presence.is_present(now_s=0.3)


@pytest.mark.parametrize(("most", "addresses", "gone"), [(3, "abcde", [0, 1]), (10, "abbbbb", [1, 2, 3])])
def test_add_at_a_limit_closes_the_oldest(most: int, addresses: str, gone: list[int]) -> None:
    closed: list[int] = []
    limiter = ConnectionLimiter(most, per_address=2)
    for number, address in enumerate(addresses):
        limiter.add(number, address, partial(closed.append, number))
    assert (closed, len(limiter)) == (gone, 3)


def test_remove_ends_the_count() -> None:
    gone: list[int] = []
    limiter = ConnectionLimiter(most=2, per_address=2)
    for number in range(5):
        limiter.add(number, "phone", partial(gone.append, number))
        limiter.remove(number)
    limiter.remove("never came")
    assert gone == []
    assert len(limiter) == 0


def test_is_allowed_after_the_limit_waits_for_a_refill() -> None:
    throttle = LoginThrottle(most=3, per_s=0.5)
    for _ in range(3):
        assert throttle.is_allowed("a", now_s=0.0)
        throttle.on_failure("a", now_s=0.0)
    assert not throttle.is_allowed("a", now_s=1.9)
    assert throttle.is_allowed("a", now_s=2.0)


def test_on_failure_stores_a_bounded_number_of_addresses() -> None:
    throttle = LoginThrottle(most=1, per_s=0.0, addresses=10)
    for i in range(10_000):
        throttle.on_failure(str(i), now_s=0.0)
    remembered = [i for i in range(10_000) if not throttle.is_allowed(str(i), now_s=0.0)]
    assert remembered == list(range(9_990, 10_000))


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
        *(("http://desk:8642", True), ("HTTP://Desk:8642", True), ("http://desk", False)),
        *(("https://desk:8642", False), ("http://evil.example", False), ("null", False), ("", False)),
    ],
)
def test_is_own_origin_only_this_host_and_port(origin: str, *, ours: bool) -> None:
    assert access().is_own_origin({"host": "desk:8642", "origin": origin}) is ours
