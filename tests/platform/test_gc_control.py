"""No collection within, all as before after it."""

import gc
import subprocess
import sys
from collections.abc import Iterator

import pytest

from kurt2rt.platform.gc_control import gc_frozen


@pytest.fixture(autouse=True)
def collector_as_it_was() -> Iterator[None]:
    enabled = gc.isenabled()
    yield
    if enabled:
        gc.enable()
    else:
        gc.disable()


_BLOCKS = """
import gc, weakref
from kurt2rt.platform.gc_control import gc_frozen

class Loop:
    def __init__(self):
        self.itself = self

gone = weakref.ref(Loop())
assert gone() is not None
with gc_frozen():
    assert gone() is None
    assert not gc.isenabled()
    assert gc.get_freeze_count() > 0
    with gc_frozen():
        pass
    assert not gc.isenabled()
    assert gc.get_freeze_count() > 0
assert gc.isenabled()
assert gc.get_freeze_count() == 0
"""


def test_gc_frozen_collects_only_before_and_after_outermost() -> None:
    # A process of its own, because all objects of the suite are frozen (tests/conftest.py).
    subprocess.run([sys.executable, "-c", _BLOCKS], check=True)


def test_an_error_is_an_end_too() -> None:
    gc.enable()
    with pytest.raises(KeyError), gc_frozen():
        raise KeyError
    assert gc.isenabled()


def test_manual_collection_stays_manual() -> None:
    gc.disable()
    with gc_frozen():
        pass
    assert not gc.isenabled()
