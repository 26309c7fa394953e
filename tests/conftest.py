"""Setup of all tests: the same drawn examples on any machine, one browser, an order that uses all processors."""

import gc
import os
import signal
import sys
import tempfile
from collections.abc import Generator
from contextlib import ExitStack
from pathlib import Path

import pytest
from xdist.remote import Producer
from xdist.scheduler.loadfile import LoadFileScheduling

from config import plugins
from kurt2rt.channel.security.pairing import Pairing, pair
from tests.examples import register_profiles
from tests.forked_program import fork_server

register_profiles()

_HERE = Path(__file__).parent
_MEMORY = Path("/dev/shm")
_BROWSERS = "teacher/page"
_WAIT = ("cli", "service", "channel", "teacher", "checks/commission", "crash")
"""Folders whose stories wait much: programs, real time."""
_WAITS_END_AT = 0.85


def pytest_configure(config: pytest.Config) -> None:
    """Start one fork server for all workers of a session, and put temporary files into memory, which syncs at once.

    Tests on the kernel's own CAN start programs as a robot does, and write to a disk.
    """
    # A runner in the background, or under nohup, ignores signals that programs of tests have to heed.
    for number in (signal.SIGINT, signal.SIGHUP, signal.SIGQUIT):
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
    if not hasattr(config, "workerinput") and not config.option.markexpr.startswith(("hil", "boots")):
        if _MEMORY.is_dir():
            os.environ.setdefault("TMPDIR", str(_MEMORY))
            tempfile.tempdir = None  # read from TMPDIR again
        around = ExitStack()
        around.enter_context(fork_server())
        config.add_cleanup(around.close)


class OneBrowser(LoadFileScheduling):  # type: ignore[misc]
    """Scheduler of whole files; one worker gets all files of the page, so a single browser is started."""

    def _split_scope(self, nodeid: str) -> str:
        file = str(super()._split_scope(nodeid))
        folder = Path(file).parent
        return str(folder) if folder.as_posix().endswith(_BROWSERS) else file


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> OneBrowser | None:
    """Return the scheduler for --dist loadfile; None leaves the others to xdist."""
    return OneBrowser(config, log) if config.getoption("dist") == "loadfile" else None


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect tests without garbage collection: nearly all objects stay, and the search takes a sixth of the time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort browser tests first, then files that wait for programs between files that compute.

    Waiting files end a little earlier: at the end no other test is left to use the processor meanwhile.
    """
    files = {item.path: None for item in items if not _is_in(item.path, (_BROWSERS,))}
    waiting = [path for path in files if _is_in(path, _WAIT)]
    computing = [path for path in files if not _is_in(path, _WAIT)]
    place = {path: _WAITS_END_AT * number / len(waiting) for number, path in enumerate(waiting)}
    place |= {path: number / len(computing) for number, path in enumerate(computing)}
    items.sort(key=lambda item: place.get(item.path, -1.0))


def _is_in(path: Path, folders: tuple[str, ...]) -> bool:
    return path.is_relative_to(_HERE) and path.relative_to(_HERE).as_posix().startswith(
        tuple(f"{each}/" for each in folders)
    )


def pytest_collection_finish() -> None:
    """Exempt collected tests from garbage collection: they stay to the end.

    The 10 MB of garbage among them stay, too: finding them takes each worker half a second. The rest is collected
    after ten times as many new objects as Python's default, because tests make and drop thousands.
    """
    gc.freeze()
    gc.set_threshold(7_000)


@pytest.fixture(autouse=True)
def _forget_loaded_plugins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no test see the plug-ins that another one loaded: a unit of systemd, for one, is refused with them."""
    monkeypatch.setattr(plugins, "_LOADED", {})


@pytest.fixture
def pairing(tmp_path: Path) -> Pairing:
    """Return the pairing of a device named phone."""
    return pair(tmp_path / "teachers", tmp_path / "devices", "phone")


@pytest.fixture
def plugin_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Generator[Path, None, None]:
    """Return the current folder, empty; modules, plug-ins and entries of Python's path are forgotten afterwards."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    known = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - known:
        if str(getattr(sys.modules[name], "__file__", None)).startswith(str(tmp_path)):
            del sys.modules[name]
