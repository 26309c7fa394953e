"""Drive of a simulated robot, one tick at a time."""

import random
import zlib
from array import array
from itertools import groupby

from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime
from simbridge.contracts.simulation import Simulation


class Drive(Episode):
    """Simulated drive of kurt2rt.SimulatedRobot, whose caller takes the steps and gives the commands."""

    def __init__(
        self, simulation: Simulation, settings: RobotSettings, task: TaskSettings, training: TrainingStore, seed: int
    ) -> None:
        """Build the runtime in lockstep with the simulation. Raises config.settings.SettingsError."""
        self._clock = LockstepClock(simulation.step)
        options = RuntimeOptions(statistics=training.statistics, checkpoint=training.saved, learners=training.learners)
        runtime = build_runtime(simulation.robot, settings, task, training.events, training.store, self._clock, options)
        super().__init__(
            simulation,
            runtime,
            random.Random(f"drive of a library's robot, seed {seed}"),
            stuck_after_s=task.exam.stuck_after_s,
            on_progress=lambda _: None,
        )
        self._record: TickRecord | None = None
        self._commands: list[tuple[int, Command]] = []
        """Commands, each with the number of its tick."""
        self._checksums = array("I")
        """Checksum of each tick."""

    @property
    def record(self) -> TickRecord:
        """Record of the newest tick. Raises RuntimeError before the first one."""
        if self._record is None:
            raise RuntimeError("there was no tick yet")
        return self._record

    def step(self) -> None:
        """Run the next tick, and what follows each tick."""
        number = self.ticks + 1
        self._clock.step_until(number * self.period_s)
        self._record = self.runtime.tick.run(number, self._clock.now_s())
        self.after_tick(self._record)
        self._checksums.append(_checksum(self._record))

    def send(self, command: Command) -> None:
        """Put a command into the robot's inbox, for the next tick."""
        self._commands.append((self.ticks + 1, command))
        super().send(command)

    def repeat(self, other: "Drive", ticks: int) -> bool:
        """Take so many steps with the commands of another drive from the same start, to explain one of its ticks.

        Returns whether the last of them had the same situation and the same result, bit for bit.
        """
        due = {
            number: [command for _, command in sent] for number, sent in groupby(other._commands, lambda each: each[0])
        }
        for number in range(1, ticks + 1):
            for command in due.get(number, ()):
                self.send(command)
            self.step()
        return self._checksums[-1] == other._checksums[ticks - 1]

    def on_tick(self, record: TickRecord) -> None:
        """Measure the drive; the caller acts on `record` after the step."""
        del record
        self.measure()


def _checksum(record: TickRecord) -> int:
    """Return the CRC-32 of a tick's situation and of its result."""
    result = record.decision.cause, record.decision.action, record.guard_result
    return zlib.crc32(repr(result).encode(), zlib.crc32(record.situation.vector.tobytes()))
