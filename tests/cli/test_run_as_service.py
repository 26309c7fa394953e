"""`kurt2rt run --service` with a service manager."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from tests.cli.helpers import Running, running
from tests.service.systemd.manager import Manager
from tests.service.systemd.test_watchdog import systemd

__all__ = ["systemd"]


@pytest.fixture
def kurt2rt_process(tmp_path: Path) -> Iterator[Callable[..., Running]]:
    """Return a function that starts `kurt2rt ...` in the test's folder; kill its processes at the end."""
    with ExitStack() as around:

        def start(*words: str) -> Running:
            return around.enter_context(running(*words, folder=tmp_path))

        yield start


def settings_in(folder: Path, **changes: object) -> str:
    settings = yaml.safe_load((CONFIG_DIR / "runtime" / "default.yaml").read_text(encoding="utf-8"))
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump({**settings, "port": 0, **changes}), encoding="utf-8")
    return str(path)


def test_unit_starts_and_ends_under_a_service_manager(tmp_path: Path, systemd: Manager) -> None:
    environment = systemd.environment(0.5)
    del environment["WATCHDOG_PID"]
    words = ("run", "--service", "--bus", "sim", "--settings", settings_in(tmp_path))
    with running(*words, folder=tmp_path, environment=environment, fresh=True) as program:
        assert systemd.wait_for("READY=1")[0] == "READY=1"
        program.wait_for("teachers are listened to on UDP port")
        program.wait_for("stands until Go: the robot program was started")
        assert systemd.wait_for("until Go")[-1].startswith("STATUS=")
        systemd.wait_for("WATCHDOG=1")
        said = program.end(signal.SIGTERM)
        assert (said.exit_code, said.err) == (0, "")
        systemd.wait_for("STOPPING=1")
        assert not set(said.out) & {"\r", "\x1b", "\b"}
        assert sum("missed" in line for line in said.out.splitlines()) == 0


def test_a_page_that_died_is_told_and_comes_back(tmp_path: Path, kurt2rt_process: Callable[..., Running]) -> None:
    settings = settings_in(tmp_path, page_port=0)
    program = kurt2rt_process("run", "--service", "--bus", "sim", "--settings", settings, "--page")
    program.wait_for("/pair?token=")
    (page,) = children_of(program.process.pid)
    os.kill(page, signal.SIGKILL)
    program.wait_for("(signal 9)")
    program.wait_for("/pair?token=")
    assert children_of(program.process.pid) != [page]
    assert program.end(signal.SIGTERM).exit_code == 0


def children_of(pid: int) -> list[int]:
    """Return the ids of the living child processes of a process."""
    threads = Path(f"/proc/{pid}/task").iterdir()
    return [int(child) for each in threads for child in (each / "children").read_text(encoding="ascii").split()]


def priorities_of(pid: int) -> list[int]:
    """Return the real-time priorities of the threads of a process, the highest first."""
    threads = [int(each.name) for each in Path(f"/proc/{pid}/task").iterdir()]
    return sorted((os.sched_getparam(each).sched_priority for each in threads if _is_real_time(each)), reverse=True)


def _is_real_time(thread: int) -> bool:
    return os.sched_getscheduler(thread) & ~os.SCHED_RESET_ON_FORK == os.SCHED_FIFO


def test_guards_of_a_unit_preempt_its_loop(tmp_path: Path, kurt2rt_process: Callable[..., Running]) -> None:
    program = kurt2rt_process("run", "--service", "--bus", "sim", "--settings", settings_in(tmp_path))
    if "not permitted" in program.wait_for("real-time priority 20"):  # as delivered
        pytest.skip("SCHED_FIFO is not permitted here: no CAP_SYS_NICE")
    program.wait_for("stands until Go: the robot program was started")
    assert priorities_of(program.process.pid) == [21, 21, 20]  # the second guard, the signal thread, the loop
    assert program.end(signal.SIGTERM).exit_code == 0
