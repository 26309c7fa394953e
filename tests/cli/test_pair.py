import json
from pathlib import Path

import pytest

from kurt2rt.channel.security.pairing import Device, local_pairing, read_device
from kurt2rt.cli.qr_code import qr_code
from kurt2rt.teacher.page import own_addresses
from kurt2rt.teacher.page.own_addresses import NO_ADDRESS
from tests.cli.helpers import CommandLine

TEACHERS, DEVICES = Path("var/teachers"), Path("var/devices")


def device_of(name: str) -> Device:
    return read_device(DEVICES / name)


def test_pair_prints_link_and_code(kurt2rt: CommandLine) -> None:
    said = kurt2rt("pair", "anna-phone", "--page-address", "10.0.0.7")
    assert said.exit_code == 0, said.err
    address = f"http://10.0.0.7:8642/pair?token={device_of('anna-phone').token}"
    assert address in said.out
    assert qr_code(address).plain in said.out
    assert str(TEACHERS / "anna-phone") in said.out
    assert str(DEVICES / "anna-phone") in said.out
    assert "kurt2rt run --phone" in said.out


def test_pair_without_a_network_shows_no_code(kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(own_addresses, "_ranked", lambda: iter(()))
    said = kurt2rt("pair", "phone")
    assert said.exit_code == 0
    assert NO_ADDRESS in said.out
    assert "?token=" not in said.out
    assert "█" not in said.out


@pytest.mark.parametrize("address", ["http://robot.lan", "10.0.0.7:8642", "fe80::1%wlan0", ""])
def test_pair_address_of_another_form_is_refused(kurt2rt: CommandLine, address: str) -> None:
    assert "without http:// and port" in kurt2rt.misused("pair", "phone", "--page-address", address)
    assert not DEVICES.exists()


def test_a_revoked_device_is_listed_no_longer(kurt2rt: CommandLine) -> None:
    kurt2rt("pair", "phone")
    kurt2rt("pair", "tablet")
    assert kurt2rt("pair", "--revoke", "phone").exit_code == 0
    said = kurt2rt("pair", "--list")
    assert "tablet" in said.out
    assert "phone" not in said.out
    assert kurt2rt.refused("pair", "--revoke", "phone").endswith(" tablet")


def test_the_list_tells_who_is_paired_and_where_the_device_is(kurt2rt: CommandLine) -> None:
    assert json.loads(kurt2rt("pair", "--list", "--json").out) == {"paired": []}
    kurt2rt("pair", "phone")
    kurt2rt("pair", "tablet")
    (DEVICES / "tablet").rename("tablet")
    local_pairing(TEACHERS, DEVICES)
    rows = [line.split() for line in kurt2rt("pair", "--list").out.splitlines() if "never" in line]
    assert [(row[0], row[-1]) for row in rows] == [("local", "own"), ("phone", "here"), ("tablet", "away")]


@pytest.mark.parametrize("name", ["Anna", "a b", "../robot", "local"])
def test_pair_invalid_name_is_refused(kurt2rt: CommandLine, name: str) -> None:
    assert kurt2rt.refused("pair", name)
    assert not DEVICES.exists()
