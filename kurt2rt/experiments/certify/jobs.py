"""Jobs of a certificate: blocks of runs in a batch, and witnesses that the CAN loop drives as well."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import anyio

from hal.batch import BatchFactory
from hal.batch_refusal import BatchRefusedError
from kurt2rt.experiments.certify.drives import Subject, drive_in_batch, drive_on_bus
from kurt2rt.experiments.certify.outcome import BlockOutcome, RunOutcome, WitnessOutcome
from kurt2rt.experiments.certify.run import Run
from kurt2rt.experiments.lockstep.drive_loop import BatchDiffersError, DriveLoop
from kurt2rt.experiments.lockstep.exam import ExamResult
from kurt2rt.experiments.study.jobs import SimulationJob
from kurt2rt.experiments.study.pool import Progress
from kurt2rt.experiments.study.progress_sum import ProgressSum
from kurt2rt.knowledge.journal.loading import read_lessons

BATCH_GAIN = 100.0
"""A run in the batch counts as so many times less robot time in the progress than one on the CAN loop."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveJob(SimulationJob):
    """Runs of one knowledge file."""

    knowledge: Path

    @property
    @abstractmethod
    def seed(self) -> int:
        """Number of the first run."""

    def subject(self) -> Subject:
        """Return the taught robot. Raises KnowledgeError."""
        return Subject(self.robot, self.task, read_lessons(self.knowledge, self.robot, self.task))

    def drive_in_batch(self, subject: Subject, runs: Sequence[Run], tell: Progress) -> list[RunOutcome | None]:
        """Drive runs in a batch; `tell` gets their progress in s.

        Raises BatchRefusedError, and all that `drives.drive_in_batch` raises.
        """
        if not isinstance(self.factory, BatchFactory):
            raise BatchRefusedError("this simulation has no batch", do="give --exams bus")
        return drive_in_batch(self.factory, subject, runs, lambda done_s: tell(done_s / BATCH_GAIN))

    def drive_on_bus(self, subject: Subject, run: Run, tell: Progress) -> tuple[RunOutcome, ExamResult]:
        """Drive a run on the CAN loop; `tell` gets its progress in s. Raises all that `drives.drive_on_bus` raises."""
        return anyio.run(drive_on_bus, self.factory, subject, run, tell)


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockJob(DriveJob):
    """Runs that one process drives at once."""

    outcome = BlockOutcome
    runs: tuple[Run, ...]
    loop: DriveLoop

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"runs {self.runs[0].number} to {self.runs[-1].number}"

    @property
    def seed(self) -> int:
        """Number of the first run."""
        return self.runs[0].number

    @property
    def file(self) -> str:
        """Path of the result within the folder of results."""
        return f"results/runs-{self.runs[0].number}-{self.runs[-1].number}.json"

    @property
    def robot_time_s(self) -> float:
        """Simulated time on the CAN loop in s; that in a batch counts less."""
        in_batch = 0 if self.loop is DriveLoop.BUS else sum(not run.broken for run in self.runs)
        return self.task.exam.duration_s * (len(self.runs) - in_batch + in_batch / BATCH_GAIN)

    def run(self, tell: Progress) -> None:
        """Drive all runs and store their outcomes; those that leave the batch are driven on the CAN loop.

        `tell`: gets the progress in s. Raises KnowledgeError, BatchRefusedError, SettingsError, OSError.
        """
        subject = self.subject()
        driven: list[RunOutcome | None] = []
        working = [run for run in self.runs if not run.broken]
        if working and self.loop is DriveLoop.BATCH:
            driven = self.drive_in_batch(subject, working, tell)
        finished = {each.number: each for each in driven if each}
        left = [run for run in self.runs if run.number not in finished]
        finished |= {each.number: each for each in self._drive_all_on_bus(subject, left, tell)}
        outcomes = tuple(finished[run.number] for run in self.runs)
        on_bus = tuple(run.number for run in left)
        self.results.write(self, BlockOutcome(made_of=self.made_of, runs=outcomes, on_bus=on_bus))

    def _drive_all_on_bus(self, subject: Subject, runs: Sequence[Run], tell: Progress) -> list[RunOutcome]:
        progress = ProgressSum(tell)
        whole_s = self.task.exam.duration_s

        def report(done_s: float) -> None:
            progress.report(self.name, done_s, whole_s)

        return [self.drive_on_bus(subject, run, report)[0] for run in runs]


@dataclass(frozen=True, slots=True, kw_only=True)
class WitnessJob(DriveJob):
    """Run that is driven in a batch and on the CAN loop, which must agree."""

    outcome = WitnessOutcome
    witness: Run

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"run {self.witness.number} on the CAN loop"

    @property
    def seed(self) -> int:
        """Number of the run."""
        return self.witness.number

    @property
    def file(self) -> str:
        """Path of the result within the folder of results."""
        return f"results/witness-{self.witness.number}.json"

    @property
    def robot_time_s(self) -> float:
        """Simulated time on the CAN loop in s."""
        return self.task.exam.duration_s

    def run(self, tell: Progress) -> None:
        """Drive the run twice, compare, and store the outcome; `tell` gets the progress in s.

        Raises BatchDiffersError where the outcomes differ; else as `BlockJob.run`.
        """
        subject = self.subject()
        (in_batch,) = self.drive_in_batch(subject, [self.witness], lambda _: None)
        on_bus, _ = self.drive_on_bus(subject, self.witness, tell)
        if in_batch is not None:
            require_equal(in_batch, on_bus)
        outcome = WitnessOutcome(made_of=self.made_of, run=on_bus, compared=in_batch is not None)
        self.results.write(self, outcome)


def require_equal(batch: RunOutcome, bus: RunOutcome) -> None:
    """Check that a run in the batch had the outcome of the CAN loop. Raises BatchDiffersError."""
    if differing := batch.differing(bus):
        raise BatchDiffersError(
            f"the batch and the CAN loop differ in {', '.join(differing)}; all results of the batch are refused",
            where=f"run {bus.number} in world {bus.world}",
            do="report it, and give --exams bus and a new folder with --out",
        )
