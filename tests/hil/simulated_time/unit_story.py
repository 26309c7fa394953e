"""The unit as `kurt2rt service install` makes it, under a systemd that starts, watches and ends it.

`test_unit` runs this in a machine whose first process is systemd, in simulated time: no program is late there.
"""

import errno
import json
import os
import shutil
import subprocess
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

import anyio.to_thread
import pytest
import yaml

from config import CONFIG_DIR
from kurt2rt.core.decision.standing import STARTED, stop_text
from kurt2rt.core.teaching.commands import Resume, Take
from kurt2rt.platform.realtime_priority import UNIT_PRIORITY
from kurt2rt.teacher import TeacherClient
from tests.cli.helpers import Running, running
from tests.cli.test_run_as_service import priorities_of
from tests.cli.three_programs import brakes, is_control, onlooker, stands, turns, until_it_drives
from tests.hil.link import NAME as BUS
from tests.hil.link import Link
from tests.hil.simulated_time.installation import install_for_everybody
from tests.hil.simulated_time.unit import NAME, STATE, Unit
from tests.teacher.states_of import state_where

PORT = 5683
SYS_NICE = 1 << 23
LISTENS = f"teachers are listened to on UDP port {PORT}"
START_LIMIT = 5
"""Number of failures within 10 s after which systemd gives an ordinary unit up."""


@pytest.fixture(scope="module")
def kurt2rt() -> Path:
    return install_for_everybody()


@pytest.fixture(scope="module")
def settings() -> Path:
    """Write the shipped settings where the service may read them; return the path."""
    path = Path("/etc/kurt2rt/runtime.yaml")
    path.parent.mkdir()
    write_settings(path)
    return path


def write_settings(path: Path, **changes: object) -> None:
    shipped = yaml.safe_load((CONFIG_DIR / "runtime" / "default.yaml").read_text(encoding="utf-8"))
    path.write_text(yaml.safe_dump({**shipped, **changes}), encoding="utf-8")


@pytest.fixture
def unit(kurt2rt: Path, settings: Path, vcan0: str) -> Iterator[Unit]:
    """Installed, and neither started nor taught yet."""
    subprocess.run([kurt2rt, "service", "install", "--bus", vcan0, "--settings", settings], check=True)
    yield Unit()
    subprocess.run([kurt2rt, "service", "uninstall"], check=True)
    shutil.rmtree(STATE, ignore_errors=True)  # it is not there where the unit never started


@contextmanager
def robot(folder: Path) -> Iterator[Running]:
    with running("sim", "--bus", BUS, "--start", "1", folder=folder) as sim:
        sim.wait_for(f"is on bus {BUS}")
        yield sim


@asynccontextmanager
async def teacher() -> AsyncIterator[TeacherClient]:
    """Connect a teacher with the key of this machine's own programs, which root may read."""
    async with TeacherClient(STATE / "var/devices/local", port=PORT) as we:
        assert (await we.send(Take)).accepted
        yield we


async def until_up(unit: Unit) -> int:
    return await anyio.to_thread.run_sync(unit.wait_until_said, LISTENS)


async def stands_until_go(we: TeacherClient) -> None:
    stopped = await state_where(we, lambda state: state.stopped is not None)
    assert (stopped.stopped, stopped.left_m_s, stopped.right_m_s) == (STARTED, 0.0, 0.0)
    assert (await we.send(Resume)).accepted
    await state_where(we, lambda state: state.stopped is None)


async def stands_and_asks_after_go(we: TeacherClient) -> None:
    """Which it does as long as it knows nothing."""
    await stands_until_go(we)
    await state_where(we, lambda state: state.cause == "unknown")


async def test_it_starts_may_do_little_and_the_robot_stands_and_asks(unit: Unit, kurt2rt: Path, tmp_path: Path) -> None:
    with robot(tmp_path):
        unit.start()
        assert (unit.shows("Type"), unit.shows("ActiveState"), unit.shows("SubState")) == (
            "notify",
            "active",
            "running",
        )
        pid = await until_up(unit)
        may_do_little(pid)
        unit.wait_for_status(f"stands until Go: {stop_text(STARTED)}")
        async with teacher() as we:
            await stands_and_asks_after_go(we)
            told = status_of(kurt2rt)
        assert told["machine"]["available_bytes"] > 0


def may_do_little(pid: int) -> None:
    of_process = dict(
        line.split(":\t", 1) for line in Path(f"/proc/{pid}/status").read_text(encoding="ascii").splitlines()
    )
    user = subprocess.run(["id", "-u", NAME], capture_output=True, text=True, check=True).stdout.strip()
    assert user != "0"
    assert set(of_process["Uid"].split()) == {user}
    assert {int(of_process[f"Cap{which}"], 16) for which in ("Inh", "Prm", "Eff", "Bnd", "Amb")} == {SYS_NICE}
    assert (of_process["NoNewPrivs"], of_process["Seccomp"]) == ("1", "2")
    # The second guard, the one that hears signals, the loop.
    assert priorities_of(pid) == [UNIT_PRIORITY + 1, UNIT_PRIORITY + 1, UNIT_PRIORITY]
    assert int(Path(f"/proc/{pid}/oom_score_adj").read_text(encoding="ascii")) == -500
    folder = STATE.stat()
    assert (folder.st_uid, folder.st_mode & 0o777) == (int(user), 0o700)
    for path in ("/etc/made", "/usr/made", "/opt/made", "/var/made", "/var/lib/made", "/run/made", "/home/made"):
        assert os.strerror(errno.EROFS) in seen_from(pid, "touch", path)
    assert seen_from(pid, "touch", f"{STATE}/made") == ""
    assert seen_from(pid, "ls", "-A", "/home", "/root", "/tmp").split() == ["/home:", "/root:", "/tmp:"]
    assert not set(seen_from(pid, "ls", "/dev").split()) & {"mem", "kmsg", "console"}


def seen_from(pid: int, *words: str) -> str:
    """Return the output of a command of root in the service's view of the files."""
    done = subprocess.run(
        ["nsenter", "--target", str(pid), "--mount", *words], capture_output=True, text=True, check=False
    )
    return done.stdout + done.stderr


def status_of(kurt2rt: Path) -> dict[str, dict[str, float]]:
    """Return the status by the command of docs/run-as-a-service.md."""
    done = subprocess.run(
        ["setpriv", f"--reuid={NAME}", f"--regid={NAME}", "--clear-groups", kurt2rt, "status", "--json"],
        cwd=STATE,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode in (0, 1), done.stderr
    told: dict[str, dict[str, float]] = json.loads(done.stdout)
    return told


async def test_unit_killed_repeatedly_restarts_and_the_robot_stands(unit: Unit, tmp_path: Path) -> None:
    with robot(tmp_path):
        unit.start()
        await until_up(unit)
        async with teacher() as we:
            await until_it_drives(we)
        for _ in range(START_LIMIT + 1):
            fallen = unit.pid
            unit.kill("KILL")
            await anyio.to_thread.run_sync(unit.wait_for_another, fallen)
        await until_up(unit)
        assert unit.shows("NRestarts") == str(START_LIMIT + 1)
        async with teacher() as we:
            await stands_until_go(we)


async def test_unit_hanging_while_driving_is_restarted(unit: Unit, tmp_path: Path) -> None:
    with robot(tmp_path) as sim:
        unit.start()
        hung = await until_up(unit)
        async with teacher() as we:
            await until_it_drives(we)
            unit.kill("STOP")
            await anyio.to_thread.run_sync(sim.wait_for, "CONTROL has ceased: the watchdog brakes")
        await anyio.to_thread.run_sync(unit.wait_for_another, hung)
        assert "Watchdog timeout (limit 5s)" in unit.journal()
        await until_up(unit)
        async with teacher() as we:
            await stands_until_go(we)


async def test_unit_stop_brakes_first_and_ends_within_a_second(unit: Unit, tmp_path: Path) -> None:
    with robot(tmp_path), onlooker(BUS) as seen:
        unit.start()
        await until_up(unit)
        async with teacher() as we:
            await until_it_drives(we)
            await seen.until(turns)
            unit.stop()
        seen.look()
        told = [frame for frame in seen.frames if is_control(frame)]
        assert brakes(told[-1])
        last_drive = max(index for index, frame in enumerate(told) if not brakes(frame))
        assert all(brakes(frame) for frame in told[last_drive + 1 :])
        await seen.until(stands)
    assert "Deactivated successfully." in unit.journal()
    # systemd kills what has not ended after TimeoutStopSec.
    assert "timed out" not in unit.journal()
    assert unit.said_at_s("Stopped ") - unit.said_at_s("Stopping ") < 1.0


async def test_unit_without_bus_and_robot_waits_for_them(unit: Unit, link: Link, tmp_path: Path) -> None:
    link.delete()
    unit.start()
    pid = unit.wait_until_said("waits for")
    unit.wait_for_status("bus")
    link.make()
    assert await until_up(unit) == pid
    with robot(tmp_path):
        async with teacher() as we:
            await stands_and_asks_after_go(we)
    assert unit.shows("NRestarts") == "0"
