"""Drives of one robot with a broken infra-red sensor, or with none, without a teacher."""

import random
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from enum import StrEnum

from behaviors.policies.policy import ReferencePolicy
from hal.robot import STANDSTILL, Robot
from hal.robot_settings import RobotSettings
from hal.simulation import Simulation, SimulationFactory
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.decision.active_stop import StopReason
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Pursue, Resume
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.faulty_sensor import BREAKS_AT_S, FaultKind, FaultySensor
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime

GO_AFTER_S = 0.5
"""Time that a robot stands at the notice until it gets its Go."""
MISLEADS_COUNTS = 60
"""Difference to a working sensor's reading from which on a broken one misleads."""
_ASKS_S = 3.0
"""Time after which a robot that asks is set down at another start."""
_STUCK_S = 15.0
_PRESSES_FOR_S = 4.0
_EXPERIMENTER = "experimenter"


class Driver(StrEnum):
    """Mind that drives."""

    RLAS = "RLAs"
    POLICY = "policy"
    PRESSES = "presses"
    """Each action for some seconds, whatever is in the way: the robot is pressed against walls."""


@dataclass(frozen=True, slots=True)
class DriveSetup:
    """World, seed, driver and fault of one drive."""

    world: str
    seed: int
    driver: Driver
    longest_s: float
    """Longest time of driving until the notice, in s."""
    after_s: float = 0.0
    """Time that is driven after Go, in s."""
    sensor: int | None = None
    """Place of the broken sensor in the table; None: all sensors work."""
    fault: FaultKind = FaultKind.LOW


class BrokenSensorRun(Episode):
    """Episode that counts collisions, questions and named sensors, and says Go after each notice."""

    def __init__(
        self, simulation: Simulation, runtime: Runtime, setup: DriveSetup, faulty: FaultySensor | None
    ) -> None:
        chance = random.Random(f"broken sensor in world {setup.world}, seed {setup.seed}")
        super().__init__(simulation, runtime, chance, stuck_after_s=_STUCK_S, on_progress=lambda _: None)
        if runtime.task.exam.start == "in_sight":
            self.reposition(in_sight=True)
        self._setup = setup
        self._faulty = faulty
        self._asked_ticks = self._stopped_ticks = 0
        self._driven_ticks = self._misled_ticks = 0
        self._collided_at: list[int] = []
        self.named: list[tuple[str, str]] = []
        """Names of sensors that were named as broken, with the signs."""
        self.noticed = ""
        """Sign by which the broken sensor was noticed; empty before."""
        self.went_on_at: int | None = None
        """Tick of the Go after that notice."""
        self.noticed_at: int | None = None
        self.asks = 0
        self.end_tick: int | None = None
        """Tick at which the drive ends in any case; set by a caller to drive as long as another drive."""
        self._collisions_of_before = 0

    @property
    def driven_s(self) -> float:
        """Time of driving with the fault until it was noticed, or of all driving without a fault, in s."""
        return self._driven_ticks * self.period_s

    @property
    def misled_s(self) -> float:
        """Part of `driven_s` in which the reading was far from a working sensor's, in s."""
        return self._misled_ticks * self.period_s

    def collisions_until(self, tick: int | None) -> int:
        """Return the collisions with the fault up to a tick; None: up to the end."""
        return sum(tick is None or at <= tick for at in self._collided_at)

    def on_tick(self, record: TickRecord) -> None:
        """Count one tick; say Go after a notice, and set the robot down elsewhere if it asks or is stuck."""
        self.measure()
        if record.tick * self.period_s < BREAKS_AT_S and self._faulty is not None:
            self._collisions_of_before = self.simulation.collisions
            return
        for _ in range(self.simulation.collisions - self._collisions_of_before - len(self._collided_at)):
            self._collided_at.append(record.tick)
        if record.guard_result.wheel_speeds != STANDSTILL and not self.noticed:
            self._driven_ticks += 1
            if self._faulty is not None:
                self._misled_ticks += abs(self._faulty.true_counts - self._faulty.counts) > MISLEADS_COUNTS
        self._note_sensors(record)
        self._act(record)
        if self._is_over(record.tick):
            self.runtime.scheduler.end()

    def _note_sensors(self, record: TickRecord) -> None:
        stop = record.standing.stop
        if stop is None or stop.reason is not StopReason.SENSOR_BROKEN:
            self._stopped_ticks = 0
            return
        self._stopped_ticks += 1
        if self._stopped_ticks == 1:
            broken = {each.place: each for each in record.broken_sensors}
            for place, each in broken.items():
                if place != self._setup.sensor:
                    self.named.append((each.name, each.fault))
                elif not self.noticed:
                    self.noticed, self.noticed_at = each.fault, record.tick
        if self._stopped_ticks == round(GO_AFTER_S / self.period_s):
            if self._setup.sensor is None:
                # A working sensor is trusted again once its reading has changed: the person carries the robot away.
                self.reposition()
                self.runtime.reposition()
            elif self.noticed and self.went_on_at is None:
                self.went_on_at = record.tick
            self.send(Resume(self.next_id("go"), _EXPERIMENTER))

    def _act(self, record: TickRecord) -> None:
        if record.guard_result.latched:
            self.simulation.rescue()
            self.send(Resume(self.next_id("go"), _EXPERIMENTER))
        asking = record.decision.asking
        self.asks += self.question.begins
        self._asked_ticks = self._asked_ticks + 1 if asking else 0
        if self._asked_ticks * self.period_s >= _ASKS_S or self.is_stuck() or self.metric.needs_reset:
            self.reposition()
            self.runtime.reposition()
            self._asked_ticks = 0
        if self.task.mid is None and self.metric.behaviour != record.behaviour:
            self.send(Pursue(self.next_id("wanted"), _EXPERIMENTER, self.metric.behaviour))

    def _is_over(self, tick: int) -> bool:
        if self.end_tick is not None:
            return tick >= self.end_tick
        if self.went_on_at is not None:
            return (tick - self.went_on_at) * self.period_s >= self._setup.after_s
        return self.driven_s >= self._setup.longest_s


class _PressingPolicy:
    """Policy that takes an action at random for some seconds each."""

    def __init__(self, actions: Sequence[str], seed: int, period_s: float) -> None:
        self._actions = actions
        self._chance = random.Random(f"presses {seed}")
        self._ticks = round(_PRESSES_FOR_S / period_s)
        self._asked = 0
        self._action = actions[0]

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it looks at nothing
        """Return the action of this tick."""
        if self._asked % self._ticks == 0:
            self._action = self._chance.choice(self._actions)
        self._asked += 1
        return self._action


async def drive(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    events: Sequence[TeachingEvent],
    setup: DriveSetup,
    end_tick: int | None = None,
) -> BrokenSensorRun:
    """Drive as the setup says and return the finished run.

    Args:
        factory: opens the simulation.
        settings: of the robot.
        task: that the robot was taught.
        events: its lessons.
        setup: world, seed, driver and fault.
        end_tick: tick at which the drive ends; None: after the time of the setup.

    Raises:
        hal.settings.SettingsError: task and world do not fit.
        UnknownActionError, UnknownBehaviourError: the lessons do not fit the task.
    """
    with closing(factory.open(setup.world, setup.seed, "broken sensor")) as simulation:
        robot: Robot = simulation.robot
        faulty = None
        if setup.sensor is not None:
            faulty = FaultySensor(robot, settings.infrared, setup.sensor, setup.fault, BREAKS_AT_S)
            robot = faulty
        runtime = _runtime(robot, simulation, settings, task, events, setup)
        run = BrokenSensorRun(simulation, runtime, setup, faulty)
        run.end_tick = end_tick
        # A robot that asks or stands does not drive: three times the time is enough for all of it.
        longest_s = BREAKS_AT_S + 3.0 * (setup.longest_s + setup.after_s)
        await run.run(round(longest_s / run.period_s))
        return run


def _runtime(
    robot: Robot,
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    events: Sequence[TeachingEvent],
    setup: DriveSetup,
) -> Runtime:
    behaviour = ActiveBehaviour(task.behaviours)
    level = None
    if setup.driver is not Driver.RLAS:
        task = task.model_copy(update={"mid": None})  # the policy chooses behaviours, too
        repertoire = load_task_repertoire(task, settings)
        minimum_ticks = round(task.learning.minimum_action_s / settings.cycle_s)
        policy: ReferencePolicy = task.policy.build(settings.infrared)
        if setup.driver is Driver.PRESSES:
            policy = _PressingPolicy(tuple(repertoire), setup.seed, settings.cycle_s)
        level = PolicyLevel(policy, repertoire, minimum_ticks, behaviour)
    return build_runtime(
        robot,
        settings,
        task,
        events,
        NoTeachingAllowed(),
        LockstepClock(simulation.step),
        RuntimeOptions(
            level_override=level,
            active_behaviour=behaviour,
            teacher_available=False,
            checks_sensors=setup.driver is not Driver.POLICY or setup.sensor is None,
        ),
    )
