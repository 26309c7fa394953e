"""Options, run and end of a study, with one meaning in all of its commands."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from hal.robot_settings import RobotSettings
from kurt2rt.cli.json_output import AsJson
from kurt2rt.cli.options import ALL_PROCESSORS, Jobs
from kurt2rt.cli.progress import OneBar, one_bar
from kurt2rt.experiments.study.bus_witness import require_no_difference
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.runner import Executor, Waves, missing_time_s, open_processes, run_missing
from kurt2rt.experiments.study.study_plan import AboutT, EngineChoice, EngineRequest, RequestedEngine, StudyPlan
from simbridge.contracts.robot_kind import simulations_of

Cluster = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Run the jobs on the workers of the cluster of this file (kurt2rt study worker --new makes one).",
        show_default=False,
    ),
]
EngineOption = Annotated[
    EngineRequest,
    typer.Option(
        help="What drives lessons (of phases 1 and 2) and exams. compiled: a batch of robots at once, with equal "
        "results (extra fast). As a check, 1 % of the robots, at least three, run on the CAN bus too and must agree. "
        "can: the simulated CAN bus, also for tasks that compiled does not know. auto: compiled if it is installed and "
        "the study is long."
    ),
]


@dataclass(frozen=True, slots=True, kw_only=True)
class JobOptions:
    """Options of all studies: the machines that run the jobs, and the form of the results."""

    jobs: Jobs = ALL_PROCESSORS
    cluster: Cluster = None
    as_json: AsJson = False


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineOptions(JobOptions):
    """Options of studies whose lessons and exams a compiled engine may drive, which changes no result."""

    engine: EngineOption = EngineRequest.AUTO

    def requested_engine(self) -> RequestedEngine:
        """Return the request; say on standard error that an explicit compiled engine is not compiled."""
        # Not at the top: the simulator is an extra, and every command is loaded where --help is said.
        from simbridge.batch.compiled import IS_COMPILED

        if self.engine is EngineRequest.COMPILED:
            say_if_interpreted()
        return RequestedEngine(self.engine, compiled=IS_COMPILED)


def job_parts(robot: RobotSettings, folder: Path) -> JobParts:
    """Return the simulation, the robot and the results that all jobs of a study share; `folder`: of the results."""
    return JobParts(factory=simulations_of(robot), robot=robot, results=Results(folder))


def say_if_interpreted() -> None:
    """Say on standard error that numba is missing, if it is, and what that means."""
    from simbridge.batch.compiled import IS_COMPILED

    if not IS_COMPILED:
        typer.echo("numba is not installed (extra fast): the batch runs as plain Python, as slow as the bus", err=True)


def _say_choice(choice: EngineChoice) -> None:
    """Say on standard error how many jobs a batch drives, how many have a witness, and what the batch does not know."""
    for refusal in choice.refusals:
        typer.echo(refusal, err=True)
    if choice.engines:
        jobs = f"{len(choice.engines)} job{'' if len(choice.engines) == 1 else 's'}"
        typer.echo(f"the study has {jobs} in the batch, {len(choice.witnessed)} of them on the CAN bus too", err=True)


@contextmanager
def open_executor(cluster: Path | None, jobs: int) -> Iterator[Executor]:
    """Yield the executor of --cluster; without it, one with processes of this machine.

    `jobs`: number of these processes. Raises ClusterError if `cluster` is no file of a cluster, or no scheduler of it
    answers.
    """
    if cluster is None:
        with open_processes(jobs) as local:
            yield local
        return
    # Not at the top: Dask is an extra, and takes a second.
    from kurt2rt.experiments.study.cluster import open_cluster

    with open_cluster(cluster) as executor:
        yield executor


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


@dataclass(frozen=True, slots=True)
class RunningStudy:
    """Study whose jobs are done, and whose folder is held while tables and figures are made."""

    bar: OneBar
    executor: Executor
    results: Results

    def say(self, what: str) -> None:
        """Show what is done after the jobs."""
        self.bar.say(what)

    def run(self, waves: Waves) -> None:
        """Run further jobs that have no result, with a bar of their own."""
        if missing_s := missing_time_s(waves, self.results):
            self.bar.begin_next(missing_s)
        run_missing(waves, self.results, self.executor, self.bar.update)


@contextmanager
def study_run(plan: StudyPlan[AboutT], parts: JobParts, options: JobOptions) -> Iterator[RunningStudy]:
    """Run the jobs of a study that have no result; the context holds the folder while tables and figures are made.

    Args:
        plan: of the study.
        parts: with the folder of its results.
        options: of the command.

    Raises:
        StudyError: another run writes to the folder, or it has results of other settings.
        BatchDiffersError: a witness in the folder, or of this run, differs from the batch.
        ClusterError: --cluster is no file of a cluster, or no scheduler of it answers.
    """
    import scipy.special  # noqa: F401 # of the extra `studies`: told before the jobs, not hours after them

    results = parts["results"]
    with says_how_to_go_on(results), open_executor(options.cluster, options.jobs) as executor, results.held():
        require_no_difference(results, {job.made_of.source for job in plan.jobs})
        missing_s = missing_time_s(plan.waves, results)
        if missing_s:
            _say_choice(plan.choice)
        with one_bar(missing_s) as bar:
            run_missing(plan.waves, results, executor, bar.update)
            yield RunningStudy(bar, executor, results)
