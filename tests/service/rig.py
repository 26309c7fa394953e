"""The service with the simulated robot in real time, and an ear on its bus."""

import os
import signal
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from behaviors.repertoire import load_repertoire
from hal.bus import CONTROL_ID, CanBus, open_bus
from hal.kurt2_settings import load_kurt2
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.teaching.question import MidQuestion, Question
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.post_tick import ProgramConsole, ProgramStatus
from kurt2rt.service.serve import ServeOptions, serve
from kurt2rt.service.settings import ServiceSettings, load_service
from kurt2rt.teacher.scripted.basic_teacher import view_of_tick
from kurt2rt.teacher.scripted.build import build_teacher
from simbridge.realtime import RealtimeSimulation
from simbridge.robot_simulation import StallTolerantKurt2
from simbridge.simulated_robot import SimulatedKurt2
from simbridge.worlds.world_loading import load_world
from tests.patient_shutdown import extend_deadlines

SETTINGS = load_kurt2()
LONGEST_S = 60.0
"""Ends a test whose event never comes; none waits for it."""


def eager_task() -> TaskSettings:
    """Return settings for a robot that soon asks again and a teacher that answers at once."""
    task = load_task("wall_following")
    teacher = task.teaching.teacher.model_copy(update={"reaction_s": 0.03, "patience_s": 0.05})
    return task.model_copy(
        update={
            "learning": task.learning.model_copy(update={"radius": 100.0}),
            "teaching": task.teaching.model_copy(update={"teacher": teacher}),
        }
    )


@dataclass
class Rig:
    """A simulated robot that lives by itself, the driver at the other end of its bus, and what was seen."""

    robot: StallTolerantKurt2
    robot_bus: CanBus
    far_end: CanBus
    ear: CanBus
    simulation: RealtimeSimulation
    simulated: SimulatedKurt2
    records: list[TickRecord] = field(default_factory=list)
    questions: list[Question | MidQuestion] = field(default_factory=list)
    statuses: list[ProgramStatus] = field(default_factory=list)
    settled: list[Acknowledgement] = field(default_factory=list)

    @property
    def now(self) -> TickRecord:
        """The newest tick."""
        return self.records[-1]

    def control_payloads(self) -> list[bytes]:
        """Every CONTROL frame that went over the bus since the last call."""
        return [bytes(frame.data) for frame in self.ear.drain() if frame.arbitration_id == CONTROL_ID]

    async def serve(
        self, knowledge: Path, watch: Callable[[TickRecord], Command | None], *, task: TaskSettings | None = None
    ) -> ProgramStatus | None:
        """Run the service; `watch` sees each tick, may answer it and ends the run when it has seen enough."""

        def teacher(record: TickRecord) -> Command | None:
            self.records.append(record)
            return watch(record)

        screen = ProgramConsole(
            status=self.statuses.append, question=self.questions.append, acknowledged=self.settled.append
        )
        settings = RunSettings(SETTINGS, task or eager_task(), settings_for(knowledge))
        return await serve(self.robot, settings, screen, ServeOptions(on_tick=teacher, duration_s=LONGEST_S))


def settings_for(knowledge: Path) -> ServiceSettings:
    return load_service().model_copy(update={"knowledge": str(knowledge)})


@contextmanager
def rig() -> Iterator[Rig]:
    spec = f"virtual:{uuid.uuid4()}"
    far_end, robot_bus, ear = open_bus(spec), open_bus(spec), open_bus(spec)
    simulated = SimulatedKurt2(SETTINGS, load_world("a"), far_end, seed=1)
    robot = StallTolerantKurt2(SETTINGS, robot_bus)
    simulation = RealtimeSimulation(simulated)
    simulation.start()
    try:
        with robot.watchdog, pytest.MonkeyPatch.context() as patch:
            extend_deadlines(patch)
            yield Rig(robot, robot_bus, far_end, ear, simulation, simulated)
    finally:
        robot.close()
        if simulation.error is None:
            simulation.stop()
        far_end.shutdown()
        ear.shutdown()


def scripted() -> Callable[[TickRecord], Command | None]:
    """Return the scripted teacher for the robot's own program; it corrects after the task's time of phase 1."""
    task = eager_task()
    actions = tuple(load_repertoire(task.repertoire, SETTINGS))
    teacher = build_teacher(task, SETTINGS, actions, seed=1, session=f"scripted-{uuid.uuid4().hex[:12]}")
    corrections_from = round(task.teaching.supervised_s / SETTINGS.cycle_s)

    def watch(record: TickRecord) -> Command | None:
        if teacher.phase is Phase.SUPERVISED and record.tick >= corrections_from:
            return teacher.begin_phase(Phase.CORRECTIONS)
        return teacher.update(view_of_tick(record))

    return watch


def end_service(number: signal.Signals = signal.SIGTERM) -> None:
    """Send the signal of a service manager or Ctrl-C."""
    os.kill(os.getpid(), number)
