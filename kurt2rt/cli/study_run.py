"""Options, run and end of a study, with one meaning in all of its commands."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hal.robot_settings import RobotSettings
from kurt2rt.cli.json_output import AsJson
from kurt2rt.cli.options import (
    ALL_PROCESSORS,
    DEFAULT_TEACHER,
    Changes,
    Jobs,
    RobotName,
    Teacher,
    changes_of,
    task_option,
)
from kurt2rt.cli.progress import OneBar, one_bar
from kurt2rt.cli.tables import print_told, say
from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.core.task_settings import TaskSettings, taught_by_named
from kurt2rt.experiments.study.jobs import JobParts, Results
from kurt2rt.experiments.study.pool import Executor, Waves, missing_time_s, open_processes, run_missing
from kurt2rt.experiments.study.study_plan import AboutT, EngineRequest, StudyPlan, require_no_difference
from kurt2rt.experiments.study.table import Told
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

    def requested_engine(self) -> EngineRequest:
        """Return the engine, which is the CAN bus if auto finds no compiler; warn if a batch is not compiled."""
        # Not at the top: the simulator is an extra, and every command is loaded where --help is said.
        from simbridge.batch.compiled import IS_COMPILED

        if self.engine is EngineRequest.COMPILED:
            say_if_interpreted()
        return EngineRequest.CAN if self.engine is EngineRequest.AUTO and not IS_COMPILED else self.engine


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskOptions(EngineOptions):
    """Options of studies in which a scripted teacher teaches one task."""

    task: Annotated[str, task_option("Default: wall_following.")] = "wall_following"
    teacher: Teacher = DEFAULT_TEACHER
    changes: Changes = None
    robot_settings: RobotName = None

    def load(self) -> tuple[TaskSettings, RobotSettings]:
        """Return the task with its teacher, and the robot. Raises SettingsError."""
        task, robot = load_task_and_robot(self.task, self.robot_settings, changes=changes_of(self.changes))
        return taught_by_named(task, self.teacher), robot


def job_parts(robot: RobotSettings, folder: Path) -> JobParts:
    """Return the simulation, the robot and the results that all jobs of a study share; `folder`: of the results."""
    return JobParts(factory=simulations_of(robot), robot=robot, results=Results(folder))


def say_if_interpreted() -> None:
    """Say on standard error that numba is missing, if it is, and what that means."""
    from simbridge.batch.compiled import IS_COMPILED

    if not IS_COMPILED:
        say("numba is not installed (extra fast): the batch runs as plain Python, as slow as the bus", stderr=True)


def open_executor(cluster: Path | None, jobs: int) -> AbstractContextManager[Executor]:
    """Return a context with the executor of --cluster; without it, of one with so many processes of this machine.

    Raises ClusterError if `cluster` is no file of a cluster, or no scheduler of it answers.
    """
    if cluster is None:
        return open_processes(jobs)
    # Not at the top: Dask is an extra, and takes a second.
    from kurt2rt.experiments.study.cluster import open_cluster

    return open_cluster(cluster)


@dataclass(frozen=True, slots=True)
class RunningStudy:
    """Study whose jobs are done, as its results are told: further jobs can be run in the same folder."""

    bar: OneBar
    executor: Executor
    results: Results

    def run(self, waves: Waves) -> None:
        """Run further jobs that have no result, with a bar of their own."""
        if missing_s := missing_time_s(waves, self.results):
            self.bar.begin_next(missing_s)
        run_missing(waves, self.results, self.executor, self.bar.update)


@contextmanager
def hold_study(results: Results, source: str, options: JobOptions, waves: Waves = ()) -> Iterator[Executor]:
    """Hold the folder of a study, and yield the executor of its jobs; at Ctrl-C say what goes on with the command.

    `source`: hash of the program's source. `options`: of the command. `waves`: its jobs, if they are known before.

    Raises:
        StudyError: another run writes to the folder.
        BatchDiffersError: a witness in the folder differs from the batch.
        ClusterError: --cluster is no file of a cluster, or no scheduler of it answers.
    """
    import scipy.special  # noqa: F401 # of the extra `studies`: told before the jobs, not hours after them

    try:
        with open_executor(options.cluster, options.jobs) as executor, results.held():
            require_no_difference(results, [source])
            yield executor
    except BaseException as error:
        group = error if isinstance(error, BaseExceptionGroup) else BaseExceptionGroup("", [error])
        if group.subgroup(KeyboardInterrupt) is not None:
            jobs, left = sum(map(len, waves)), sum(len(results.missing(wave)) for wave in waves)
            done = f" after {jobs - left} of {jobs} jobs" if jobs else ""
            say(f"kurt2rt: interrupted{done}; the same command goes on from there ({results.folder})", stderr=True)
        raise


def run_study(plan: StudyPlan[AboutT], options: JobOptions, tell: Callable[[RunningStudy], Told]) -> None:
    """Run the jobs of a study that have no result, and print what `tell` returns, which gets the study.

    Raises the errors of `hold_study` and of all jobs, and StudyError if the folder has results of other settings.
    """
    results = plan.results
    with hold_study(results, plan.jobs[0].made_of.source, options, plan.waves) as executor:
        missing_s = missing_time_s(plan.waves, results)
        batch = sum(job.engines.in_batch for job in plan.jobs)
        jobs, witnesses = f"{batch} job{'' if batch == 1 else 's'}", len(plan.witnesses)
        in_batch = [f"the study has {jobs} in the batch, {witnesses} of them on the CAN bus too"] if batch else []
        for line in (*plan.refusals, *in_batch) if missing_s else ():
            say(line, stderr=True)
        with one_bar(missing_s) as bar:
            run_missing(plan.waves, results, executor, bar.update)
            bar.say("tables and figures")
            told = tell(RunningStudy(bar, executor, results))
    print_told(told, as_json=options.as_json)
