"""Exams in a batch: the same drives as on the CAN bus, many times faster, for robots whose sensors work."""

import random
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import groupby

from behaviors.metrics.task_metric import BorderMetric, StretchMetric, TaskMetric
from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_mind import build_drive_settings, build_minds, require_known, stuck_rule_of
from kurt2rt.experiments.lockstep.drive_row import DriveRow, rounded_places, rounded_poses
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.exam import ExamSetup
from simbridge.contracts.batch import STANDS, Batch, BatchFactory, FollowedSimulation, Start, Tally
from simbridge.contracts.simulation import Pose

_STRETCH_TICKS = 500
_TRAIL_STRIDE = Episode.trail_stride


def examine_in_batch(
    factory: BatchFactory,
    settings: RobotSettings,
    task: TaskSettings,
    setups: Sequence[ExamSetup],
    *,
    measured: bool = True,
) -> list[DriveRow | None]:
    """Drive all exams at once, and return their results in order; None for one that belongs on the CAN bus.

    A result is equal to that of `examine`. A robot that a watch would stop leaves the batch, and so does a stuck one
    that is rescued. `measured`: False for results without places, and as `DriveRow.counted` returns them.

    Raises:
        BatchRefusedError: the batch does not know the task, its policy or an action.
        SettingsError: task and world do not fit.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
    """
    if not setups:
        return []
    require_known(settings, task, setups)
    drive_settings = replace(build_drive_settings(settings, task), stuck=stuck_rule_of(settings, task))
    with _opened(factory, setups) as simulations:
        drives = [
            _Drive(each, settings, task, setup, measured=measured)
            for each, setup in zip(simulations, setups, strict=True)
        ]
        minds = build_minds(simulations, settings, task, setups)
        batch = factory.open_batch(simulations, minds, drive_settings)
        for robot, drive in enumerate(drives):
            drive.begin(batch, robot)
        while active := [robot for robot, drive in enumerate(drives) if drive.ticks_left]:
            # Robots that stopped at a border are behind the others at the end.
            ticks = min(_STRETCH_TICKS, max(drives[robot].ticks_left for robot in active))
            going = [robot for robot in active if drives[robot].ticks_left >= ticks]
            batch.drive(going, ticks)
            for robot in going:
                drives[robot].follow(batch, robot)
        return [drive.result() for drive in drives]


@contextmanager
def _opened(factory: BatchFactory, setups: Sequence[ExamSetup]) -> Iterator[list[FollowedSimulation]]:
    """Yield an open simulation for each exam; close them all."""
    simulations = factory.open_all([Start(setup.world, setup.seed) for setup in setups], "exam")
    try:
        yield simulations
    finally:
        for simulation in simulations:
            simulation.close()


class _Guide:
    """Guide of one robot, which stops at the borders of its metric."""

    def __init__(self, simulation: FollowedSimulation, metric: BorderMetric, chance: random.Random) -> None:
        """`metric`: knows the poses up to the newest one. `chance`: of the course."""
        self._simulation, self._metric, self._chance = simulation, metric, chance

    def begin(self, batch: Batch, robot: int) -> None:
        """Let a robot that has not driven yet stop at borders, and drive by the behaviour that is wanted."""
        batch.watch(robot, self._metric.borders)
        batch.select(robot, self._metric.behaviour)

    def look_after(self, batch: Batch, robot: int) -> Pose | None:
        """Do in the newest tick as the metric says; return the pose in m and rad at which the robot was put, if so."""
        put: Pose | None = None
        if self._metric.needs_reset:
            put = self._simulation.draw_pose(self._chance, in_sight=False)
            batch.put(robot, put)
            self._simulation.carry(put)
            self._metric.reset(put)
        batch.select(robot, self._metric.behaviour)
        return put


class _Drive:
    """Measures of one exam, taken from the poses and decisions of a batch as `ExamRun` takes them tick by tick."""

    def __init__(
        self,
        simulation: FollowedSimulation,
        settings: RobotSettings,
        task: TaskSettings,
        setup: ExamSetup,
        *,
        measured: bool,
    ) -> None:
        chance = random.Random(setup.chance_seed)
        self._simulation, self._task, self._setup = simulation, task, setup
        self._period_s = settings.cycle_s
        metric: TaskMetric = task.metric.build(simulation, task.behaviours, chance)
        self._metric, self._measured = metric, measured
        # Asked once, because these read all members of a protocol.
        self._stretch_metric = metric if isinstance(metric, StretchMetric) else None
        self._guide = _Guide(simulation, metric, chance) if isinstance(metric, BorderMetric) else None
        self._metric.reset(simulation.pose)
        if task.exam.start == "in_sight":
            simulation.reposition(chance, in_sight=True)
            self._metric.reset(simulation.pose)
        self._planned_ticks = round(task.exam.duration_s / self._period_s)
        self._trail: list[Pose] = []
        self._asked: list[Pose] = []
        self._collided: list[Pose] = []
        self._action_changes = 0
        self._action: int | None = None
        self._tally: Tally
        self._left = False

    @property
    def ticks_left(self) -> int:
        """Ticks that the robot still drives."""
        return 0 if self._left or self._tally.stuck else self._planned_ticks - self._tally.ticks

    def begin(self, batch: Batch, robot: int) -> None:
        """Begin the drive of a robot of the batch."""
        if self._guide is not None:
            self._guide.begin(batch, robot)
        self._tally = batch.tally(robot)

    def follow(self, batch: Batch, robot: int) -> None:
        """Measure the newest stretch of a robot, and look after the robot as after its last tick."""
        self._left = bool(batch.reason_to_leave(robot))
        if self._left:
            return
        if self._measured or self._guide is not None:
            self._measure(batch, robot)
            self._left = bool(batch.reason_to_leave(robot))
        self._tally = batch.tally(robot)
        if self._tally.stuck and not self._setup.stuck_ends:
            self._left = True

    def _measure(self, batch: Batch, robot: int) -> None:
        stretch = batch.stretch(robot)
        poses = stretch.poses
        self._asked += [poses[place] for place, begins in enumerate(stretch.begins) if begins]
        if stretch.collisions[-1] > len(self._collided):
            for place, collisions in enumerate(stretch.collisions):
                if collisions > len(self._collided):
                    self._collided.append(poses[place])
        self._count_actions(stretch.actions)
        self._follow_poses(poses)
        put = None if self._guide is None else self._guide.look_after(batch, robot)
        trail = poses[-(self._tally.ticks + 1) % _TRAIL_STRIDE :: _TRAIL_STRIDE]
        if put is not None and (self._tally.ticks + len(poses)) % _TRAIL_STRIDE == 0:
            trail[-1] = put
        self._trail += trail

    def result(self) -> DriveRow | None:
        """Return the result of the exam; None if the robot left the batch."""
        if self._left:
            return None
        tally, metric, simulation = self._tally, self._metric, self._simulation
        if tally.stuck:
            metric.abort()
        duration_s = tally.ticks * self._period_s
        drive = DriveRow(
            world=self._setup.world,
            seed=self._setup.seed,
            duration_s=duration_s,
            progress=metric.progress,
            unit=metric.unit,
            way_m=tally.travelled_m,
            collisions=tally.collisions,
            stuck=tally.stuck,
            share_unknown=tally.unknown_ticks / tally.ticks,
            questions=tally.questions,
            first_question_s=tally.first_question * self._period_s,
            first_collision_s=tally.first_collision * self._period_s,
            action_changes_per_s=self._action_changes / duration_s,
            trail=rounded_poses(self._trail),
            asked_at=rounded_places(self._asked),
            findings={name: float(value) for name, value in metric.findings.items()},
            collided_at=rounded_places(self._collided),
            least_progress=self._task.metric.least_progress(simulation, self._task.exam.duration_s)
            if self._measured
            else 0.0,
        )
        return drive if self._measured else drive.counted().stored()

    def _follow_poses(self, poses: Sequence[Pose]) -> None:
        """Measure the drive at each pose."""
        self._simulation.follow(poses)
        if self._stretch_metric is not None:
            self._stretch_metric.update_all(poses)
            return
        for pose in poses:
            self._metric.update(pose)

    def _count_actions(self, actions: Sequence[int]) -> None:
        for action, _ in groupby(actions):
            if action != self._action:
                # A robot that asks in its first tick has not changed its action: before, it had none.
                self._action_changes += not (self._action is None and action == STANDS)
                self._action = action
