"""The queue of a writer thread is bounded and counts its losses; a hanging writer delays no caller."""

import threading

from kurt2rt.runs.recording.writer_thread import WriterThread


def test_at_the_end_the_writer_looks_once_more() -> None:
    written = list[int]()

    def write() -> None:
        ended = False
        while not ended:
            ended = thread.wait_period()
            written.extend(thread.pop_all())

    thread = WriterThread[int]("writer", 10, write)
    assert not thread.started
    thread.start()
    assert thread.started
    thread.submit(1)
    assert thread.stop(60.0)
    assert written == [1]


def test_a_writer_that_hangs_is_left_behind() -> None:
    disk_answers = threading.Event()
    thread = WriterThread[int]("writer", 10, lambda: hang(disk_answers))
    thread.start()
    assert not thread.stop(0.0)
    disk_answers.set()
    assert thread.stop(60.0)


def hang(until: threading.Event) -> None:
    until.wait()
