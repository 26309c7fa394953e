"""No collection within, all as before after it."""

import gc
import weakref
from collections.abc import Iterator

import pytest

from kurt2rt.platform.gc_control import gc_frozen


class Loop:
    """Holds itself, so that only the collector can free it."""

    def __init__(self) -> None:
        self.itself = self


@pytest.fixture(autouse=True)
def collector_as_it_was() -> Iterator[None]:
    enabled = gc.isenabled()
    yield
    if enabled:
        gc.enable()
    else:
        gc.disable()


@pytest.fixture
def nothing_set_aside() -> Iterator[None]:
    """Unfreeze the suite's own objects (tests/conftest.py) during the test; every collection then walks them."""
    gc.unfreeze()
    yield
    gc.freeze()


@pytest.mark.usefixtures("nothing_set_aside")
def test_gc_frozen_collects_only_before_and_after_outermost() -> None:
    gone = weakref.ref(Loop())
    gc.enable()
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
