"""The loop overtakes all but its guards, and they overtake it; nothing else is in a hurry."""

import os
import subprocess
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from kurt2rt.platform.realtime_priority import set_sched_fifo


def _is_permitted() -> bool:
    def take() -> None:
        said.append(set_sched_fifo(1))

    said: list[str] = []
    trying = threading.Thread(target=take)
    trying.start()
    trying.join()
    return "not permitted" not in said[0]


needs_permission = pytest.mark.skipif(not _is_permitted(), reason="SCHED_FIFO is not permitted here: no CAP_SYS_NICE")


def in_a_thread(story: Callable[[], None]) -> None:
    """Play it where it leaves no priority behind."""
    failures: list[BaseException] = []

    def play() -> None:
        try:
            story()
        except BaseException as error:  # noqa: BLE001  # raised where the test sees it
            failures.append(error)

    loop = threading.Thread(target=play)
    loop.start()
    loop.join()
    if failures:
        raise failures[0]


@contextmanager
def waiting() -> Iterator[threading.Thread]:
    """Start a thread that waits."""
    over = threading.Event()
    thread = threading.Thread(target=over.wait)
    thread.start()
    try:
        yield thread
    finally:
        over.set()
        thread.join()


def priority_of(thread: threading.Thread) -> int:
    """0: as any other."""
    assert thread.native_id is not None
    is_real_time = os.sched_getscheduler(thread.native_id) & ~os.SCHED_RESET_ON_FORK == os.SCHED_FIFO
    return os.sched_getparam(thread.native_id).sched_priority if is_real_time else 0


@needs_permission
def test_sched_fifo_is_not_inherited() -> None:
    def story() -> None:
        assert "5 (SCHED_FIFO)" in set_sched_fifo(5)
        assert priority_of(threading.current_thread()) == 5
        with waiting() as later:
            assert priority_of(later) == 0
        told = subprocess.run(["chrt", "-p", "0"], capture_output=True, text=True, check=True)
        assert "SCHED_OTHER" in told.stdout

    in_a_thread(story)


@needs_permission
def test_sched_fifo_guards_stay_above_the_loop() -> None:
    def story() -> None:
        with waiting() as guard, waiting() as other:
            for priority in (5, 20, 3):
                set_sched_fifo(priority, [guard])
                assert priority_of(threading.current_thread()) == priority
                assert priority_of(guard) == priority + 1
                assert priority_of(other) == 0
            assert "SCHED_FIFO" not in set_sched_fifo(0, [guard])
            assert priority_of(threading.current_thread()) == priority_of(guard) == priority_of(other) == 0

    in_a_thread(story)


@needs_permission
def test_a_guard_that_has_ended_is_passed_over() -> None:
    def story() -> None:
        with waiting() as guard:
            pass
        assert "5 (SCHED_FIFO)" in set_sched_fifo(5, [guard, threading.Thread()])

    in_a_thread(story)
