"""Temporary signal handlers: the earlier ones are restored."""

import signal
import threading
from types import FrameType

from kurt2rt.platform.signal_handlers import SignalHandlers, heeded_signals


class Ear:
    def __init__(self) -> None:
        self.heard: list[int] = []

    def hear(self, number: int, _frame: FrameType | None) -> None:
        self.heard.append(number)


def test_signal_handlers_restore_the_previous_ones() -> None:
    first, second = Ear(), Ear()
    with SignalHandlers({signal.SIGUSR1: first.hear}):
        with SignalHandlers({signal.SIGUSR1: second.hear, signal.SIGUSR2: second.hear}):
            signal.raise_signal(signal.SIGUSR1)
            signal.raise_signal(signal.SIGUSR2)
        signal.raise_signal(signal.SIGUSR1)
    assert second.heard == [signal.SIGUSR1, signal.SIGUSR2]
    assert first.heard == [signal.SIGUSR1]
    assert signal.getsignal(signal.SIGUSR1) is signal.getsignal(signal.SIGUSR2) is signal.SIG_DFL


def test_signal_ignored_at_the_start_stays_ignored() -> None:
    ear, ending = Ear(), {signal.SIGUSR1: None, signal.SIGUSR2: None}
    before = signal.signal(signal.SIGUSR1, signal.SIG_IGN)  # as nohup and shells start a program
    try:
        assert heeded_signals(*ending) == (signal.SIGUSR2,)
        with SignalHandlers(dict.fromkeys(ending, ear.hear)):
            for number in ending:
                signal.raise_signal(number)
        assert signal.getsignal(signal.SIGUSR1) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert ear.heard == [signal.SIGUSR2]


def test_other_threads_hear_no_signals() -> None:
    problems: list[ValueError] = []

    def try_to() -> None:
        try:
            SignalHandlers({signal.SIGUSR1: signal.SIG_IGN}).install()
        except ValueError as error:
            problems.append(error)

    thread = threading.Thread(target=try_to)
    thread.start()
    thread.join()
    assert len(problems) == 1
    assert signal.getsignal(signal.SIGUSR1) is signal.SIG_DFL
