"""Addresses that a phone is told, from tables of interfaces and in network namespaces."""

import shutil
import socket
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest

from kurt2rt.teacher.page import own_addresses
from kurt2rt.teacher.page.own_addresses import AUTO, NO_ADDRESS, addresses_for_phones

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
