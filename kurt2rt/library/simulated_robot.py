"""Simulated robot for scripts and notebooks, taught by the caller."""

import math
import tempfile
from contextlib import ExitStack, closing
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Self

from config.errors import UserError
from hal.robot_settings import load_robot, robot_named
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner import Learner, LearnerFactory
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.statistics import StatisticsCounter
from kurt2rt.core.task_robot import require_robot_of
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teaching.commands import Command, Correct, Resume, Teach
from kurt2rt.experiments.lockstep.compatibility import require_metric
from kurt2rt.experiments.lockstep.lesson_keeping import lessons_kept
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.knowledge.files.atomic_write import write_new
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.library.drive import Drive
from kurt2rt.library.knowledge import Knowledge
from kurt2rt.library.learners import new_team, require_alone
from kurt2rt.library.senses import Senses
from kurt2rt.library.simulation import open_factory
from kurt2rt.runs.explain.collect import collect_facts
from kurt2rt.runs.explain.facts import MOST_OTHERS
from kurt2rt.runs.explain.reasons import format_decision
from simbridge.contracts.simulation import Pose, Simulation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kurt2rt.library.drive_recorder import DriveRecorder

_PURPOSE = "library"
_TEACHER = "caller"
_LONGEST_S = 24 * 3600.0


class SimulatedRobot:
    """A robot in a simulated world, which moves only in `step` and `run`, as fast as this machine can.

    Close it, or use it as a context manager. Lessons are gone then, unless it has a `path` or `save` was called.
    """

    def __init__(
        self,
        *,
        task: str | None = None,
        world: str | None = None,
        seed: int = 1,
        knowledge: Knowledge | None = None,
        path: str | PathLike[str] | None = None,
        robot: str | None = None,
        bus: str | None = None,
        record: str | PathLike[str] | None = None,
        learner: LearnerFactory | None = None,
    ) -> None:
        """Put the robot into its world and take its first step, so that it has readings.

        Args:
            task: name or path; None: that of `knowledge`, else wall_following.
            world: name or path; None: the world that the task is taught in.
            seed: of the sensors, the noise and the start pose.
            knowledge: to begin with; its file stays as it is.
            path: of a new file that gets each lesson at once; None: lessons are kept by `save` alone.
            robot: name or path of the robot's settings; None: that of `knowledge`, else the robot of the task.
            bus: that carries its CAN frames, so that your own code hears them: a vcan interface such as vcan0,
                shared:NAME between processes, or virtual:NAME in this one. None: a bus of its own.
            record: folder of recordings, in which this run gets a folder, for `kurt2rt.replay`; None: no recording.
            learner: class or function that makes a learner of a setting, which decides instead of the RLAs; not with
                `knowledge` or `record`. None: RLAs decide.

        Raises:
            UserError: as kurt2rt.Error, a name is unknown, settings do not fit, there is a file at `path`, `bus` is
                missing, real or taken, or nothing can be written to `record`.
        """
        require_alone(learner, knowledge=knowledge, record=record)
        self._task = task or ("wall_following" if knowledge is None else knowledge.task)
        self._robot = robot_named(robot or (None if knowledge is None else knowledge.robot), self._task)
        settings = load_robot(self._robot)
        loaded = load_task(self._task)
        require_robot_of(loaded, self._task, settings)
        _require_one_behaviour(loaded)
        self._world = world or loaded.teaching.world
        self._settings, self._loaded, self._seed = settings, loaded, seed
        self._make = learner
        self._factory = open_factory(settings, bus)
        self._factory.require_worlds(self._world)
        require_metric(self._factory, loaded, [self._world])
        self._sent = 0
        self._recorder: DriveRecorder | None = None
        with ExitStack() as opened:
            folder = opened.enter_context(tempfile.TemporaryDirectory(prefix="kurt2rt-"))
            self._file = Path(folder).resolve() / "taught.knowledge" if path is None else Path(path)
            if self._file.exists():
                raise UserError("there is a file already", where=path, do="give the path of a new file")
            if knowledge is not None:
                with Journal.read_only(knowledge.path) as journal:
                    write_new(journal.image(), self._file)
            self._keeping = opened.enter_context(lessons_kept(self._file, settings, loaded, self._on_saved))
            simulation = self._factory.open(self._world, seed, _PURPOSE)
            opened.callback(simulation.close)
            self._team = new_team(learner, loaded, settings, seed)
            training = replace(self._keeping.training, learners=self._team)
            self._drive = Drive(simulation, settings, loaded, training, seed)
            if record is not None:
                self._recorder = self._start_recording(Path(record), simulation)
                opened.callback(self._end_recording, self._recorder)
            self._tick()
            self._opened = opened.pop_all()
        self._closed = False

    def step(self, ticks: int = 1) -> None:
        """Let the robot sense, decide and drive for a number of ticks of 10 ms.

        Raises UserError (kurt2rt.Error) for a number below 1 or with a fraction, and for a lost lesson.
        """
        if ticks < 1 or ticks % 1:  # a fraction, or not a number
            raise UserError(f"not a number of steps (got {ticks!r}, allowed whole numbers from 1 on)", where="ticks")
        self._require_open()
        for _ in range(int(ticks)):
            self._tick()
        self._keeping.check()

    def run(self, seconds: float) -> None:
        """Drive for `seconds` of robot time, rounded to whole steps, at least one; a robot that asks stands meanwhile.

        Raises UserError (kurt2rt.Error) unless `seconds` is above 0 and at most a day, and for a lost lesson.
        """
        if not 0.0 < seconds <= _LONGEST_S:
            raise UserError(
                f"not a duration (got {seconds!r}, allowed above 0, at most {_LONGEST_S:g})", where="seconds"
            )
        self.step(max(1, round(seconds / self._drive.period_s)))

    def teach(self, action: str) -> None:
        """Answer the robot's question with an action, or correct what it does; takes one step.

        Raises UserError (kurt2rt.Error) if the robot refuses the lesson, or has no such action.
        """
        if action not in self.actions:
            raise UserError(f"unknown (got {action!r}, allowed {', '.join(self.actions)})", where="action")
        lesson = Teach if self._drive.record.decision.asking else Correct
        self._command(lesson(self._next_id(), _TEACHER, action))

    def resume(self) -> None:
        """Drive again after the guard stopped the robot; takes one step.

        Raises UserError (kurt2rt.Error) if it must stand.
        """
        self._command(Resume(self._next_id(), _TEACHER))

    def why(self, *, at: float | None = None, tick: int | None = None) -> str:
        """Return the decision of a step and its reasons, a line each.

        An earlier step is simulated again from the beginning, which takes as long as the drive up to it took.

        Args:
            at: time of the step, in s as `seconds`; None: the newest step.
            tick: number of the step, from 1, instead of `at`.

        Raises:
            UserError: as kurt2rt.Error, there was no such step, or other programs on `bus` changed the drive.
        """
        if at is None and tick is None:
            return _explain(self._drive)
        number = self._tick_at(at, tick)
        opened = self._keeping.opened
        counter = StatisticsCounter(dict(opened.saved.uses), dict(opened.saved.transitions))
        team = new_team(self._make, self._loaded, self._settings, self._seed)
        training = TrainingStore(InMemoryEventStore(), opened.events, counter, opened.saved, team)
        with closing(open_factory(self._settings).open(self._world, self._seed, _PURPOSE)) as simulation:
            again = Drive(simulation, self._settings, self._loaded, training, self._seed)
            if not again.repeat(self._drive, number):
                raise UserError(
                    "cannot be simulated again, because another program sent on its bus",
                    where=f"step {number}",
                    do="record the run, and ask kurt2rt.replay",
                )
            return _explain(again)

    def save(self, path: str | PathLike[str]) -> Knowledge:
        """Save all lessons in a new file, durable on return.

        Raises UserError (kurt2rt.Error) if a file is there already, or the disk does not take it.
        """
        self._require_open()
        self._keeping.end(self._drive.runtime.snapshot())
        with Journal.in_writer_process(self._file) as journal:
            write_new(journal.image(), Path(path))
        return Knowledge.load(path, task=self._task, robot=self._robot)

    def plot(self) -> "Figure":
        """Return a figure of the world from above, the drive so far, and the places of its questions."""
        # Late import: matplotlib is an extra that a robot does not need.
        from kurt2rt.experiments.lockstep.drawing import drive_figure

        return drive_figure(self._factory, self._world, self._drive)

    @property
    def senses(self) -> Senses:
        """Infra-red readings of the newest step: `senses["front"].metres`."""
        return Senses(self._drive.runtime.robot, self._drive.record.readings)

    @property
    def question(self) -> str | None:
        """Reasons for which the robot stands and asks; None if it does not ask."""
        return self.why() if self._drive.record.decision.asking else None

    @property
    def action(self) -> str | None:
        """Action that drives; None while the robot stands."""
        return self._drive.record.decision.action

    @property
    def actions(self) -> tuple[str, ...]:
        """Actions that can be taught."""
        return tuple(self._drive.runtime.level.repertoire)

    @property
    def rlas(self) -> tuple[Rla, ...]:
        """Active RLAs of the basic level."""
        return self._drive.runtime.level.system.rlas

    @property
    def learner(self) -> Learner | None:
        """Learner that decides instead of the RLAs; None if they decide."""
        return None if self._team is None else self._team.learner(self._drive.runtime.active_behaviour.behaviour)

    @property
    def recording(self) -> Path | None:
        """Folder of this run's recording, which is whole when the robot is closed; None if it is not recorded."""
        return None if self._recorder is None else self._recorder.run

    @property
    def seconds(self) -> float:
        """Robot time since the beginning."""
        return self._drive.ticks * self._drive.period_s

    @property
    def pose(self) -> Pose:
        """True pose in the world, in m and rad, which the robot itself does not know."""
        return self._drive.simulation.pose

    @property
    def collisions(self) -> int:
        """Contacts with walls and obstacles so far."""
        return self._drive.simulation.collisions

    def close(self) -> None:
        """Stop the robot and drop what was not saved; again: nothing."""
        self._closed = True
        self._opened.close()

    def __enter__(self) -> Self:
        """Return the robot."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the robot."""
        self.close()

    def __repr__(self) -> str:
        """Return task, world, time and knowledge."""
        return (
            f"SimulatedRobot in world {self._world}, task {self._task}: {self.seconds:.2f} s, "
            f"{len(self.rlas)} RLAs, {self.action or 'stands'}"
        )

    def _tick(self) -> None:
        self._drive.step()
        if self._recorder is not None:
            self._recorder.on_tick(self._drive.record, self.why)

    def _tick_at(self, at: float | None, tick: int | None) -> int:
        """Return the number of a step by time or number. Raises UserError if there was none."""
        if at is not None and tick is not None:
            raise UserError(f"got at={at!r} and tick={tick!r}, allowed one of them", where="why")
        taken = self._drive.ticks
        if at is not None:
            if not 0.0 <= at <= self.seconds:
                raise UserError(f"no time of this robot (got {at!r}, allowed 0 to {self.seconds:g} s)", where="at")
            return max(1, math.floor(at / self._drive.period_s + 1e-6))
        if tick is None or tick not in range(1, taken + 1):
            raise UserError(f"no step of this robot (got {tick!r}, allowed 1 to {taken})", where="tick")
        return int(tick)

    def _on_saved(self, acknowledgement: Acknowledgement) -> None:
        if self._recorder is not None:
            self._recorder.on_saved(acknowledgement)

    def _start_recording(self, folder: Path, simulation: Simulation) -> "DriveRecorder":
        # Late import: a tenth of a second.
        from kurt2rt.library.drive_recorder import DriveRecorder

        return DriveRecorder(folder, self._settings, self._loaded, self._keeping.opened, simulation)

    def _end_recording(self, recorder: "DriveRecorder") -> None:
        try:
            self._keeping.end(self._drive.runtime.snapshot())  # the recording says of each lesson that it is durable
        finally:
            recorder.close()

    def _command(self, command: Teach | Correct | Resume) -> None:
        """Send a command, take one step, and raise kurt2rt.Error if the robot refuses it."""
        self._require_open()
        self._send(command)
        self.step()
        for result in self._drive.record.results:
            if result.command_id == command.command_id and not result.accepted:
                raise UserError(f"the robot refused it: {text_of(result.outcome)}", where=type(command).__name__)

    def _send(self, command: Command) -> None:
        self._drive.send(command)

    def _next_id(self) -> str:
        # Lessons of an earlier robot may be in the file; a command id counts once in it.
        self._sent += 1
        return f"{_PURPOSE}-after-{len(self._keeping.opened.entries)}-{self._sent}"

    def _require_open(self) -> None:
        if self._closed:
            raise UserError("is closed", where="SimulatedRobot", do="make a new one")


def _explain(drive: Drive) -> str:
    """Return the newest decision and its reasons, a line each."""
    return format_decision(collect_facts(drive.runtime, drive.record, lambda _command_id: "", most=MOST_OTHERS))


def _require_one_behaviour(task: TaskSettings) -> None:
    """Raise UserError for a task in which lessons would need a behaviour or a level, which `teach` does not take."""
    if task.mid is not None or len(task.behaviours) > 1:
        raise UserError(
            "has a mid level or several behaviours, which a robot of the library cannot be taught",
            where=f"task {task.name}",
            do="give a task with one behaviour, or use kurt2rt.Teacher",
        )
