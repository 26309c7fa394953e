"""The end of a program that drives a robot: the signals that ask for it, the wheels first, over within a second."""

import math
import os
import select
import signal
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from enum import StrEnum
from types import FrameType, TracebackType
from typing import Final, Self

from kurt2rt.platform.signal_handlers import SignalHandlers

SHUTDOWN_SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, signal.SIGTSTP)
"""Ctrl-\\ and Ctrl-Z among them: a program that is stopped or dies on the spot does not brake."""

LONGEST_S = 1.0
"""From the signal to the end of the process, whatever hangs."""
_GIVES_UP_S = 0.9
_KEPT_BACK_S = 0.2
"""Of that for what comes after the one who is patient."""
_LAST_WORD_S = 0.05
_STDERR = 2

Callback = Callable[[], object]


class ShutdownStage(StrEnum):
    """Part of the program that its end waits for."""

    START = "start"
    RUNTIME = "runtime"
    LOOP = "loop"
    CHANNEL = "channel"
    LESSONS = "lessons"
    RECORDING = "recording"
    BUS_AND_LOGS = "bus and logs"
    DISK = "disk"


_STAGES: Final = {
    ShutdownStage.START: "its start",
    ShutdownStage.RUNTIME: "its runtime",
    ShutdownStage.LOOP: "its loop",
    ShutdownStage.CHANNEL: "the teachers' channel",
    ShutdownStage.LESSONS: "the newest lessons",
    ShutdownStage.RECORDING: "the end of the recording",
    ShutdownStage.BUS_AND_LOGS: "the robot's bus and its logs",
    ShutdownStage.DISK: "a thread that waits for the disk",
}


class ShutdownHandler:
    """Hears signals in a thread of its own: also while the loop, or whatever it waits for, hangs.

    At the first signal that ends the program it does what `first` was given, then gives the rest its time. Use it in
    the main thread, as a context manager.
    """

    def __init__(
        self,
        *,
        others: Mapping[signal.Signals, Callback] | None = None,
        on_timeout: Callable[[ShutdownStage], None] | None = None,
    ) -> None:
        """`others`: what other signals ask for, done in this thread, too; they end nothing.

        `on_timeout` ends the process when the time is over; it takes the stage that did not end. None: wait for ever.
        """
        self._others: dict[int, Callback] = {int(number): act for number, act in (others or {}).items()}
        self._on_timeout = on_timeout
        self._callbacks: list[Callback] = []
        self._failures: list[Exception] = []
        self._deadline_s = math.inf
        self._lock = threading.Lock()
        self._handlers = SignalHandlers(
            dict.fromkeys((*SHUTDOWN_SIGNALS, *map(signal.Signals, self._others)), _is_heard_elsewhere)
        )
        self._wakeup_before = -1
        self._wakeup_send, self._wakeup_recv = socket.socketpair()
        self._wakeup_send.setblocking(False)
        self._thread = threading.Thread(target=self._listen, name="ending", daemon=True)
        self.stage = ShutdownStage.START
        """Part of the program at work, for the last word when the time is over."""

    @property
    def thread(self) -> threading.Thread:
        """Who hears."""
        return self._thread

    @property
    def requested(self) -> bool:
        """Whether the program was told to end."""
        return self._deadline_s < math.inf

    def remaining_s(self, most_s: float) -> float:
        """How long somebody may be waited for who would like `most_s`: less when the program was told to end."""
        return max(0.0, min(most_s, self._deadline_s - _KEPT_BACK_S - time.monotonic()))

    @contextmanager
    def on_shutdown(self, *acts: Callback) -> Iterator[None]:
        """What to do at once when the program is told to end while the block runs, in this order; none may wait.

        Done by the thread that hears, or here where it was told so before.
        """
        with self._lock:
            self._callbacks += acts
            late = self.requested
        if late:
            self._run_callbacks(acts)
        try:
            yield
        finally:
            with self._lock:
                self._callbacks = [each for each in self._callbacks if each not in acts]

    def __enter__(self) -> Self:
        self._wakeup_before = signal.set_wakeup_fd(self._wakeup_send.fileno(), warn_on_full_buffer=False)
        self._thread.start()
        self._handlers.install()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.requested and self._on_timeout is not None:
            return  # the interpreter's own end may hang as well
        self._handlers.restore()
        signal.set_wakeup_fd(self._wakeup_before)
        self._wakeup_send.close()
        self._thread.join()
        self._wakeup_recv.close()
        if error is None and self._failures:
            raise self._failures[0]

    def _listen(self) -> None:
        while True:
            left_s = self._deadline_s - time.monotonic()
            if left_s <= 0 and self._on_timeout is not None:
                self._on_timeout(self.stage)
                return
            self._wakeup_recv.settimeout(left_s if 0 < left_s < math.inf else None)
            try:
                numbers = self._wakeup_recv.recv(64)
            except TimeoutError:
                continue
            if not numbers:
                return
            for number in numbers:
                self._on_signal(number)

    def _on_signal(self, number: int) -> None:
        other = self._others.get(number)
        if other is not None:
            self._run_callbacks((other,))
        elif number in SHUTDOWN_SIGNALS and not self.requested:
            with self._lock:
                self._deadline_s = time.monotonic() + _GIVES_UP_S
                acts = tuple(self._callbacks)
            if self._on_timeout is not None:
                # Of the kernel, for an interpreter that hangs as a whole.
                signal.setitimer(signal.ITIMER_REAL, LONGEST_S)
            self._run_callbacks(acts)

    def _run_callbacks(self, acts: tuple[Callback, ...]) -> None:
        for act in acts:
            try:
                act()
            except Exception as error:  # noqa: BLE001  # the next ones are done all the same; raised at the end
                self._failures.append(error)


def timeout_message(stage: ShutdownStage) -> str:
    """Return the line for the log of a program whose end took too long."""
    return f"kurt2rt: ended without {_STAGES[stage]}, which did not end in time; look at disk and network"


def force_exit(stage: ShutdownStage) -> None:
    """End this process now, whatever hangs, with a last word and exit code 2. What was acknowledged is on the disk."""
    # A terminal may hang as well; one that takes something takes a short line.
    if select.select([], [_STDERR], [], _LAST_WORD_S)[1]:
        os.write(_STDERR, f"{timeout_message(stage)}\n".encode())
    os._exit(2)


def _is_heard_elsewhere(_number: int, _frame: FrameType | None) -> None:
    """Python wants a handler; the number goes to the thread that listens before this is called."""
