"""Contract of a lesson in a batch: a robot that drives in compiled stretches, while its teacher teaches it.

The robot's own decisions are compiled. Teacher, commands and lessons are not: they act between two stretches.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from simbridge.contracts.areas import Borders
from simbridge.contracts.batch import Action, Choose, FeatureTable, TabledPolicy
from simbridge.contracts.simulation import Poses, Simulation, SimulationFactory


class LessonCause(IntEnum):
    """Cause of a tick's decision in the log of a compiled lesson."""

    RLA = 0
    HELD = 1
    """Another RLA is nearest, but the minimum time of the action is not over."""
    UNKNOWN = 2
    """The robot stands and asks."""
    STOPPED = 3
    """A teacher stopped the robot."""
    TEACHER = 4
    """An action that the teacher holds drives."""
    LEARNER = 5
    """An action drives that Python chose (`LessonDriveSettings.choose`)."""


class LessonLog(NamedTuple):
    """Course of a compiled lesson, one row for each tick, which its teacher reads and commands look back in.

    Row 0 is the robot before its first tick.
    """

    features: NDArray[np.int16]
    """Recent features in counts, (ticks + 1, features)."""
    sums: NDArray[np.int32]
    """Sums of the features over the steps of the average, (ticks + 1, features)."""
    counts: NDArray[np.int16]
    """Readings of all sensors, (ticks + 1, sensors)."""
    poses: NDArray[np.float64]
    """x, y in m and heading in rad, (ticks + 1, 3)."""
    causes: NDArray[np.int8]
    """LessonCause of each tick."""
    actions: NDArray[np.int8]
    """Index of the action that drives; -1 while the robot stands."""
    behaviours: NDArray[np.int8]
    """Index of the taught behaviour that is wanted."""
    right: NDArray[np.int8]
    """Index of the action that the policy takes for right."""
    rlas: NDArray[np.int32]
    """Number of the RLA that drives, as in `TaughtRlas`; 0 for none."""
    slow: NDArray[np.bool_]
    """True where a slow lesson slowed the wheels."""
    sure: NDArray[np.bool_]
    """True where the situation is inside R with a margin (simbridge.contracts.shared_rules)."""
    turned: NDArray[np.bool_]
    """True where a wheel turns."""
    touching: NDArray[np.bool_]
    collisions: NDArray[np.int32]
    """Collisions so far."""


class TaughtRlas(NamedTuple):
    """RLAs that a compiled robot decides by: those of the wanted behaviour, which compete, oldest first."""

    numbers: Sequence[int]
    """A number above 0 for each RLA, and for each of its images."""
    conditions: Sequence[NDArray[np.float64]]
    """Weighted features of each RLA, the recent ones first, and averages if they count, (values,)."""
    radii: Sequence[float]
    """Distances within which they answer now."""
    actions: Sequence[str]


class LessonMode(NamedTuple):
    """Orders of the teacher that hold until the next command: a stop, a held action, a lesson speed."""

    stopped: bool = False
    """The robot stands until a resume."""
    held: str = ""
    """Action that the teacher holds; empty if none is."""
    speed_share: float = 1.0
    """Fraction of their speed at which actions drive."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LessonDriveSettings:
    """Settings of a robot that is taught in a batch: actions, features, and the teacher's policy."""

    actions: dict[str, Action]
    """Actions that the robot may be taught, by name."""
    minimum_ticks: int
    """Ticks before another action may replace the driving one."""
    behaviours: tuple[str, ...]
    """Names of the taught behaviours; the first is wanted at the begin."""
    policy: TabledPolicy
    """Policy of the teacher."""
    features: FeatureTable
    ticks: int
    """Length of the lesson."""
    choose: Choose | None = None
    """Choice of the action in each tick, instead of the RLAs, for the situation by `features`; None: RLAs decide.

    An error that it raises ends `LessonRobot.run`, which raises it.
    """


class LessonRobot(Protocol):
    """Simulation of a robot that is taught while it drives in compiled stretches between commands."""

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions, by index."""
        ...

    @property
    def log(self) -> LessonLog:
        """Course of the lesson; rows after the present tick have no meaning."""
        ...

    @property
    def trouble(self) -> str:
        """Return why the lesson belongs on the loop over the CAN bus; empty if it does not."""
        ...

    def watch_borders(self, borders: Borders) -> None:
        """Let `run` end at borders; before the first tick.

        Raises simbridge.contracts.batch.BatchRefusedError for too many areas.
        """
        ...

    def select_behaviour(self, behaviour: str) -> None:
        """Make a taught behaviour active from the next decision on."""
        ...

    def set_rlas(self, rlas: TaughtRlas) -> None:
        """Replace the RLAs; the next decision may take another action at once, even if one is held."""
        ...

    def set_mode(self, mode: LessonMode) -> None:
        """Set the orders from the next decision on."""
        ...

    @property
    def waits(self) -> bool:
        """Return whether the next tick needs the physics engine, so that `sense` must begin it."""
        ...

    def sense(self) -> None:
        """Begin the next tick up to its situation, whose row of the log is written; decide in the next `run`."""
        ...

    def run(self, until: int) -> int:
        """Drive to the end of a tick and return its number; less at a border, and before the physics engine's ticks.

        Ticks after the last `keep` can be taken back. Raises ValueError for too many ticks.
        """
        ...

    def restore_tick(self, tick: int) -> None:
        """Restore the state at the end of an earlier tick, at most back to the last `keep`."""
        ...

    def keep(self) -> Poses:
        """Keep all ticks so far, and return their poses; the simulation is where the robot is."""
        ...

    def allow_switch(self) -> None:
        """Let the next decision take another action at once, even if one is held, because something was learned."""
        ...

    def restart_held(self) -> None:
        """Begin the held action from its start."""
        ...

    def trust_sensors(self) -> None:
        """Forget contradictions of sensors with their neighbours, as a resume does."""
        ...

    def lesson_hash(self) -> str:
        """Return the state hash of the robot, as the simulated robot on the CAN bus has it after these ticks."""
        ...


class TaughtSimulation(Simulation, Protocol):
    """Simulation whose robot drives by its `lesson` alone, and follows it."""

    @property
    def lesson(self) -> LessonRobot:
        """Robot that is taught."""
        ...


@runtime_checkable
class LessonFactory(SimulationFactory, Protocol):
    """Factory of simulations whose robots are taught in compiled stretches."""

    def open_lesson(self, world: str, seed: int, purpose: str, settings: LessonDriveSettings) -> TaughtSimulation:
        """Open a simulation (simbridge.contracts.simulation.SimulationFactory) with a compiled robot.

        Raises simbridge.contracts.batch.BatchRefusedError for what the batch does not know.
        """
        ...
