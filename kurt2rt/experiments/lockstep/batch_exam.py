"""Exams in a batch: the same drives as on the CAN bus, many times faster, for robots whose sensors work."""

import math
import random
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby, pairwise, starmap

from behaviors.metrics.task_metric import BorderMetric, StretchMetric, TaskMetric
from hal.batch import STANDS, Batch, BatchFactory, FollowedSimulation, Start, Stretch
from hal.robot_settings import RobotSettings
from hal.simulation import Pose, Position
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_guide import BatchGuide
from kurt2rt.experiments.lockstep.batch_mind import build_drive_settings, build_minds, require_known
from kurt2rt.experiments.lockstep.episode import Episode, StuckDetector
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup

_STRETCH_TICKS = 500
_TRAIL_STRIDE = Episode.trail_stride


@dataclass(frozen=True, slots=True)
class BatchExam:
    """One exam of a batch."""

    setup: ExamSetup
    events: Sequence[TeachingEvent] = ()
    """Lessons of the robot; the policy's own drive does without them."""


def examine_in_batch(
    factory: BatchFactory, settings: RobotSettings, task: TaskSettings, exams: Sequence[BatchExam]
) -> list[ExamResult | None]:
    """Drive all exams at once, and return their results in order; None for one that belongs on the CAN bus.

    A result is equal to that of `examine`. A robot that a watch would stop leaves the batch, and so does a stuck one
    that is rescued.

    Raises:
        BatchRefusedError: the batch does not know the task, its policy or an action.
        SettingsError: task and world do not fit.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
    """
    if not exams:
        return []
    require_known(task, [exam.setup for exam in exams])
    with _opened(factory, exams) as simulations:
        drives = [_Drive(each, settings, task, exam.setup) for each, exam in zip(simulations, exams, strict=True)]
        minds = build_minds(simulations, settings, task, [(exam.events, exam.setup) for exam in exams])
        batch = factory.open_batch(simulations, minds, build_drive_settings(settings, task))
        for robot, drive in enumerate(drives):
            drive.begin(batch, robot)
        while active := [robot for robot, drive in enumerate(drives) if drive.goes_on]:
            # Robots that stopped at a border are behind the others at the end.
            ticks = max(drives[robot].next_ticks for robot in active)
            going = [robot for robot in active if drives[robot].next_ticks == ticks]
            batch.drive(going, ticks)
            for robot in going:
                drives[robot].follow(batch, robot)
        return [drive.result() for drive in drives]


@contextmanager
def _opened(factory: BatchFactory, exams: Sequence[BatchExam]) -> Iterator[list[FollowedSimulation]]:
    """Yield an open simulation for each exam; close them all."""
    simulations = factory.open_all([Start(exam.setup.world, exam.setup.seed) for exam in exams], "exam")
    try:
        yield simulations
    finally:
        for simulation in simulations:
            simulation.close()


class _Drive:
    """Measures of one exam, taken from the poses and decisions of a batch as `ExamRun` takes them tick by tick."""

    def __init__(
        self, simulation: FollowedSimulation, settings: RobotSettings, task: TaskSettings, setup: ExamSetup
    ) -> None:
        chance = random.Random(setup.chance_seed)
        self._simulation, self._task, self._setup = simulation, task, setup
        self._period_s = settings.cycle_s
        metric: TaskMetric = task.metric.build(simulation, task.behaviours, chance)
        self._metric = metric
        # Asked once, because these read all members of a protocol.
        self._stretch_metric = metric if isinstance(metric, StretchMetric) else None
        self._guide = BatchGuide(simulation, metric, chance) if isinstance(metric, BorderMetric) else None
        self._metric.reset(simulation.pose)
        if task.exam.start == "in_sight":
            simulation.reposition(chance, in_sight=True)
            self._metric.reset(simulation.pose)
        self._planned_ticks = round(task.exam.duration_s / self._period_s)
        self._stuck = StuckDetector(task.exam.stuck_after_s, self._period_s, least_m=task.exam.stuck_within_m)
        self._pose = simulation.pose
        self._trail: list[Position] = []
        self._ask_positions: list[Position] = []
        self._collision_positions: list[Position] = []
        self._ticks = self._unknown_ticks = self._action_changes = 0
        self._travelled_m = 0.0
        self._action: int | None = None
        self._is_stuck = self._left = False

    @property
    def goes_on(self) -> bool:
        """Return whether the robot drives on."""
        return not self._left and not self._is_stuck and self._ticks < self._planned_ticks

    @property
    def next_ticks(self) -> int:
        """Return the length of the next stretch."""
        return min(_STRETCH_TICKS, self._planned_ticks - self._ticks)

    def begin(self, batch: Batch, robot: int) -> None:
        """Begin the drive of a robot of the batch."""
        if self._guide is not None:
            self._guide.begin(batch, robot)

    def follow(self, batch: Batch, robot: int) -> None:
        """Measure the newest stretch of a robot, and look after the robot as after its last tick."""
        self._left = bool(batch.reason_to_leave(robot))
        if self._left:
            return
        stretch = batch.stretch(robot)
        # In its last tick the robot may be put elsewhere before it is looked at.
        stuck_after = self._stuck_after(stretch.poses[:-1])
        ticks = len(stretch.poses) if stuck_after is None else stuck_after
        poses = stretch.poses[:ticks]
        self._count_collisions(stretch, ticks)
        self._count_actions(stretch, ticks)
        begins = zip(poses, stretch.begins, strict=False)
        self._ask_positions += [Position(pose.x_m, pose.y_m) for pose, question_begins in begins if question_begins]
        # Added one by one, as in each tick of `Episode`: another order would change the last digits.
        for step_m in starmap(_step_m, pairwise([self._pose, *poses])):
            self._travelled_m += step_m
        self._pose = poses[-1]
        self._follow_poses(poses)
        if stuck_after is None:
            put = None if self._guide is None else self._guide.look_after(batch, robot)
            if put is not None:
                self._pose, self._left = put, bool(batch.reason_to_leave(robot))
                self._stuck.restart()
            stuck_after = self._stuck_after([self._pose])
        first = -(self._ticks + 1) % _TRAIL_STRIDE
        self._trail += [Position(pose.x_m, pose.y_m) for pose in [*poses[:-1], self._pose][first::_TRAIL_STRIDE]]
        self._ticks += ticks
        self._is_stuck = stuck_after is not None
        if self._is_stuck and not self._setup.stuck_ends:
            self._left = True

    def result(self) -> ExamResult | None:
        """Return the result of the exam; None if the robot left the batch."""
        if self._left:
            return None
        if self._is_stuck:
            self._metric.abort()
        duration_s = self._ticks * self._period_s
        return ExamResult(
            world=self._setup.world,
            seed=self._setup.seed,
            duration_s=duration_s,
            progress=self._metric.progress,
            unit=self._metric.unit,
            distance_travelled_m=self._travelled_m,
            collisions=len(self._collision_positions),
            stuck=self._is_stuck,
            share_unknown=self._unknown_ticks / self._ticks,
            action_changes_per_s=self._action_changes / duration_s,
            trail=tuple(self._trail),
            unknown_positions=tuple(self._ask_positions),
            findings=self._metric.findings,
            collision_positions=tuple(self._collision_positions),
            least_progress=self._task.metric.least_progress(self._simulation, self._task.exam.duration_s),
        )

    def _stuck_after(self, poses: Sequence[Pose]) -> int | None:
        """Return the number of further ticks after which the robot is stuck; None if it is not."""
        return self._stuck.ticks_until_stuck(len(poses), lambda k: Position(poses[k].x_m, poses[k].y_m))

    def _follow_poses(self, poses: Sequence[Pose]) -> None:
        """Measure the drive at each pose."""
        self._simulation.follow(poses)
        if self._stretch_metric is not None:
            self._stretch_metric.update_all(poses)
            return
        for pose in poses:
            self._metric.update(pose)

    def _count_collisions(self, stretch: Stretch, ticks: int) -> None:
        if stretch.collisions[ticks - 1] == len(self._collision_positions):
            return
        for pose, collisions in zip(stretch.poses[:ticks], stretch.collisions, strict=False):
            if collisions > len(self._collision_positions):
                self._collision_positions.append(Position(pose.x_m, pose.y_m))

    def _count_actions(self, stretch: Stretch, ticks: int) -> None:
        for action, run in groupby(stretch.actions[:ticks]):
            if action != self._action:
                # A robot that asks in its first tick has not changed its action: before, it had none.
                self._action_changes += not (self._action is None and action == STANDS)
                self._action = action
            self._unknown_ticks += len(list(run)) if action == STANDS else 0


def _step_m(before: Pose, after: Pose) -> float:
    return math.hypot(after.x_m - before.x_m, after.y_m - before.y_m)
