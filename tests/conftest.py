"""What all tests share: property tests that draw the same examples every time, on any machine."""

import gc
from collections.abc import Generator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.examples import register_profiles
from tests.forked_program import nursery

register_profiles()

_WAIT = {"page", "cli", "service", "channel", "teaching", "commission", "crash"}
"""Folders whose stories wait most: browsers, programs, real time."""


def pytest_configure(config: pytest.Config) -> None:
    """One nursery for all workers of a session; on the kernel's own CAN programs start as they start on a robot."""
    if not hasattr(config, "workerinput") and not config.option.markexpr.startswith(("hil", "boots")):
        around = ExitStack()
        around.enter_context(nursery())
        config.add_cleanup(around.close)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Nearly all of what is made meanwhile stays: to look for garbage among it takes a sixth of the time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What waits comes first, and not at the end, where no other test would be left to use the time."""
    here = Path(__file__).parent
    items.sort(key=lambda item: item.path.relative_to(here).parts[0] not in _WAIT)


def pytest_collection_finish() -> None:
    """What was collected stays to the end: nobody need look for garbage among it again and again."""
    gc.collect()
    gc.freeze()
