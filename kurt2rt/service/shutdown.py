"""Shutdown of the robot program on a signal: the wheels first, over within a second."""

import math
import os
import select
import signal
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from types import FrameType, TracebackType
from typing import Self

from config.errors import ExitCode
from kurt2rt.platform.signal_handlers import SignalHandlers
from kurt2rt.service.systemd.notifier import Notifier

SHUTDOWN_SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, signal.SIGTSTP)
"""Ctrl-\\ and Ctrl-Z, too: a program that is stopped or killed on the spot does not brake."""

LONGEST_S = 1.0
"""Longest time from the signal to the end of the process, in s that the process is not kept from a processor."""
_GIVES_UP_S = 0.9
_LOOK_EVERY_S = 0.1
_KEPT_BACK_S = 0.2
"""Reserve for the stages after a wait, in s."""
_LAST_WORD_S = 0.05
_STDERR = 2

Callback = Callable[[], object]


_MOST = 20.0
"""Greatest slowness that is believed: delays of several threads at once are counted together."""

_TRUSTED_AFTER_S = 0.1
"""Time after which the slowness since `start` counts as much as that before."""


_THREADS = Path("/proc/self/task")
_NANOSECONDS = 1e9


def run_delay_s() -> float:
    """Return the time in s that the present threads have waited for a processor; 0 where the kernel does not tell."""
    total_ns = 0
    with suppress(OSError):
        for thread in _THREADS.iterdir():
            with suppress(OSError):  # it has just ended
                total_ns += int((thread / "schedstat").read_text().split()[1])
    return total_ns / _NANOSECONDS


class ShutdownClock:
    """Clock of the time limit of a shutdown; it stands while this process waits for a processor."""

    def __init__(
        self,
        now_s: Callable[[], float] = time.monotonic,
        delayed_s: Callable[[], float] = run_delay_s,
        worked_s: Callable[[], float] = time.process_time,
    ) -> None:
        """Wait for `start`.

        Args:
            now_s: returns the present in s.
            delayed_s: returns how long threads have waited for a processor so far, in s.
            worked_s: returns how long they have had one, in s.
        """
        self._now_s, self._delayed_s, self._worked_s = now_s, delayed_s, worked_s
        self._began_s = math.inf
        self._delayed_before_s = 0.0
        self._slowness_before = 1.0

    @property
    def started(self) -> bool:
        """Return whether `start` was called."""
        return self._began_s < math.inf

    def start(self) -> None:
        """Begin to count at 0; time in which threads wait for a processor does not count."""
        self._delayed_before_s = self._delayed_s()
        self._slowness_before = min(1.0 + self._delayed_before_s / max(self._worked_s(), 1e-3), _MOST)
        self._began_s = self._now_s()

    def left_s(self, until_s: float, most_s: float = math.inf) -> float:
        """Return the real time in s until this clock shows `until_s`, if the machine stays as busy as it was so far.

        `most_s`: longest time in s of this clock. The result is 0 or more, and `most_s` before `start`.
        """
        if not self.started:
            return most_s
        real_s = self._now_s() - self._began_s
        delayed_s = max(self._delayed_s() - self._delayed_before_s, 0.0)  # a thread that ended took its delay along
        own_s = max(real_s - delayed_s, real_s / _MOST)
        slowness = (real_s + _TRUSTED_AFTER_S * self._slowness_before) / (own_s + _TRUSTED_AFTER_S)
        return max(0.0, min(until_s - own_s, most_s)) * slowness


class ShutdownStage(StrEnum):
    """Part of the program that its end is waiting for, in the words of the last line if that takes too long."""

    START = "its start"
    RUNTIME = "its runtime"
    LOOP = "its loop"
    CHANNEL = "the teachers' channel"
    LESSONS = "the newest lessons"
    RECORDING = "the end of the recording"
    BUS_AND_LOGS = "the robot's bus and its logs"
    DISK = "a thread that waits for the disk"


class ShutdownHandler:
    """Thread that receives the signals, also while the loop or a disk hangs; a context manager of the main thread.

    At the first signal that ends the program it runs the callbacks of `on_shutdown`. The rest then has 0.9 s, and more
    on a machine too busy to give it a processor.
    """

    def __init__(
        self,
        *,
        on_timeout: Callable[[ShutdownStage], None] | None = None,
    ) -> None:
        """Install no handler yet.

        Args:
            on_timeout: ends the process; gets the stage that did not end in time. None: the end may last.
        """
        self._on_timeout = on_timeout
        self._callbacks: list[Callback] = []
        self._failures: list[Exception] = []
        self._clock = ShutdownClock()
        self._lock = threading.Lock()
        self._handlers = SignalHandlers(dict.fromkeys(SHUTDOWN_SIGNALS, _ignore))
        self._wakeup_before = -1
        self._wakeup_send, self._wakeup_recv = socket.socketpair()
        self._wakeup_send.setblocking(False)
        self._thread = threading.Thread(target=self._listen, name="ending", daemon=True)
        self.stage = ShutdownStage.START
        """Stage of the program, for the last line if the end takes too long."""

    @property
    def thread(self) -> threading.Thread:
        """Thread that receives the signals, to be given real-time priority."""
        return self._thread

    @property
    def requested(self) -> bool:
        """Return whether a signal has asked the program to end."""
        return self._clock.started

    def remaining_s(self, wanted_s: float) -> float:
        """Return the seconds that a wait of `wanted_s` may last: less after a signal has asked the program to end."""
        return self._clock.left_s(_GIVES_UP_S - _KEPT_BACK_S, wanted_s)

    @contextmanager
    def on_shutdown(self, *callbacks: Callback) -> Iterator[None]:
        """Run the callbacks in this order as soon as a signal asks the program to end during the block; none may wait.

        The signal thread runs them, or this thread if the signal came before.
        """
        with self._lock:
            self._callbacks += callbacks
            late = self.requested
        if late:
            self._run_callbacks(callbacks)
        try:
            yield
        finally:
            with self._lock:
                self._callbacks = [each for each in self._callbacks if each not in callbacks]

    def __enter__(self) -> Self:
        self._wakeup_before = signal.set_wakeup_fd(self._wakeup_send.fileno(), warn_on_full_buffer=False)
        self._thread.start()
        self._handlers.install()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.requested and self._on_timeout is not None:
            return  # the interpreter's own end may hang, too
        self._handlers.restore()
        signal.set_wakeup_fd(self._wakeup_before)
        self._wakeup_send.close()
        self._thread.join()
        self._wakeup_recv.close()
        if error is None and self._failures:
            raise self._failures[0]

    def _listen(self) -> None:
        while True:
            if self.requested and self._on_timeout is not None:
                left_s = self._clock.left_s(_GIVES_UP_S)
                if left_s == 0:
                    self._on_timeout(self.stage)
                    return
                # The kernel's own deadline, if the interpreter hangs as a whole.
                signal.setitimer(signal.ITIMER_REAL, self._clock.left_s(LONGEST_S))
                self._wakeup_recv.settimeout(min(left_s, _LOOK_EVERY_S))
            try:
                numbers = self._wakeup_recv.recv(64)
            except TimeoutError:
                continue
            if not numbers:
                return
            for number in numbers:
                self._on_signal(number)

    def _on_signal(self, number: int) -> None:
        if number in SHUTDOWN_SIGNALS and not self.requested:
            with self._lock:
                self._clock.start()
                callbacks = tuple(self._callbacks)
            if self._on_timeout is not None:
                signal.setitimer(signal.ITIMER_REAL, LONGEST_S)
            self._run_callbacks(callbacks)

    def _run_callbacks(self, callbacks: tuple[Callback, ...]) -> None:
        for callback in callbacks:
            try:
                callback()
            except Exception as error:  # noqa: BLE001  # the other callbacks run all the same; raised at the end
                self._failures.append(error)


def timeout_message(stage: ShutdownStage) -> str:
    """Return the last line of a program whose end took too long."""
    return f"kurt2rt: ended without {stage}, which did not end in time; look at disk and network"


def force_exit(stage: ShutdownStage) -> None:
    """End this process at once with a last line and exit code 2; acknowledged lessons are on the disk.

    A program that had not yet begun leaves nothing undone, and its exit code is 0.
    """
    # A terminal may hang, too; one that is writable takes a short line.
    if select.select([], [_STDERR], [], _LAST_WORD_S)[1]:
        os.write(_STDERR, f"{timeout_message(stage)}\n".encode())
    os._exit(ExitCode.DONE if stage is ShutdownStage.START else ExitCode.REFUSED)


def _ignore(_number: int, _frame: FrameType | None) -> None:
    """Do nothing: Python needs a handler, and the number reached the thread before this call."""


@dataclass(frozen=True, slots=True)
class ProcessContext:
    """Parts of the process that a service shares with the program: signals, service manager, log."""

    shutdown: ShutdownHandler
    notifier: Notifier
    liveness: Mapping[str, Callable[[], bool]] = field(default_factory=dict)
    """Checks of what must be alive for the heartbeat, without the loop, by name."""
    log: Callable[[str], None] = lambda _: None
    """Gets a line for the log. The loop calls it: it may not wait."""
