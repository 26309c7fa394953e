"""Pairings of teachers' devices with this robot: made, listed, renewed and revoked, also while the robot runs.

A pairing is two folders, one for each side: `<teachers>/<name>` stays with the robot, `<devices>/<name>` goes with the
device. Each holds the shared secret; a folder is moved, never copied, because its sequence numbers count once.
"""

import fcntl
import json
import os
import re
import secrets
import shutil
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

from kurt2rt.channel.security.context_folder import PAIRED_AT, SECRET, SEQUENCE, SETTINGS, UNKNOWN, CredentialsError
from kurt2rt.core.rla.rla import AUTO, CRITIC
from kurt2rt.platform.durable_files import fsync_folder, make_private_folder

LOCAL = "local"
"""Teacher at the robot's own machine, with the page or a program."""
TERMINAL = "terminal"
"""Teacher at a terminal of the robot's own machine, so that the page can be open at the same time."""
ONLOOKER = "onlooker"
"""Program at the robot's own machine that only queries while others teach."""
OF_THIS_MACHINE = frozenset({LOCAL, AUTO, TERMINAL, ONLOOKER})
"""Pairings made on demand, by programs that can read both folders, without `kurt2rt pair`."""
RESERVED = frozenset({CRITIC})
"""Names of the robot's own programs in the journal; a device of that name would pass for the robot."""

USED = "used"
"""File on the robot's side whose time is that of the device's last message."""

PORT = 5683
_HERE = "127.0.0.1"

_NAME = re.compile(r"[a-z0-9-]{1,24}")
_DEVICE = "device.json"
_LOCK = ".lock"
_UNFINISHED = ".unborn-"
_REVOKED = ".revoked-"
_SECRET_BYTES = 16
_SALT_BYTES = 8
_ID_BYTES = 3
_TOKEN_BYTES = 24  # 32 characters


class PairingFolders(NamedTuple):
    """Folders that hold the robot's sides (`teachers`) and the devices' sides (`devices`) of all pairings."""

    teachers: Path
    devices: Path


@dataclass(frozen=True, slots=True)
class Device:
    """Device's side of a pairing: the folder of its keys, and the robot's address in it."""

    folder: Path
    name: str
    host: str
    """Address of the robot, for the program that holds this folder."""
    port: int
    token: str
    """Login token of the device's web page, 32 characters."""


@dataclass(frozen=True, slots=True)
class Pairing:
    """Folders with the common keys of robot and device (OSCORE, RFC 8613), as `kurt2rt pair` makes them.

    The robot keeps `teacher`; `device` goes to the program of the device, once: its message numbers count up.
    """

    teacher: Path
    """Folder of the robot's side."""
    device: Device

    @property
    def name(self) -> str:
        """Name of the device, and of the teacher who uses it."""
        return self.device.name


@dataclass(frozen=True, slots=True)
class PairingInfo:
    """Entry in the list of pairings: a device that the robot accepts, with the times of pairing and use."""

    name: str
    made_at: datetime
    used_at: datetime | None
    """Time of the device's last message, to the minute; None: never."""


def pair(teachers: Path, devices: Path, name: str, *, port: int = PORT) -> Pairing:
    """Make a new pairing; a running robot accepts it within a second.

    Args:
        teachers: folder of the robot's sides.
        devices: folder of the devices' sides.
        name: of the device and its teacher.
        port: UDP port of the robot.

    Raises:
        CredentialsError: the name is taken, reserved or invalid, or a folder cannot be written.
    """
    _require_free_name(name)
    if name in OF_THIS_MACHINE:
        raise CredentialsError("is the name of this machine's own teacher", where=name, do="choose another one")
    with _changing(teachers, devices):
        for side in (teachers, devices):
            if os.path.lexists(side / name):
                raise CredentialsError(
                    "is paired already", where=side / name, do=f"for new keys: kurt2rt pair {name} --renew"
                )
        return _make(teachers, devices, name, port)


def renew(teachers: Path, devices: Path, name: str, *, port: int = PORT) -> Pairing:
    """Give a pairing new secrets, ids and token; the old ones are refused from now on.

    Args:
        teachers: folder of the robot's sides.
        devices: folder of the devices' sides.
        name: of the device.
        port: UDP port of the robot.

    Raises:
        CredentialsError: neither side exists, the name is reserved, or a folder cannot be written.
    """
    _require_free_name(name)
    with _changing(teachers, devices):
        _remove(teachers, devices, name)
        return _make(teachers, devices, name, port)


def revoke(teachers: Path, devices: Path, name: str) -> None:
    """Delete both sides of a device's pairing; a running robot refuses the device within a second.

    `teachers`, `devices`: folders of the robot's and of the devices' sides. Raises CredentialsError if neither side
    exists.
    """
    _require_name(name)
    with _changing(teachers, devices):
        _remove(teachers, devices, name)


def list_pairings(teachers: Path) -> tuple[PairingInfo, ...]:
    """Return all pairings of the robot by name, those of this machine included.

    Raises CredentialsError if the folder cannot be read.
    """
    found = []
    for name in pairing_names(teachers):
        made, used = _changed_at(teachers / name / SECRET), _changed_at(teachers / name / USED)
        if made is not None:
            found.append(PairingInfo(name, made, used))
    return tuple(found)


def local_pairing(teachers: Path, devices: Path, name: str = LOCAL, *, port: int = PORT) -> Pairing:
    """Return the pairing of one of this machine's own teachers; make it if absent, or if its sides do not fit.

    Args:
        teachers: Folder of the robot's sides.
        devices: Folder of the devices' sides.
        name: One of OF_THIS_MACHINE.
        port: UDP port of the robot at this machine.

    Raises:
        CredentialsError: a folder cannot be read or written.
        ValueError: another name.
    """
    if name not in OF_THIS_MACHINE:
        raise ValueError(f"{name} is none of {', '.join(sorted(OF_THIS_MACHINE))}")
    with _changing(teachers, devices):
        if _fit(teachers / name, devices / name):
            device = read_device(devices / name)
            return Pairing(teachers / name, replace(device, host=_HERE, port=port))
        if any(os.path.lexists(side / name) for side in (teachers, devices)):
            _remove(teachers, devices, name)
        return _make(teachers, devices, name, port)


def open_device(pairings: PairingFolders, name: str, port: int) -> Device:
    """Return the device's side of a pairing; one of this machine's own gets `port`, and is made if absent.

    `port`: UDP port of the robot at this machine. Raises CredentialsError.
    """
    if name in OF_THIS_MACHINE:
        return local_pairing(*pairings, name, port=port).device
    return read_device(pairings.devices / name)


def read_device(folder: Path) -> Device:
    """Return the device's side in a folder. Raises CredentialsError if it is missing or damaged."""
    try:
        read = _read(folder / _DEVICE)
        name, host, port, token = (read[key] for key in ("name", "host", "port", "token"))
    except OSError as error:
        raise CredentialsError(
            f"no device is paired here ({error.strerror})",
            where=folder,
            do=f"make one on the robot's machine: kurt2rt pair {folder.name}",
        ) from error
    except (ValueError, KeyError) as error:
        raise CredentialsError(
            f"is damaged ({error!r})",
            where=folder / _DEVICE,
            do=f"pair the device again: kurt2rt pair {folder.name} --renew",
        ) from error
    if not (isinstance(name, str) and isinstance(host, str) and isinstance(port, int) and isinstance(token, str)):
        raise CredentialsError(
            "is damaged (wrong types)",
            where=folder / _DEVICE,
            do=f"pair the device again: kurt2rt pair {folder.name} --renew",
        )
    return Device(folder, name, host, port, token)


def pairing_names(teachers: Path) -> tuple[str, ...]:
    """Return the names of all pairings; none if `teachers` is absent. Raises CredentialsError."""
    try:
        return tuple(sorted(path.name for path in teachers.iterdir() if _NAME.fullmatch(path.name) and path.is_dir()))
    except FileNotFoundError:
        return ()
    except OSError as error:
        raise CredentialsError(f"cannot be read ({error})", where=teachers, do="give a folder that can") from error


def _require_name(name: str) -> None:
    if not _NAME.fullmatch(name):
        raise CredentialsError(
            "cannot name a device", where=repr(name), do="give 1 to 24 of a-z, 0-9 and -, such as anna-phone"
        )


def _require_free_name(name: str) -> None:
    _require_name(name)
    if name in RESERVED:
        raise CredentialsError("is the name of the robot's own critic", where=name, do="choose another one")


@contextmanager
def _changing(teachers: Path, devices: Path) -> Iterator[None]:
    """Lock both folders for one change, after deleting the unfinished work of killed programs."""
    try:
        with ExitStack() as locks:
            for folder in (teachers, devices):
                make_private_folder(folder)
            if teachers.samefile(devices):
                raise CredentialsError(
                    "holds one side of each pairing", where=teachers, do="give the other a folder of its own"
                )
            for folder in (teachers, devices):
                lock = locks.enter_context((folder / _LOCK).open("ab"))
                fcntl.flock(lock, fcntl.LOCK_EX)
                for left in (*folder.glob(f"{_UNFINISHED}*"), *folder.glob(f"{_REVOKED}*")):
                    shutil.rmtree(left)
            yield
    except OSError as error:
        raise CredentialsError(
            str(error), where=f"{teachers}, {devices}", do="give folders that can be written"
        ) from error


def _make(teachers: Path, devices: Path, name: str, port: int) -> Pairing:
    taken = _ids_taken(teachers)
    robot_id = _new_id(taken)
    device_id = _new_id({*taken, robot_id})
    secret: dict[str, Any] = {
        "secret_hex": secrets.token_hex(_SECRET_BYTES),
        "salt_hex": secrets.token_hex(_SALT_BYTES),
    }
    paired_s = int(time.time())
    # Written at once, because a context without it counts as damaged, not as new.
    sequence: dict[str, Any] = {"next-to-send": 0, "received": UNKNOWN}
    device = Device(devices / name, name, _HERE, port, secrets.token_urlsafe(_TOKEN_BYTES))
    of_device = {
        SETTINGS: {"sender-id_hex": device_id, "recipient-id_hex": robot_id, PAIRED_AT: paired_s},
        SECRET: secret,
        SEQUENCE: sequence,
        _DEVICE: {"name": name, "host": _HERE, "port": port, "token": device.token},
    }
    of_robot = {
        SETTINGS: {"sender-id_hex": robot_id, "recipient-id_hex": device_id, PAIRED_AT: paired_s},
        SECRET: secret,
        SEQUENCE: sequence,
    }
    # The robot's side is put into place last: a crash before leaves a device that the robot refuses.
    aside = [_write_aside(devices, name, of_device), _write_aside(teachers, name, of_robot)]
    for unborn, folder in zip(aside, (devices, teachers), strict=True):
        unborn.rename(folder / name)
        fsync_folder(folder)
    return Pairing(teachers / name, device)


def _write_aside(folder: Path, name: str, files: dict[str, dict[str, Any]]) -> Path:
    unborn = folder / f"{_UNFINISHED}{name}"
    unborn.mkdir(mode=0o700)
    for file_name, content in files.items():
        descriptor = os.open(unborn / file_name, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with open(descriptor, "w", encoding="utf-8") as file:  # noqa: PTH123 - a descriptor
            json.dump(content, file, indent=2)
            file.flush()
            os.fsync(file.fileno())
    fsync_folder(unborn)
    return unborn


def _remove(teachers: Path, devices: Path, name: str) -> None:
    sides = [side for side in (teachers, devices) if os.path.lexists(side / name)]
    if not sides:
        known = ", ".join(pairing_names(teachers)) or "nothing"
        raise CredentialsError("there is no such pairing", where=teachers / name, do=f"paired is: {known}")
    for side in sides:
        # Renamed in one step, so that a crash while deleting leaves no half pairing.
        revoked = side / f"{_REVOKED}{name}"
        (side / name).rename(revoked)
        fsync_folder(side)
        shutil.rmtree(revoked)


def _fit(teacher: Path, device: Path) -> bool:
    """Return whether two folders are the sides of one pairing."""
    try:
        settings, other_settings = _read(teacher / SETTINGS), _read(device / SETTINGS)
        return (
            _read(teacher / SECRET) == _read(device / SECRET)
            and settings["sender-id_hex"] == other_settings["recipient-id_hex"]
            and settings["recipient-id_hex"] == other_settings["sender-id_hex"]
            and read_device(device).name == teacher.name
        )
    except (OSError, ValueError, KeyError, CredentialsError):
        return False


def _ids_taken(teachers: Path) -> set[str]:
    taken: set[str] = set()
    for name in pairing_names(teachers):
        try:
            settings = _read(teachers / name / SETTINGS)
        except (OSError, ValueError):
            continue  # opening it reports the damage; it takes no id
        taken.update(settings[key] for key in ("sender-id_hex", "recipient-id_hex") if key in settings)
    return taken


def _new_id(taken: set[str]) -> str:
    while (drawn := secrets.token_hex(_ID_BYTES)) in taken:
        pass
    return drawn


def _read(path: Path) -> dict[str, Any]:
    read = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(read, dict):
        raise ValueError(f"{path.name} holds no map")  # noqa: TRY004 - damaged like what is no JSON
    return read


def _changed_at(path: Path) -> datetime | None:
    try:
        return datetime.fromtimestamp(path.stat().st_mtime, UTC)
    except FileNotFoundError:
        return None
