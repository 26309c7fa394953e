"""The simulated robot in real time: its cycle in a thread of its own, as on the real controller."""

import threading
import time
from collections import deque
from collections.abc import Callable
from types import TracebackType
from typing import Self

from simbridge.simulated_robot import SimulatedRobot


class RealtimeSimulation:
    """Steps a robot on absolute monotonic deadlines. Cycles that were missed are skipped whole and counted.

    An error in the thread ends it, shows in `error`, and is raised by `stop` (and so by leaving the with block).
    """

    def __init__(self, robot: SimulatedRobot, cycle_s: float = 0.01) -> None:
        self._robot = robot
        self._cycle_ns = round(cycle_s * 1e9)
        self._stopping = threading.Event()
        self._jobs: deque[Callable[[], object]] = deque()
        self._stepping = threading.Lock()
        self._held = False
        self._thread = threading.Thread(target=self._run, name="simulated-robot", daemon=True)
        self.missed_cycles = 0
        self.error: Exception | None = None
        """What ended the thread, if something did."""

    def start(self) -> None:
        """Begin; once only."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread, wait for it, and raise what ended it before, if something did."""
        self._end()
        if self.error is not None:
            raise self.error

    def submit(self, job: Callable[[], object]) -> None:
        """Have something done before the next step, by the thread that steps; from any thread. An error ends it."""
        self._jobs.append(job)

    def hold(self) -> None:
        """Let the thread step no more; the holder of the simulation steps it, until `go_on`."""
        with self._stepping:
            self._held = True

    def step(self) -> None:
        """One cycle in the caller's thread, while the simulation is held."""
        while self._jobs:
            self._jobs.popleft()()
        self._robot.step()

    def go_on(self) -> None:
        """Let the thread step again."""
        with self._stepping:
            self._held = False

    def wait(self, timeout_s: float) -> bool:
        """Wait until the thread has ended, by `stop` or by an error; False when it still runs."""
        self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()
        # What went wrong first is what to mend: a body that failed is not to be hidden by what it left unread.
        if error is None and self.error is not None:
            raise self.error

    def _end(self) -> None:
        self._stopping.set()
        if self._thread.ident is not None:
            self._thread.join()

    def _run(self) -> None:
        try:
            self._pace()
        except Exception as error:  # noqa: BLE001  # kept whole and raised by stop, in the caller's thread
            self.error = error

    def _pace(self) -> None:
        deadline_ns = time.monotonic_ns()
        while True:
            deadline_ns += self._cycle_ns
            late_ns = time.monotonic_ns() - deadline_ns
            if late_ns > self._cycle_ns:
                missed = late_ns // self._cycle_ns
                self.missed_cycles += missed
                deadline_ns += missed * self._cycle_ns
            if self._stopping.wait(max(0.0, (deadline_ns - time.monotonic_ns()) / 1e9)):
                return
            with self._stepping:
                if not self._held:
                    self.step()
