"""Episode: one drive of a simulated robot in lockstep with its world, watched from above."""

import math
import random
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable
from copy import copy
from typing import ClassVar

from behaviors.metrics.task_metric import RouteMetric
from hal.robot import STANDSTILL
from kurt2rt.core.decision.open_question import OpenQuestion
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runtime import Runtime
from simbridge.contracts.batch import StuckRule
from simbridge.contracts.simulation import Pose, Position, Simulation

_LOOK_S = 0.5
"""Time between two positions of the stuck detector."""


def build_stuck_rule(window_s: float, period_s: float, *, least_m: float) -> StuckRule:
    """Return the rule by which a robot that stays within `least_m`, in m, for `window_s`, in s, is stuck.

    `period_s`: of a tick, in s.
    """
    return StuckRule(round(_LOOK_S / period_s), max(2, round(window_s / _LOOK_S) + 1), least_m)


class StuckDetector:
    """Detector of a robot that stayed within `least_m` for `window_s`, also if it goes round in circles.

    Exams end at it; in lessons the robot is set down elsewhere (rescued).
    """

    def __init__(self, window_s: float, period_s: float, *, least_m: float = 1.0) -> None:
        rule = build_stuck_rule(window_s, period_s, least_m=least_m)
        self._stride = rule.every_ticks
        self._positions: deque[Position] = deque(maxlen=rule.positions)
        self._least_m2 = rule.least_m * rule.least_m
        self._ticks = 0

    def none_since_window(self, pose: Pose) -> bool:
        """Return whether the robot stayed within `least_m` for a whole window; call it in every tick."""
        return self.ticks_until_stuck(1, lambda _: Position(pose.x_m, pose.y_m)) is not None

    def ticks_until_stuck(self, ticks: int, position_at: Callable[[int], Position]) -> int | None:
        """Return the number of ticks in a row after which the robot is stuck; None if it is not.

        `position_at`: returns the position in m of one of the `ticks` ticks, counted from 0.
        """
        first = -self._ticks % self._stride
        self._ticks += ticks
        for place in range(first, ticks, self._stride):
            if self._looks_stuck(position_at(place)):
                return place + 1
        return None

    def _looks_stuck(self, position: Position) -> bool:
        """Enter a position, and return whether the robot stayed near it for a whole window."""
        self._positions.append(position)
        full = len(self._positions) == self._positions.maxlen
        return full and all(
            (position.x_m - old.x_m) * (position.x_m - old.x_m) + (position.y_m - old.y_m) * (position.y_m - old.y_m)
            < self._least_m2
            for old in self._positions
        )

    def restart(self) -> None:
        """Begin a new window, because the robot was set down elsewhere."""
        self._positions.clear()
        self._ticks = 0

    def copy(self) -> "StuckDetector":
        """Return a detector in the same state, to try out ticks that may be taken back."""
        twin = copy(self)
        twin._positions = self._positions.copy()
        return twin


class Episode(ABC):
    """Simulation, runtime, task metric, stuck detection and counters of one drive, one world step a tick.

    A subclass is a kind of drive: lesson, exam, tour or goals. Each tick calls, in this order: the counters
    of this class, `on_tick` of the subclass, the trail, and once a second `on_second`.
    """

    trail_stride: ClassVar[int] = 20
    """Ticks between two points of the trail."""

    def __init__(
        self,
        simulation: Simulation,
        runtime: Runtime,
        chance: random.Random,
        *,
        stuck_after_s: float,
        on_progress: Callable[[float], None],
    ) -> None:
        """Build the task's metric at the robot's pose; on a route, place the robot on the route first.

        Args:
            simulation: world that the runtime's clock steps.
            runtime: robot mind that drives.
            chance: random choices of the metric and of repositioning.
            stuck_after_s: time within the task's `exam.stuck_within_m` after which the robot is stuck.
            on_progress: called once a second with the simulated seconds.

        Raises:
            config.settings.SettingsError: the world does not fit the metric.
        """
        task, period_s = runtime.task, runtime.robot.cycle_s
        self.simulation = simulation
        self.runtime = runtime
        self.task = task
        self.period_s = period_s
        self.ticks_per_second = round(1 / period_s)
        self.metric = task.metric.build(simulation, task.behaviours, chance)
        self.trail: list[Pose] = []
        self.ask_positions: list[Position] = []
        """Position of each question's first tick."""
        self.collided_at: list[Position] = []
        self.mid_asks = 0
        """Questions of the mid level among them."""
        self.ticks = 0
        self.unknown_ticks = 0
        """Ticks in situations that the robot does not know."""
        self.latched_ticks = 0
        self.asking = False
        self.question = OpenQuestion()
        self.distance_travelled_m = 0.0
        """Distance on the robot's own wheels."""
        self.repositions = 0
        """Planned repositionings, without rescues."""
        self._chance = chance
        self._stuck = StuckDetector(stuck_after_s, period_s, least_m=task.exam.stuck_within_m)
        self._on_progress = on_progress
        self._sent = 0
        if isinstance(self.metric, RouteMetric):
            simulation.put(self.metric.reset_pose)
        self._pose = simulation.pose
        self.metric.reset(self._pose)

    @abstractmethod
    def on_tick(self, record: TickRecord) -> None:
        """Act on one tick, after the counters of this class."""

    def on_second(self, record: TickRecord) -> None:
        """Report the progress to the callback; called once a second of robot time."""
        self._on_progress(record.now_s)

    async def run(self, ticks: int) -> None:
        """Drive for so many ticks, or until the scheduler is ended, with `after_tick` after each tick."""
        await self.runtime.scheduler.run(ticks, self.after_tick)

    def after_tick(self, record: TickRecord) -> None:
        """Count one tick and call `on_tick` and `on_second`."""
        decision = record.decision
        self.ticks = record.tick
        self.unknown_ticks += decision.asking
        self.latched_ticks = self.latched_ticks + 1 if record.guard_result.latched else 0
        if record.results and any(result.lesson for result in record.results):
            self.question.close()
        turned = record.guard_result.wheel_speeds != STANDSTILL
        self.question.update(decision, record.standing, record.behaviour, turned)
        if self.question.begins:
            self.ask_positions.append(self.simulation.position)
            self.mid_asks += decision.asks_at == MID
        self.asking = decision.asking
        if self.simulation.collisions > len(self.collided_at):
            self.collided_at.append(self.simulation.position)
        self.on_tick(record)
        if record.tick % self.trail_stride == 0:
            self.trail.append(self.simulation.pose)
        if record.tick % self.ticks_per_second == 0:
            self.on_second(record)

    def send(self, command: Command) -> None:
        """Put a command into the robot's inbox, for the next tick."""
        self.runtime.inbox.put(command)

    def next_id(self, name: str) -> str:
        """Return a new command id, `name` with a number, such as exam-1."""
        self._sent += 1
        return f"{name}-{self._sent}"

    def measure(self) -> None:
        """Update the metric and the travelled distance with the robot's pose; call it once in every tick."""
        pose = self.simulation.pose
        dx, dy = pose.x_m - self._pose.x_m, pose.y_m - self._pose.y_m
        # Squares are rounded alike in compiled code (simbridge.batch.tally); a hypotenuse is not.
        self.distance_travelled_m += math.sqrt(dx * dx + dy * dy)
        self._pose = pose
        self.metric.update(pose)

    def is_stuck(self, *, waiting: bool = False) -> bool:
        """Return whether the robot stayed in place for too long; `waiting` restarts the time. Call it in every tick."""
        if waiting:
            self._stuck.restart()
            return False
        return self._stuck.none_since_window(self.simulation.pose)

    def rescue(self) -> None:
        """Put the robot at the nearest start pose, or on its route."""
        if isinstance(self.metric, RouteMetric):
            self.simulation.put(self.metric.reset_pose)
        else:
            self.simulation.rescue()
        self._begin_at(self.simulation.pose)

    def reposition(self, *, in_sight: bool = False, close: bool = False) -> None:
        """Put the robot on its route, or else at a random pose.

        `in_sight`: at a pose from which a sensor sees an obstacle. `close`: so close to it that the robot cannot turn.
        """
        if isinstance(self.metric, RouteMetric):
            self.simulation.put(self.metric.reset_pose)
        else:
            self.simulation.reposition(self._chance, in_sight=in_sight, close=close)
        self.repositions += 1
        self._begin_at(self.simulation.pose)

    def place(self, pose: Pose) -> None:
        """Put the robot at this pose and report it to the robot."""
        self.simulation.put(pose)
        self.runtime.reposition()
        self._begin_at(pose)

    def restart_counting(self) -> None:
        """Start a new stretch here: distance 0, and a new window of the stuck detector."""
        self._pose = self.simulation.pose
        self.distance_travelled_m = 0.0
        self._stuck.restart()

    def _begin_at(self, pose: Pose) -> None:
        self._pose = self.simulation.pose
        self._stuck.restart()
        self.question.close()
        self.metric.reset(pose)
