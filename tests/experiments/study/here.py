"""Jobs of tests: they run in this process."""

from collections.abc import Callable
from pathlib import Path

from kurt2rt.experiments.study.jobs import JobParts, Results
from kurt2rt.experiments.study.pool import JobProcesses, PoolProgress, run_missing
from kurt2rt.experiments.study.study_plan import AboutT, StudyPlan
from tests.experiments.helpers import ROBOT, STAGE

HERE = JobProcesses(1)
"""It starts no process, so there is nothing to end."""


def parts_in(folder: Path = Path("never-made")) -> JobParts:
    """Return what the jobs of a study share, with results in a folder."""
    return JobParts(factory=STAGE, robot=ROBOT, results=Results(folder))


def carry_out(
    plan: StudyPlan[AboutT], folder: Path, on_progress: Callable[[PoolProgress], None] = lambda _: None
) -> StudyPlan[AboutT]:
    """Run the jobs of a plan that are missing in a folder, and return the plan."""
    results = Results(folder)
    with results.held():
        run_missing(plan.waves, results, HERE, on_progress)
        assert results.missing(plan.jobs) == []
    return plan
