"""Simulated robot in real time: in a thread, and as hardware for a runtime in another process."""

import random
import threading
import time
from collections import deque
from collections.abc import Callable
from types import TracebackType
from typing import Self

from simbridge.robot_end import RobotEnd
from simbridge.simulated_robot import SimulatedRobot
from simbridge.worlds.world_settings import WorldSettings


class RealtimeSimulation:
    """Thread that steps a robot on absolute monotonic deadlines; missed cycles are skipped and counted.

    An error ends the thread, shows in `error`, and is raised by `stop` and by leaving the with block.
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
        """Error that ended the thread, if any."""

    def start(self) -> None:
        """Start the thread; call this once."""
        self._thread.start()

    def stop(self) -> None:
        """Stop and join the thread, and raise the error that ended it before, if any."""
        self._end()
        if self.error is not None:
            raise self.error

    def submit(self, job: Callable[[], object]) -> None:
        """Run a job in the stepping thread before its next step; callable from any thread. An error ends the thread."""
        self._jobs.append(job)

    def hold(self) -> None:
        """Suspend the thread; the caller steps the simulation until `go_on`."""
        with self._stepping:
            self._held = True

    def step(self) -> None:
        """Step once in the caller's thread; call it only between `hold` and `go_on`."""
        while self._jobs:
            self._jobs.popleft()()
        self._robot.step()

    def go_on(self) -> None:
        """Resume the thread after `hold`."""
        with self._stepping:
            self._held = False

    def wait(self, timeout_s: float) -> bool:
        """Wait up to `timeout_s` for the thread's end; return whether it has ended."""
        self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()
        # The body's own error came first, so it wins.
        if error is None and self.error is not None:
            raise self.error

    def _end(self) -> None:
        self._stopping.set()
        if self._thread.ident is not None:
            self._thread.join()

    def _run(self) -> None:
        try:
            self._pace()
        except Exception as error:  # noqa: BLE001  # raised again by stop, in the caller's thread
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


class StandaloneRobot:
    """Simulated robot of `kurt2rt sim`, in real time at its own end of a link, whose loss it survives."""

    def __init__(
        self, world: WorldSettings, end: RobotEnd, seed: int, *, start: int | None = None, cycle_s: float = 0.01
    ) -> None:
        """Place a robot in a world, at its end of a link.

        Args: `seed` selects sensors, noise and, if `start` is None, the start pose; `start` counts from 1. `cycle_s`:
        duration of a cycle in s.
        """
        self.end = end
        chance = random.Random(f"on a bus in world {world.name}, seed {seed}")
        self.robot = end.simulate(world, chance.getrandbits(32), seed)
        starts = [each.pose for each in world.start_poses]
        self.robot.place(chance.choice(starts) if start is None else starts[start - 1])
        self.simulation = RealtimeSimulation(self.robot, cycle_s)

    def __enter__(self) -> Self:
        self.simulation.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.simulation.__exit__(kind, error, trace)
        finally:
            self.end.close()
