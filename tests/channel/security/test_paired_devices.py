import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from aiocoap import oscore

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.security.paired_devices import PairingChange, Teachers
from kurt2rt.channel.security.pairing import pair, renew, revoke
from tests.channel.clock import Clock
from tests.channel.sides import ask_until_fresh, header_of


class House:
    """A robot's folders, and its teachers while it runs."""

    def __init__(self, folder: Path) -> None:
        self.teachers, self.devices = folder / "teachers", folder / "devices"
        self.clock = Clock()
        self._open: list[Teachers | OscoreContext] = []

    def pair(self, name: str) -> None:
        pair(self.teachers, self.devices, name)

    def start(self) -> Teachers:
        teachers = Teachers(self.teachers, now=self.clock)
        self._open.append(teachers)
        return teachers

    def device(self, name: str) -> OscoreContext:
        device = OscoreContext(self.devices / name)
        self._open.append(device)
        return device

    def close(self) -> None:
        for each in self._open:
            each.close()


@pytest.fixture
def house(tmp_path: Path) -> Iterator[House]:
    house = House(tmp_path)
    yield house
    house.close()


def test_strangers_find_nothing(house: House) -> None:
    house.pair("phone")
    teachers = house.start()
    known = header_of(house.device("phone"))
    for header in (
        {},
        {oscore.COSE_KID: b""},
        {oscore.COSE_KID: b"strange"},
        {**known, oscore.COSE_KID_CONTEXT: b"other"},
    ):
        with pytest.raises(KeyError):
            teachers.find(header)


async def test_device_paired_at_run_time_is_accepted(house: House) -> None:
    teachers = house.start()
    assert teachers.names == ()
    house.pair("phone")
    assert await teachers.refresh() == PairingChange(added=("phone",), removed=())
    device = house.device("phone")
    assert ask_until_fresh(device, teachers.find(header_of(device)), "forward") == "forward"
    assert await teachers.refresh() == PairingChange(added=(), removed=())


async def test_device_revoked_at_run_time_is_refused(house: House) -> None:
    house.pair("phone")
    house.pair("tablet")
    teachers = house.start()
    header = header_of(house.device("phone"))
    context = teachers.find(header)
    revoke(house.teachers, house.devices, "phone")
    assert await teachers.refresh() == PairingChange(added=(), removed=("phone",))
    assert teachers.names == ("tablet",)
    with pytest.raises(KeyError):
        teachers.find(header)
    with pytest.raises(oscore.ContextUnavailable):  # and it is shown no more pictures
        context.new_sequence_number()


async def test_channel_damaged_pairing_is_reported_and_others_work(house: House) -> None:
    house.pair("phone")
    house.pair("tablet")
    (house.teachers / "tablet" / "sequence.json").write_text("", encoding="utf-8")
    teachers = house.start()
    assert teachers.names == ("phone",)
    (line,) = teachers.trouble
    assert "kurt2rt pair tablet --renew" in line
    renew(house.teachers, house.devices, "tablet")
    assert (await teachers.refresh()).added == ("tablet",)
    assert teachers.trouble == ()


def test_two_robot_programs_cannot_share_a_folder(house: House) -> None:
    house.pair("phone")
    house.start()
    second = house.start()
    assert second.names == ()
    assert str(house.teachers / "phone") in second.trouble[0]


async def test_teachers_folder_deleted_refuses_all(house: House, tmp_path: Path) -> None:
    house.pair("phone")
    teachers = house.start()
    house.teachers.rename(tmp_path / "away")
    assert (await teachers.refresh()).removed == ("phone",)


async def test_teachers_unreadable_disk_keeps_contexts(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    house.pair("phone")
    teachers = house.start()

    def broken(_: Path) -> os.stat_result:
        raise OSError(5, "Input/output error")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "stat", broken)
        assert await teachers.refresh() == PairingChange(added=(), removed=())
        assert teachers.names == ("phone",)
        assert "Input/output error" in teachers.trouble[0]
    await teachers.refresh()
    assert teachers.trouble == ()


def test_a_folder_that_is_none_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(CredentialsError, match=re.escape(str(tmp_path / "file"))):
        Teachers(tmp_path / "file")


async def test_pairing_with_critics_name_is_refused_and_reported(house: House) -> None:
    house.pair("phone")
    (house.teachers / "phone").rename(house.teachers / "critic")
    house.pair("tablet")
    teachers = house.start()
    await teachers.refresh()
    assert teachers.names == ("tablet",)
    (line,) = teachers.trouble
    assert "kurt2rt pair critic --revoke" in line
