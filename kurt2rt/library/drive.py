"""Drive of a simulated robot, one tick at a time."""

import random

from hal.robot_settings import RobotSettings
from hal.simulation import Simulation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime


class Drive(Episode):
    """Episode whose caller takes the steps and is the teacher."""

    def __init__(
        self, simulation: Simulation, settings: RobotSettings, task: TaskSettings, training: TrainingStore, seed: int
    ) -> None:
        """Build the runtime in lockstep with the simulation. Raises hal.settings.SettingsError."""
        self._clock = LockstepClock(simulation.step)
        options = RuntimeOptions(statistics=training.statistics, checkpoint=training.saved)
        runtime = build_runtime(simulation.robot, settings, task, training.events, training.store, self._clock, options)
        super().__init__(
            simulation,
            runtime,
            random.Random(f"drive of a library's robot, seed {seed}"),
            stuck_after_s=task.exam.stuck_after_s,
            on_progress=lambda _: None,
        )
        self._record: TickRecord | None = None

    @property
    def record(self) -> TickRecord:
        """Record of the newest tick. Raises RuntimeError before the first one."""
        if self._record is None:
            raise RuntimeError("there was no tick yet")
        return self._record

    def step(self) -> None:
        """Take the next tick."""
        number = self.ticks + 1
        self._clock.step_until(number * self.period_s)
        self._record = self.runtime.tick.run(number, self._clock.now_s())
        self.after_tick(self._record)

    def on_tick(self, record: TickRecord) -> None:
        """Measure the drive; the caller acts on `record` after the step."""
        del record
        self.measure()
