"""What all tests share: property tests that draw the same examples every time, on any machine."""

import gc
import os
import tempfile
from collections.abc import Generator
from contextlib import ExitStack
from pathlib import Path

import pytest
from xdist.remote import Producer
from xdist.scheduler.loadfile import LoadFileScheduling

from tests.examples import register_profiles
from tests.forked_program import nursery

register_profiles()

_MEMORY = Path("/dev/shm")
_BROWSERS = "page"
_WAIT = {"cli", "service", "channel", "teaching", "commission", "crash"}
"""Folders whose stories wait much: programs, real time."""
_WAITS_END_AT = 0.85


def pytest_configure(config: pytest.Config) -> None:
    """One nursery for all workers of a session, and files in memory where there is one, which syncs at once.

    On the kernel's own CAN programs start as they start on a robot, and write to a disk.
    """
    if not hasattr(config, "workerinput") and not config.option.markexpr.startswith(("hil", "boots")):
        if _MEMORY.is_dir():
            os.environ.setdefault("TMPDIR", str(_MEMORY))
            tempfile.tempdir = None  # it looks again
        around = ExitStack()
        around.enter_context(nursery())
        config.add_cleanup(around.close)


class OneBrowser(LoadFileScheduling):  # type: ignore[misc]
    """Whole files to a worker, and to one of them all files of the page: so only one starts a browser, and once."""

    def _split_scope(self, nodeid: str) -> str:
        file = str(super()._split_scope(nodeid))
        folder = Path(file).parent
        return str(folder) if folder.name == _BROWSERS else file


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> OneBrowser | None:
    """Where whole files are dealt out; else as xdist does it."""
    return OneBrowser(config, log) if config.getoption("dist") == "loadfile" else None


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Nearly all of what is made meanwhile stays: to look for garbage among it takes a sixth of the time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Browsers first; then files whose stories wait stand between those that compute, and use the time together.

    What waits is over a little sooner, for at the end no other test would be left to use the time.
    """
    here = Path(__file__).parent
    files: dict[Path, str] = {item.path: item.path.relative_to(here).parts[0] for item in items}
    waiting = [path for path, folder in files.items() if folder in _WAIT]
    computing = [path for path, folder in files.items() if folder not in _WAIT | {_BROWSERS}]
    place = {path: _WAITS_END_AT * number / len(waiting) for number, path in enumerate(waiting)}
    place |= {path: number / len(computing) for number, path in enumerate(computing)}
    items.sort(key=lambda item: place.get(item.path, -1.0))


def pytest_collection_finish() -> None:
    """What was collected stays to the end: nobody need look for garbage among it again and again.

    What little of it is garbage stays, too: to find it takes each worker half a second, for some 10 MB.
    """
    gc.freeze()
