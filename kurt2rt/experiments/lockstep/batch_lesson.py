"""Lessons in a batch: the same training runs as on the CAN bus, many times faster.

The robot drives compiled stretches as if its teacher did nothing. Then the teacher sees what a person would have seen.
Where it gives a command, the robot goes back to that tick, and its own runtime carries the command out.
"""

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from behaviors.metrics.task_metric import BorderMetric, StretchMetric
from hal.robot_settings import RobotSettings
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.reinforcement.logged_decisions import LoggedDecisions
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import HoldAction
from kurt2rt.experiments.lockstep.batch_mind import build_lesson_settings, choice_of
from kurt2rt.experiments.lockstep.command_checks import require_accepted
from kurt2rt.experiments.lockstep.episode import StuckDetector
from kurt2rt.experiments.lockstep.lesson import GivenLesson, TrainingRun
from kurt2rt.experiments.lockstep.lesson_mind import LessonMind
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime
from kurt2rt.teacher.scripted.basic_teacher import TeacherView
from simbridge.contracts.batch_lesson import LessonCause, LessonFactory, TaughtSimulation
from simbridge.contracts.simulation import Poses, Position

_UNKNOWN, _TEACHER = int(LessonCause.UNKNOWN), int(LessonCause.TEACHER)
_STRETCH_TICKS = 200
"""Ticks that are driven before the teacher looks: half as many are taken back at a command on average."""
_ENGINE_TICKS = 50
"""Ticks in a row in the physics engine after which a stretch ends."""


def teach_in_batch(
    factory: LessonFactory,
    settings: RobotSettings,
    task: TaskSettings,
    *,
    seed: int,
    on_progress: Callable[[float], None],
    learners: LearnerTeam | None = None,
) -> GivenLesson | None:
    """Teach an untaught robot as `teach` does; return the lesson, None if it belongs on the CAN bus.

    Args:
        factory: opens the simulation.
        settings: of the robot.
        task: to teach.
        seed: of robot and teacher.
        on_progress: called once for each simulated second, with the simulated seconds.
        learners: taught in place of the RLAs; None: RLAs decide.

    Raises:
        BatchRefusedError: the batch does not know the task or its teacher.
        LessonLostError: the robot refused a command.
        config.settings.SettingsError: task and world do not fit.
    """
    with open_batch_lesson(factory, settings, task, seed=seed, on_progress=on_progress, learners=learners) as run:
        return run.given() if run.drive_stretches() else None


@contextmanager
def open_batch_lesson(
    factory: LessonFactory,
    settings: RobotSettings,
    task: TaskSettings,
    *,
    seed: int,
    on_progress: Callable[[float], None],
    learners: LearnerTeam | None = None,
) -> Iterator["BatchTrainingRun"]:
    """Yield a lesson that has not begun, with its robot; close the robot's simulation (`teach_in_batch`).

    `learners`: taught in place of the RLAs; None: RLAs decide. Raises BatchRefusedError, config.settings.SettingsError.
    """
    plan, store = plan_of(task), InMemoryEventStore()
    choose = None if learners is None else choice_of(learners, task, taught=lambda: runtime.handler.is_taught)
    lesson = build_lesson_settings(settings, task, choose)
    with closing(factory.open_lesson(task.teaching.world, seed, plan.purpose, lesson)) as simulation:
        robot = simulation.lesson
        recent = LoggedDecisions(robot.log, lesson.features.average_steps, robot.actions, task.behaviours)
        training = TrainingStore(store, learners=learners)
        runtime = build_training_runtime(simulation, settings, task, training, recent)
        mind = LessonMind(runtime, robot, recent, store, learners)
        session = f"{plan.purpose}-{seed}-after-0"
        yield BatchTrainingRun(simulation, mind, plan, seed=seed, session=session, on_progress=on_progress)


class BatchTrainingRun(TrainingRun):
    """Training run that drives the robot in compiled stretches from one command to the next."""

    def __init__(
        self,
        simulation: TaughtSimulation,
        mind: LessonMind,
        plan: LessonPlan,
        *,
        seed: int,
        session: str,
        on_progress: Callable[[float], None],
    ) -> None:
        super().__init__(simulation, mind.runtime, plan, seed=seed, session=session, on_progress=on_progress)
        self.robot, self._mind = simulation.lesson, mind
        self._actions = self.robot.actions
        if isinstance(self.metric, BorderMetric):
            self.robot.watch_borders(self.metric.borders)
        # Asked once, because it reads all members of the protocol.
        self._stretch_metric = self.metric if isinstance(self.metric, StretchMetric) else None
        self._messages: list[tuple[int, HoldAction]] = []
        """Messages of a hold that goes on in the present stretch, with their ticks."""

    def given(self) -> GivenLesson:
        """Return the lesson so far."""
        return GivenLesson(self.result(), self.events)

    @property
    def events(self) -> list[TeachingEvent]:
        """Lessons so far, oldest first."""
        return self._mind.events

    def drive_stretches(self) -> bool:
        """Teach all phases of the plan; return False, with an unfinished result, if the robot leaves the batch."""
        self._command_behaviour(self.runtime.active_behaviour.behaviour)
        while self.ticks < self._planned_ticks and not self._is_right:
            if not self._drive_stretch():
                return False
        self._mind.count(self.ticks)
        return True

    def _drive_stretch(self) -> bool:
        """Drive to the next command, or as far as is known; return whether the robot stays in the batch."""
        robot, begin = self.robot, self.ticks
        due = self._mind.is_due(begin + 1)
        if due or robot.waits:
            robot.sense()
            if robot.trouble:
                return False
        if due:
            results = self._mind.take(begin + 1)
            self._refused += require_accepted(results, begin + 1, self.task, self._teacher.may_be_refused)
            if any(result.lesson for result in results):
                self.question.close()
        cut = self._drive_on(begin)
        if cut is None:
            return False
        poses = robot.keep()
        if self._mind.holds:
            self._hold_on(begin + 1 + due, cut)
        self._pass(begin, cut, poses)
        self._note_labels()
        return True

    def _drive_on(self, begin: int) -> int | None:
        """Drive until the teacher says something or the stretch ends, and return that tick.

        While the physics engine moves the body the teacher sees each tick at once, because the engine cannot go back.
        Returns None if the robot leaves the batch.
        """
        robot, seen = self.robot, begin
        while True:
            reached = robot.run(self._stretch_end(seen))
            if reached > seen:
                stuck = self._stuck_tick(begin, reached)
                seen = self._ask_teacher(seen, reached if stuck is None else stuck)
                if seen < reached or seen == stuck or self._repositions_at(seen):
                    robot.restore_tick(seen)
                    return seen
            if robot.trouble:
                return None
            if seen > begin and not self._goes_on_in_engine(begin, seen):
                return seen
            robot.sense()
            if robot.trouble:
                return None

    def _goes_on_in_engine(self, begin: int, tick: int) -> bool:
        """Return whether the stretch goes on after a tick, with the next one in the physics engine."""
        due = self._mind.is_due(tick + 1) or self._mind.holds
        return self.robot.waits and not due and tick - begin < _ENGINE_TICKS

    def _hold_on(self, first: int, cut: int) -> None:
        """Carry out the messages of a hold up to a tick; a later one is sent."""
        if self._messages and self._messages[-1][0] > cut:
            self.send(self._messages.pop()[1])
        self._mind.hold_on(first, cut, self._messages)
        self._messages.clear()

    def _stretch_end(self, begin: int) -> int:
        """Return the tick up to which the robot may drive at once after tick `begin`."""
        ends = [begin + _STRETCH_TICKS, self._planned_ticks, *self._phase_starts_after(begin)]
        if self._reposition_every:
            ends.append((begin // self._reposition_every + 1) * self._reposition_every)
        if self._clean_end is not None and self._clean_end > begin:
            ends.append(self._clean_end)
        arrives = self._teacher.command_due
        if arrives is not None and not self._mind.holds:
            ends.append(max(begin + 1, arrives))
        return min(ends)

    def _phase_starts_after(self, begin: int) -> list[int]:
        """Return the tick before the next phase; its first tick if the phase begins after tick `begin`."""
        return [tick if tick == begin + 1 else tick - 1 for tick in self._phase_starts if tick > begin]

    def _repositions_at(self, tick: int) -> bool:
        return bool(self._reposition_every) and tick % self._reposition_every == 0

    def _stuck_tick(self, begin: int, end: int) -> int | None:
        """Return the tick up to `end` in which the robot has been stuck for long enough; None without one."""
        return self._follow_detector(self._stuck.copy(), begin, end)

    def _follow_detector(self, detector: StuckDetector, begin: int, end: int) -> int | None:
        """Let a detector see the ticks from `begin` + 1 to `end`; return the tick in which it finds the robot stuck."""
        if self.runtime.handler.stops.active is not None:
            return None
        log = self.robot.log
        asks = log.causes[begin + 1 : end + 1] == _UNKNOWN
        edges: list[int] = [0, *((asks[1:] != asks[:-1]).nonzero()[0] + 1).tolist(), end - begin]
        for first, after in pairwise(edges):
            if first < after and asks[first]:
                detector.restart()
                continue
            stuck = detector.ticks_until_stuck(after - first, partial(self._position, begin + 1 + first))
            if stuck is not None:
                return begin + first + stuck
        return None

    def _position(self, first: int, place: int) -> Position:
        """Return the position in the tick that is `place` ticks after the `first`."""
        x_m, y_m, _ = self.robot.log.poses[first + place].tolist()
        return Position(x_m, y_m)

    def _ask_teacher(self, begin: int, last: int) -> int:
        """Show the ticks up to `last` to the teacher, and return the tick of the first command, or `last`."""
        if begin + 1 in self._phase_starts:
            self._begin_phase(self._phase_starts[begin + 1])
        log, teacher = self.robot.log, self._teacher
        rows = slice(begin + 1, last + 1)
        asks = log.causes[rows] == _UNKNOWN
        actions, right = log.actions[begin : last + 1], log.right[begin : last + 1]
        differs = asks | ((actions[1:] >= 0) & (actions[1:] != right[1:]))
        # A question has no action, and a robot without an action asks or was stopped.
        changes = (actions[1:] != actions[:-1]) | (right[1:] != right[:-1])
        ahead = _LessonAhead(*(each.nonzero()[0] + begin + 1 for each in (asks, differs, changes)))
        held_to = self._mind.held_to
        tick, until = begin, last if held_to is None else min(last, held_to)
        # A teacher sees at once that another behaviour is wanted.
        may_skip = bool(log.behaviours[begin + 1] == log.behaviours[begin])
        while tick < until:
            tick += teacher.skip(ahead.after(tick, until)) if may_skip else 0
            if tick == until:
                break
            tick, may_skip = tick + 1, True
            command = teacher.answer(self._view(tick))
            if command is None:
                continue
            if not isinstance(command, HoldAction) or not self._mind.renews(command):
                self._send_lesson(command, tick)
                break
            self._note_unclean(tick)
            self._workload.count(tick, command)
            self._messages.append((tick + 1, command))
            until = min(last, self._mind.held_to_by(command, tick + 1))
        return tick

    def _view(self, tick: int) -> TeacherView:
        """Return the teacher's view of a tick."""
        log = self.robot.log
        action = log.actions.item(tick)
        return TeacherView(
            asking=log.causes.item(tick) == _UNKNOWN,
            driving=action >= 0,
            action=self._actions[action] if action >= 0 else None,
            infrared_counts=tuple(log.counts[tick].tolist()),
            behaviour=self.task.behaviours[log.behaviours.item(tick)],
            tick=tick,
            touching=log.touching.item(tick),
        )

    def _pass(self, begin: int, cut: int, poses: Poses) -> None:
        """Measure the ticks up to `cut` as `after_tick` does one by one, and look after the robot in the last one."""
        asks = self.robot.log.causes[begin + 1 : cut + 1] == _UNKNOWN
        unclean = (asks | self.robot.log.touching[begin + 1 : cut + 1]).nonzero()[0]
        if len(unclean):
            self._note_unclean(begin + 1 + int(unclean[-1]))
        self.ticks = cut
        self.unknown_ticks += int(asks.sum())
        if self.question.is_open or asks.any():
            self._count_questions(begin, poses)
        self.asking = bool(asks[-1])
        self._measure_all(poses)
        self._follow_detector(self._stuck, begin, cut - 1)
        first = -(begin + 1) % self.trail_stride
        self.trail += poses[first : len(poses) - 1 : self.trail_stride]
        collisions = self.robot.log.collisions[begin : cut + 1]
        met = (collisions[1:] != collisions[:-1]).nonzero()[0]
        self.collided_at += [Position(*poses[place][:2]) for place in met.tolist()]
        self._look_after(cut)
        self._command_behaviour(self.runtime.active_behaviour.behaviour)
        if cut % self.trail_stride == 0:
            self.trail.append(self.simulation.pose)
        for second in range(begin // self.ticks_per_second + 1, cut // self.ticks_per_second + 1):
            tick = second * self.ticks_per_second
            self._note_second(tick, self._mind.rlas_after(tick))
            self._on_progress(tick * self.period_s)

    def _count_questions(self, begin: int, poses: Poses) -> None:
        """Count the questions of the ticks after `begin`, each at its pose."""
        log, rows = self.robot.log, slice(begin + 1, begin + 1 + len(poses))
        columns = (log.causes, log.behaviours, log.sure, log.turned)
        ticks = zip(poses, *(column[rows].tolist() for column in columns), strict=True)
        for pose, cause, behaviour, sure, turned in ticks:
            asks, pressed = cause == _UNKNOWN, cause == _TEACHER
            name = self.task.behaviours[behaviour]
            if self.question.count(name, asks=asks, sure=sure, moves=turned, pressed=pressed):
                self.ask_positions.append(Position(pose.x_m, pose.y_m))

    def _measure_all(self, poses: Poses) -> None:
        self._pose = poses[-1]
        if self._stretch_metric is not None:
            self._stretch_metric.update_all(poses)
            return
        for pose in poses:
            self.metric.update(pose)


class _LessonAhead:
    """Ticks that were driven and that a teacher may skip (kurt2rt.teacher.scripted.basic_teacher.Ahead)."""

    def __init__(self, questions: NDArray[np.intp], differences: NDArray[np.intp], changes: NDArray[np.intp]) -> None:
        """Know the ticks of questions and so on, ascending, each (n,)."""
        self._questions, self._differences, self._changes = questions, differences, changes
        self._tick = 0
        self.ticks = 0
        """Number of known ticks."""

    def after(self, tick: int, until: int) -> "_LessonAhead":
        """Look from the tick after `tick` on, up to `until`."""
        self._tick, self.ticks = tick, until - tick
        return self

    @property
    def until_question(self) -> int:
        """Number of ticks before the first in which the robot asks; all without one."""
        return self._until(self._questions)

    @property
    def until_difference(self) -> int:
        """Number of ticks before the first in which it asks or does another action than the policy's."""
        return self._until(self._differences)

    @property
    def until_change(self) -> int:
        """Number of ticks before the first with another action, or another right action, than in the tick before."""
        return self._until(self._changes)

    def _until(self, ticks: NDArray[np.intp]) -> int:
        place = ticks.searchsorted(self._tick, side="right")
        return min(ticks.item(place) - 1 - self._tick, self.ticks) if place < len(ticks) else self.ticks
