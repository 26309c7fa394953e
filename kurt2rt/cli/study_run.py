"""Run of a study with its record, its executor and its progress bar, as all commands of studies do it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console

from kurt2rt.cli.executor_option import open_executor
from kurt2rt.cli.loop_options import say_choice
from kurt2rt.cli.progress import OneBar, one_bar
from kurt2rt.experiments.study.bus_witness import require_no_difference
from kurt2rt.experiments.study.loop_choice import NO_CHOICE, LoopChoice
from kurt2rt.experiments.study.plan import StudyPlan, missing_time_s, run_missing
from kurt2rt.experiments.study.results import Results


@contextmanager
def says_how_to_go_on(results: Results) -> Iterator[None]:
    """Say at Ctrl-C that finished jobs are kept."""
    try:
        yield
    except BaseException as error:
        group = error if isinstance(error, BaseExceptionGroup) else BaseExceptionGroup("", [error])
        if group.subgroup(KeyboardInterrupt) is not None:
            say = Console(stderr=True, highlight=False).print
            say(
                f"kurt2rt: stopped; finished jobs are in {results.folder}, those that ran begin again. "
                "The same command goes on from there",
                markup=False,
                soft_wrap=True,
            )
        raise


@contextmanager
def study_run(
    plan: StudyPlan,
    results: Results,
    jobs: int,
    on: Path | None,
    *,
    choice: LoopChoice = NO_CHOICE,
) -> Iterator[OneBar]:
    """Run the jobs of a study that have no result; the context holds the folder while tables and figures are made.

    Args:
        plan: of the study.
        results: folder of its results.
        jobs: number of processes.
        on: value of --on.
        choice: loops of the plan's jobs, which is said if any job is run.

    Yields:
        The progress bar.

    Raises:
        StudyError: another run writes to the folder, or it has results of other settings.
        BatchDiffersError: a witness in the folder, or of this run, differs from the batch.
        ClusterError: `on` is no file of a cluster, or no scheduler of it answers.
    """
    import scipy.special  # noqa: F401 # of the extra `studies`: told before the jobs, not hours after them

    with says_how_to_go_on(results), open_executor(on, jobs) as executor, results.held():
        require_no_difference(results, {job.made_of.source for wave in plan.waves for job in wave})
        missing_s = missing_time_s(plan, results)
        if missing_s:
            say_choice(choice)
        with one_bar(missing_s) as bar:
            run_missing(plan, results, executor, bar.update)
            yield bar
