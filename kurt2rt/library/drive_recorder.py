"""Recorder of a simulated drive, as that of `kurt2rt run`, but written by the thread that steps the robot."""

import secrets
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

from config.errors import UserError
from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.loading import OpenedKnowledge
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.library.extras import extra_named
from kurt2rt.runs.recording.recording import Recording, RunContext
from kurt2rt.runs.recording.run_folder import Budget
from simbridge.contracts.simulation import SimulatedPlace, Simulation, WorldPlan

_NO_LIMIT = Budget(total_bytes=1 << 62, segment_bytes=32_000_000)
_WRITES_EVERY_TICKS = 10
_SYNCS_EVERY_TICKS = 1000
_SIMULATED = "sim"


class _StillWorld:
    """World of a simulation without a thread (simbridge.contracts.simulation.WorldView)."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def place(self) -> SimulatedPlace:
        """Return the true place of the robot."""
        simulation = self._simulation
        return SimulatedPlace(*simulation.pose, simulation.laps, simulation.collisions, simulation.plan.version)

    def world(self) -> WorldPlan:
        """Return the world from above."""
        return self._simulation.plan


class DriveRecorder:
    """Recorder of one simulated drive, which begins before its first tick."""

    def __init__(
        self,
        folder: Path,
        settings: RobotSettings,
        task: TaskSettings,
        knowledge: OpenedKnowledge,
        simulation: Simulation,
    ) -> None:
        """Make the folder of a run in `folder`. Raises UserError (kurt2rt.Error) if nothing can be recorded there."""
        recording = Recording(folder, _NO_LIMIT, _SIMULATED, _StillWorld(simulation))
        context = RunContext(secrets.token_hex(8), knowledge="", attended=False)
        # Without the recorder's thread: it writes in real time, and loses ticks of a faster drive.
        with extra_named():
            self._recorder = recording.recorder(settings, task, knowledge, context, started=datetime.now(UTC))
        self._folder = folder
        self._recorder.poll()
        self._check()
        assert self._recorder.run is not None  # without trouble there is a folder
        self.run: Path = self._recorder.run
        """Folder of the run."""

    def on_tick(self, record: TickRecord, question: Callable[[], str]) -> None:
        """Record a tick and, in the first tick of a question, the question.

        Raises UserError (kurt2rt.Error) if the disk fails.
        """
        self._recorder.on_tick(record)
        if record.question_begins:
            self._recorder.on_question(question())
        if record.tick % _WRITES_EVERY_TICKS == 0:
            self._recorder.write_waiting()
        if record.tick % _SYNCS_EVERY_TICKS == 0:
            self._recorder.poll()
            self._check()

    def on_saved(self, acknowledgement: Acknowledgement) -> None:
        """Record that a lesson is durable."""
        self._recorder.on_acknowledged(acknowledgement)

    def close(self) -> None:
        """Write the rest. Raises UserError (kurt2rt.Error) if the disk fails."""
        self._recorder.close()
        self._check()

    def _check(self) -> None:
        if self._recorder.trouble:
            raise UserError(self._recorder.trouble, where=self._folder)
