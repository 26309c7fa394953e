import json
import os
import re
import secrets
import stat
from collections.abc import Callable
from contextlib import closing
from itertools import count
from pathlib import Path

import pytest

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.security.pairing import Device, list_pairings, local_pairing, pair, read_device, renew, revoke
from kurt2rt.core.rla.rla import AUTO
from tests.channel.sides import ask_until_fresh


@pytest.fixture
def teachers(tmp_path: Path) -> Path:
    return tmp_path / "var" / "teachers"


@pytest.fixture
def devices(tmp_path: Path) -> Path:
    return tmp_path / "var" / "devices"


def understood(teacher: Path, device: Path) -> bool:
    with closing(OscoreContext(device)) as with_device, closing(OscoreContext(teacher)) as with_robot:
        return ask_until_fresh(with_device, with_robot, "forward") == "forward"


def test_pair_secrets_are_readable_by_owner_only(teachers: Path, devices: Path) -> None:
    before = os.umask(0)
    try:
        pair(teachers, devices, "phone")
    finally:
        os.umask(before)
    for path in (teachers, devices, *teachers.rglob("phone/**"), *devices.rglob("phone/**")):
        assert stat.S_IMODE(path.stat().st_mode) == (0o700 if path.is_dir() else 0o600), path
    for path in (*teachers.rglob("*.json"), *devices.rglob("*.json")):
        assert stat.S_IMODE(path.stat().st_mode) == 0o600, path


def test_an_id_that_is_taken_is_drawn_again(teachers: Path, devices: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pair(teachers, devices, "a")
    taken = json.loads((teachers / "a" / "settings.json").read_text(encoding="utf-8"))["sender-id_hex"]
    draws = iter([taken, "0a", "0a", taken, "0b", "5ec2e7", "5a17"])
    monkeypatch.setattr(secrets, "token_hex", lambda _bytes: next(draws))
    pair(teachers, devices, "b")
    ids = json.loads((teachers / "b" / "settings.json").read_text(encoding="utf-8"))
    assert (ids["sender-id_hex"], ids["recipient-id_hex"]) == ("0a", "0b")


@pytest.mark.parametrize(
    "name", ["", "Anna", "anna phone", "../x", ".", "a" * 25, "ann\N{LATIN SMALL LETTER A}\n", "é"]
)
def test_pair_invalid_name_is_refused(teachers: Path, devices: Path, name: str) -> None:
    for change in (pair, renew, revoke):
        with pytest.raises(CredentialsError, match="a-z, 0-9"):
            change(teachers, devices, name)
    assert not teachers.exists()


@pytest.mark.parametrize("name", ["local", "auto", "terminal"])
def test_the_names_of_this_machine_are_not_paired(teachers: Path, devices: Path, name: str) -> None:
    with pytest.raises(CredentialsError, match=name):
        pair(teachers, devices, name)


def test_pair_critics_name_can_only_be_revoked(teachers: Path, devices: Path) -> None:
    for change in (pair, renew):
        with pytest.raises(CredentialsError, match=r"^critic: "):
            change(teachers, devices, "critic")
    assert not teachers.exists()
    pairing = pair(teachers, devices, "phone")
    pairing.teacher.rename(teachers / "critic")
    revoke(teachers, devices, "critic")
    assert not (teachers / "critic").exists()


def test_paired_twice_is_refused_and_changes_nothing(teachers: Path, devices: Path) -> None:
    pairing = pair(teachers, devices, "phone")
    with pytest.raises(CredentialsError, match="kurt2rt pair phone --renew"):
        pair(teachers, devices, "phone")
    assert understood(pairing.teacher, pairing.device.folder)


def test_revoke_deletes_both_sides_in_use(teachers: Path, devices: Path) -> None:
    pairing = pair(teachers, devices, "phone")
    robot = OscoreContext(pairing.teacher)
    revoke(teachers, devices, "phone")
    assert list_pairings(teachers) == ()
    assert list(teachers.glob("*phone*")) == []
    assert list(devices.glob("*phone*")) == []
    robot.close()
    pair(teachers, devices, "phone")


class KilledError(BaseException):
    """The process ends here."""


STEPS = ((os, "fsync"), (os, "open"), (os, "rmdir"), (Path, "rename"), (Path, "mkdir"))
"""Steps of a change on the disk."""


def change_until_killed(teachers: Path, devices: Path, steps: int, patch: pytest.MonkeyPatch) -> bool:
    """Renew one pairing and make another, killed after so many steps; returns whether it was."""
    left = iter(range(steps))

    def killable(step: Callable[..., object]) -> Callable[..., object]:
        def stepped(*args: object, **kwargs: object) -> object:
            if next(left, None) is None:
                raise KilledError
            return step(*args, **kwargs)

        return stepped

    with patch.context() as patched:
        for where, name in STEPS:
            patched.setattr(where, name, killable(getattr(where, name)))
        try:
            renew(teachers, devices, "tablet")
            pair(teachers, devices, "phone")
        except KilledError:
            return True
    return False


def test_killed_at_any_step_a_pairing_is_whole_or_not_accepted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for steps in count():
        teachers, devices = tmp_path / f"{steps}" / "teachers", tmp_path / f"{steps}" / "devices"
        pair(teachers, devices, "tablet")
        killed = change_until_killed(teachers, devices, steps, monkeypatch)
        for each in list_pairings(teachers):
            assert understood(teachers / each.name, devices / each.name)
        for name in ("tablet", "phone"):
            there = any(os.path.lexists(side / name) for side in (teachers, devices))
            (renew if there else pair)(teachers, devices, name)
            assert understood(teachers / name, devices / name)
        assert {path.name for path in (*teachers.iterdir(), *devices.iterdir())} == {".lock", "tablet", "phone"}
        if not killed:
            assert steps > 30
            return


def test_this_machine_needs_no_pairing(teachers: Path, devices: Path) -> None:
    made = local_pairing(teachers, devices)
    assert made.name == "local"
    assert understood(made.teacher, made.device.folder)
    again = local_pairing(teachers, devices, port=6000)
    assert again.device == Device(made.device.folder, "local", "127.0.0.1", 6000, made.device.token)
    assert local_pairing(teachers, devices, AUTO).name == "auto"


@pytest.mark.parametrize("lost", ["teachers/local", "devices/local"])
def test_local_pairing_is_made_again_if_a_side_is_lost(teachers: Path, devices: Path, lost: str) -> None:
    local_pairing(teachers, devices)
    (teachers.parent / lost).rename(teachers.parent / "lost")
    made = local_pairing(teachers, devices)
    assert understood(made.teacher, made.device.folder)


def test_one_folder_for_both_sides_is_refused(teachers: Path) -> None:
    with pytest.raises(CredentialsError, match=re.escape(str(teachers))):
        pair(teachers, teachers, "phone")


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(CredentialsError, match=re.escape(str(tmp_path / "file"))):
        pair(tmp_path / "file", tmp_path / "devices", "phone")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"name": 1, "host": "h", "port": 1, "token": "t"}'])
def test_a_damaged_device_is_told(teachers: Path, devices: Path, text: str) -> None:
    device = pair(teachers, devices, "phone").device
    (device.folder / "device.json").write_text(text, encoding="utf-8")
    with pytest.raises(CredentialsError, match="kurt2rt pair phone --renew"):
        read_device(device.folder)
