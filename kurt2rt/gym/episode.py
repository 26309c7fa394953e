"""Episode of an environment: one drive over the simulated CAN bus, decision by decision."""

import random
from collections.abc import Collection

from hal.robot_settings import RobotSettings
from hal.simulation import Pose, Simulation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.gym.commanded_level import CommandedLevel
from kurt2rt.gym.endings import INEVITABLE, Ending
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime

_SENSORS_WITHIN_TICKS = 100
"""Ticks in which all sensor boards of a robot that was switched on have reported; they need three."""


class AgentEpisode(Episode):
    """Drive of an agent, with the starts, the noise and the measures of an exam."""

    def __init__(
        self,
        simulation: Simulation,
        settings: RobotSettings,
        task: TaskSettings,
        setup: ExamSetup,
        *,
        ends_at: Collection[Ending],
        ticks: int,
        start: Pose | None = None,
    ) -> None:
        """Set the robot down at `start`, or where the exam of this setup begins, and wait for its sensors.

        Args:
            simulation: world of the drive, just opened.
            settings: settings of the robot.
            task: task with one behaviour and without a mid level.
            setup: world and seed.
            ends_at: endings besides those that leave no way to go on.
            ticks: length of the drive.
            start: pose in m and rad.

        Raises:
            hal.settings.SettingsError: task and world do not fit.
        """
        self.world = setup.world
        self._level = CommandedLevel(load_task_repertoire(task, settings))
        self._clock = LockstepClock(simulation.step)
        options = RuntimeOptions(level_override=self._level, teacher_available=False)
        runtime = build_runtime(simulation.robot, settings, task, (), NoTeachingAllowed(), self._clock, options)
        chance = random.Random(setup.chance_seed)
        super().__init__(
            simulation, runtime, chance, stuck_after_s=task.exam.stuck_after_s, on_progress=lambda _seconds: None
        )
        if start is not None:
            self.place(start)
        elif task.exam.start == "in_sight":
            self.reposition(in_sight=True)
        self._ends_at = frozenset(ends_at) | INEVITABLE
        self._collisions_before = simulation.collisions
        self._last_tick: int | None = None
        self.ending: Ending | None = None
        """Reason that the drive is over; None while it goes on."""
        self.record = self._wait_for_sensors()
        """Record of the newest tick."""
        self._first_tick = self.ticks
        self._last_tick = self.ticks + ticks

    @property
    def driven_ticks(self) -> int:
        """Ticks since the sensors reported."""
        return self.ticks - self._first_tick

    def drive(self, action: str, ticks: int) -> tuple[TickRecord, Ending | None]:
        """Drive by an action for so many ticks, or until the drive is over.

        Returns the record of the last tick, and the reason that the drive is over; None while it goes on. Raises
        KeyError for an action outside the repertoire.
        """
        self._level.command(action)
        for _ in range(ticks):
            self.record = self._tick()
            if self.ending is not None:
                break
        return self.record, self.ending

    def on_tick(self, record: TickRecord) -> None:
        """Measure the drive, and note whether it is over."""
        self.measure()
        for ending, reached in self._endings(record):
            if reached and ending in self._ends_at:
                self.ending = ending
                break

    def _endings(self, record: TickRecord) -> tuple[tuple[Ending, bool], ...]:
        """Return whether each ending is reached in this tick, the weightiest one first."""
        collisions, before = self.simulation.collisions, self._collisions_before
        self._collisions_before = collisions
        return (
            (Ending.STOPPED, record.standing.needs_resume),
            (Ending.OFF_COURSE, self.metric.needs_reset),
            (Ending.COLLISION, collisions > before),
            (Ending.STUCK, self.is_stuck()),
            (Ending.TIME, record.tick == self._last_tick),
        )

    def _tick(self) -> TickRecord:
        number = self.ticks + 1
        self._clock.step_until(number * self.period_s)
        record = self.runtime.tick.run(number, self._clock.now_s())
        self.after_tick(record)
        return record

    def _wait_for_sensors(self) -> TickRecord:
        """Tick until the robot perceives; return that tick's record."""
        for _ in range(_SENSORS_WITHIN_TICKS):
            record = self._tick()
            if record.decision.asking:
                return record
        raise RuntimeError(f"the simulated robot does not see after {_SENSORS_WITHIN_TICKS} ticks")
