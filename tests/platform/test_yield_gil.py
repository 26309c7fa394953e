import threading
import time
from collections.abc import Callable

import pytest

from kurt2rt.platform.yield_gil import PAUSE_S, SLICE_S, yield_gil


@pytest.fixture
def slept(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Record the sleeps; each reading of the clock finds a time slice over."""
    slept: list[float] = []
    looks = iter(range(1_000_000))
    monkeypatch.setattr(time, "sleep", slept.append)
    monkeypatch.setattr(time, "perf_counter", lambda: next(looks) * SLICE_S)
    return slept


def in_a_thread(work: Callable[[], object]) -> None:
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()


def test_yield_gil_sleeps_in_other_threads_only(slept: list[float]) -> None:
    list(yield_gil(range(10)))
    assert slept == []
    in_a_thread(lambda: list(yield_gil(range(10))))
    assert len(slept) > 5
    assert set(slept) == {PAUSE_S}
