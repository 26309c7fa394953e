"""Runs of a certificate that are driven again on the CAN loop, for pictures."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from kurt2rt.experiments.certify.jobs import BlockJob, require_equal
from kurt2rt.experiments.certify.outcome import RunOutcome
from kurt2rt.experiments.certify.plan import CertifyPlan
from kurt2rt.experiments.certify.run import Run
from kurt2rt.experiments.lockstep.exam import ExamResult
from kurt2rt.experiments.study.pool import PoolProgress, Progress, run_jobs


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureJob:
    """Run of a block that the CAN loop drives again for its trail."""

    block: BlockJob
    expected: RunOutcome
    """Outcome of the same run before."""
    again: Run

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"picture of run {self.again.number}"

    @property
    def robot_time_s(self) -> float:
        """Simulated time in s."""
        return self.block.task.exam.duration_s

    def run(self, tell: Progress) -> ExamResult:
        """Drive and return the result; `tell` gets the progress in s.

        Raises BatchDiffersError where the outcome is another one than before; else as `BlockJob.run`.
        """
        outcome, exam = self.block.drive_on_bus(self.block.subject(), self.again, tell)
        require_equal(self.expected, outcome)
        return exam


def drive_again(
    plan: CertifyPlan, runs: Sequence[RunOutcome], processes: int, on_progress: Callable[[PoolProgress], None]
) -> list[ExamResult]:
    """Drive runs of the plan on the CAN loop and return their results, with trails, in order.

    Args:
        plan: of the certificate.
        runs: outcomes of the runs.
        processes: number of processes.
        on_progress: called with the progress of all runs.

    Raises:
        BatchDiffersError: the outcome of a run is another one than before.
        JobKilledError: a process was killed.
    """
    by_number = {run.number: (block, run) for block in plan.blocks for run in block.runs}
    jobs = []
    for each in runs:
        block, run = by_number[each.number]
        jobs.append(PictureJob(block=block, expected=each, again=run))
    return run_jobs(jobs, processes, on_progress=on_progress)
