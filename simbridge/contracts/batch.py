"""Contract of a batch: many simulated robots that drive at once, by policies or by taught RLAs, without a teacher."""

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from config.errors import UserError
from hal.guard_reason import GuardReason
from simbridge.contracts.areas import Borders
from simbridge.contracts.simulation import Pose, Poses, Simulation, SimulationFactory

STANDS = -1
"""Index of the action of a robot that stands and asks."""


class FeatureKind(IntEnum):
    """Kind of a situation's feature, as far as the compiled loop knows it."""

    READING = 0
    MAXIMUM = 1
    MINIMUM = 2
    ORIENTATION = 3
    """Counts by which the first sensor exceeds the second, or 0."""
    NOTHING = 4
    """Always 0."""


class FeatureTable(NamedTuple):
    """Features of a situation as a batch needs them, in their order; a weight of 0 counts for nothing."""

    kinds: tuple[FeatureKind, ...]
    sensors: tuple[tuple[int, ...], ...]
    """Places of each feature's sensors in the sensor table."""
    weights: tuple[float, ...]
    average_steps: int
    """Steps of the averages."""
    average_weights: tuple[float, ...] = ()
    """Weights of the averages; empty if they count for nothing."""


@runtime_checkable
class TabledPolicy(Protocol):
    """Reference policy that names all its actions; a batch knows the shipped ones by their classes."""

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions that the policy may choose."""
        ...

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        """Return the name of the action for the counts of all sensors and a taught behaviour."""
        ...


@dataclass(frozen=True, slots=True)
class PolicyMind:
    """Mind of a robot in a batch that drives by a reference policy, not by RLAs."""

    policy: TabledPolicy


@dataclass(frozen=True, slots=True)
class TaughtMind:
    """Robot that drives by the RLAs of its active behaviour, and stands outside their radii."""

    sizes: tuple[int, ...]
    """Number of RLAs of each taught behaviour, in the order of `DriveSettings.behaviours` and of all fields below."""
    rla_ids: tuple[int, ...]
    conditions: Sequence[Sequence[float]]
    """Weighted features of each RLA, the recent ones first; averages if they count."""
    radii: tuple[float, ...]
    answers: tuple[int, ...]
    """Place of the RLA that answers where RLAs share a condition; most places name themselves."""
    actions: tuple[str, ...]
    features: FeatureTable


@dataclass(frozen=True, slots=True)
class CommandedMind:
    """Mind of a robot in a batch that drives by `Batch.command`; it stands before the first one."""


Choose = Callable[[str, NDArray[np.float64]], str | None]
"""Choice of an action for the name of the wanted behaviour and a situation (d,), a copy; None: stand and ask."""


@dataclass(frozen=True, slots=True)
class CallbackMind:
    """Robot whose action Python chooses in each tick; the robot stands where there is no answer."""

    choose: Choose
    """An error that it raises ends `Batch.drive`, which raises it."""
    features: FeatureTable
    """Features of the situation, with averages; each number counts by its weight."""


Mind = PolicyMind | TaughtMind | CommandedMind | CallbackMind


class FixedSpeeds(NamedTuple):
    """Action of a batch that has fixed set points."""

    left_m_s: float
    right_m_s: float


class WallDistance(NamedTuple):
    """Action of a batch that keeps a distance from a wall, with the numbers of behaviors.keep_distance."""

    front: int
    """Place of the sensor in front in the sensor table."""
    back: int
    towards_left: float
    distance_m: float
    speed_m_s: float
    gain_per_m: float
    baseline_m: float


class Turn(NamedTuple):
    """Action that turns on the spot until each side has rolled so far (behaviors.turn_by_angle)."""

    wanted_m: float
    left_m_s: float
    right_m_s: float


Action = FixedSpeeds | WallDistance | Turn


MOST_KEPT = 256
"""Most positions in a window of a batch's `StuckRule`."""


class StuckRule(NamedTuple):
    """Rule by which a robot is stuck: all its positions of a window are near the newest one."""

    every_ticks: int
    """Ticks from one position to the next; the first tick counts."""
    positions: int
    """Positions in a window."""
    least_m: float
    """Distance that ends being stuck."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveSettings:
    """Settings that all robots of a batch share: actions, behaviours, and the rule of being stuck."""

    actions: Mapping[str, Action]
    """Actions that the batch knows, by name."""
    minimum_ticks: int
    """Ticks before another action may replace the driving one."""
    behaviours: tuple[str, ...] = ("",)
    """Names of the taught behaviours; the first is wanted at the begin."""
    stuck: StuckRule | None = None
    """Rule that ends the drive of a robot; None: none."""


class Stretch(NamedTuple):
    """Course of one robot over the ticks of the newest `Batch.drive`, from which metrics measure its drive.

    Each list has one value for each tick.
    """

    poses: Poses
    actions: list[int]
    """Indexes into `Batch.actions`, or STANDS."""
    rlas: list[int]
    """Places of the driving RLAs in the robot's TaughtMind; -1 for a policy and a robot that stands."""
    distances: list[float]
    """Distance of the nearest RLA; infinite for a policy and without RLAs."""
    collisions: list[int]
    """Collisions so far."""
    begins: list[int]
    """1 where a question begins."""


class Tally(NamedTuple):
    """Counts of one robot's drive since its start, for the result of an exam; ticks are counted from 1."""

    ticks: int
    unknown_ticks: int
    """Ticks in which it stood and asked."""
    questions: int
    """Questions, each of which noise may end for moments (simbridge.contracts.shared_rules)."""
    first_question: int
    """Tick of the first question; 0: none."""
    collisions: int
    first_collision: int
    """Tick of the first collision; 0: none."""
    stuck: bool
    """True if the rule of the settings ended the drive."""
    travelled_m: float
    """Distance on the robot's own wheels."""


class Trace(NamedTuple):
    """Readings of a commanded robot over the newest stretch of ticks, one value for each tick."""

    counts: list[tuple[int, ...]]
    """Readings of all sensors, in counts."""
    left_ticks: list[int]
    """Encoder ticks of the left side in this tick, forward positive."""
    right_ticks: list[int]
    bumpers: list[int]
    """Bit n is set if bumper n touches."""
    limits: list[tuple[GuardReason, ...]]
    """Reasons why the guard changed the set points."""


TRACED_TICKS = 10
"""Most ticks of a stretch of a commanded robot."""


class Batch(Protocol):
    """Robots that compiled loops drive at once, each in a world of its own, 100 times as fast as on the CAN bus.

    Each gives the same bits as the CAN loop would. A robot for which that cannot hold leaves (`reason_to_leave`), and
    its whole drive is repeated on the bus. Studies compare some with a witness.
    """

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions, by index."""
        ...

    def drive(self, robots: Sequence[int], ticks: int) -> list[int]:
        """Let these robots drive so many ticks on, and return those that can go on.

        Robots that leave the batch, are stuck or cross a border stop early.
        """
        ...

    def reason_to_leave(self, robot: int) -> str:
        """Return why a robot cannot be driven in the batch any further; empty if it can.

        A watch would stop it. Its whole drive belongs on the loop over the CAN bus.
        """
        ...

    def stretch(self, robot: int) -> Stretch:
        """Return the course of a robot over the newest call of `drive`."""
        ...

    def tally(self, robot: int) -> Tally:
        """Return the counts of a robot's drive so far."""
        ...

    def command(self, robot: int, action: int) -> None:
        """Let an action drive a commanded robot from the next tick on; a finished turn begins again.

        `action`: index into `actions`.
        """
        ...

    def watch(self, robot: int, borders: Borders) -> None:
        """Let the stretches of a robot end at borders; before it drives.

        Raises hal.batch_refusal.BatchRefusedError for too many areas.
        """
        ...

    def select(self, robot: int, behaviour: str) -> None:
        """Make a taught behaviour of a robot active from its next decision on."""
        ...

    def put(self, robot: int, pose: Pose) -> None:
        """Put a robot, standing, at this pose in m and rad."""
        ...

    def trace(self, robot: int) -> Trace:
        """Return the readings of a commanded robot over the newest call of `drive`."""
        ...

    def state_hash(self, robot: int, laps: float) -> str:
        """Return the state hash of a robot, as the simulated robot on the CAN bus has it after these ticks."""
        ...


@runtime_checkable
class FollowedSimulation(Simulation, Protocol):
    """Simulation whose robot is driven in a batch, and which follows its pose, to measure its drive."""

    def follow(self, poses: Sequence[Pose]) -> None:
        """Be at the last of these poses, one for each cycle that a batch simulated.

        The simulation can be stepped no more.
        """
        ...

    def draw_pose(self, chance: random.Random, *, in_sight: bool, close: bool = False) -> Pose:
        """Return a pose in m and rad at which `reposition` would put the robot."""
        ...

    def carry(self, pose: Pose) -> None:
        """Set the robot to the pose in m and rad at which `Batch.put` has put it."""
        ...


class Start(NamedTuple):
    """World of a simulation, and the seed that draws its robot, start pose and noise."""

    world: str
    seed: int


@runtime_checkable
class BatchFactory(SimulationFactory, Protocol):
    """Factory of simulations that can also drive the robots of many at once, in a compiled batch."""

    def open(self, world: str, seed: int, purpose: str) -> FollowedSimulation:
        """Open a simulation of a robot (simbridge.contracts.simulation.SimulationFactory)."""
        ...

    def open_all(self, starts: Sequence[Start], purpose: str) -> list[FollowedSimulation]:
        """Open a simulation for each start, as `open` does; a world that several share is loaded once.

        The caller closes them. Raises SettingsError for an unknown world; then none stays open.
        """
        ...

    def open_batch(
        self, simulations: Sequence[FollowedSimulation], minds: Sequence[Mind], settings: DriveSettings
    ) -> Batch:
        """Return a batch of the robots of fresh simulations, which themselves stay where they are.

        Raises hal.batch_refusal.BatchRefusedError for what the batch does not know.
        """
        ...


class BatchRefusedError(UserError):
    """The batch simulator cannot drive this as the loop over the CAN bus does; the text says what and what to do."""
