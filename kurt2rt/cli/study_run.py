"""Run of a study with its record, its executor and its progress bar, as all commands of studies do it."""

from collections.abc import Iterator
from contextlib import contextmanager

from kurt2rt.cli.executor_option import open_executor
from kurt2rt.cli.progress import OneBar, one_bar
from kurt2rt.experiments.study.plan import StudyPlan, missing_time_s, run_missing
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.study_record import record_study


@contextmanager
def study_run(
    plan: StudyPlan, results: Results, command: str, jobs: int, on: str | None, *, part: StudyPlan | None = None
) -> Iterator[OneBar]:
    """Run the jobs of a study that have no result; the context holds the folder while tables and figures are made.

    Args:
        plan: of the whole study, which is recorded in the folder.
        command: typed words that decide the numbers.
        jobs: number of processes.
        on: value of --on.
        part: jobs to run; None: all of the plan.

    Yields:
        The progress bar.

    Raises:
        StudyError: another run writes to the folder, or it has results of other settings.
        ClusterError: no scheduler answers, or its address is not safe.
    """
    own = plan if part is None else part
    with open_executor(on, jobs) as executor, results.held(), one_bar(missing_time_s(own, results)) as bar:
        record_study(results.folder, plan, command)
        run_missing(own, results, jobs, bar.update, executor)
        yield bar
