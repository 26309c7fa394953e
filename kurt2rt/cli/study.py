"""`kurt2rt study ...`: measurements of many robots."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import anyio
import typer

from hal.robot_settings import RobotSettings, load_robot, load_robot_of
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import (
    DEFAULT_TEACHER,
    Changes,
    RobotName,
    SearchName,
    TaskOfTheFile,
    Teacher,
    changes_of,
    parse_seeds,
    refuse_if,
    results_option,
    task_option,
)
from kurt2rt.cli.progress import one_bar
from kurt2rt.cli.study_paper import paper, phases
from kurt2rt.cli.study_run import (
    EngineOptions,
    JobOptions,
    RunningStudy,
    TaskOptions,
    hold_study,
    job_parts,
    run_study,
    say_if_interpreted,
)
from kurt2rt.cli.tables import print_told
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.core.task_robot import load_task_and_robot, require_robot_of
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.doubt.drive import DoubtResponse
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.study.table import Told
from kurt2rt.knowledge.files.task_of_file import task_of_file

# Studies are imported in their commands: simulator and drawing are extras, and all commands are loaded for --help.

_Taught = Annotated[Path, typer.Argument(help="Folder with knowledge files, as kurt2rt train --seeds leaves them.")]
_SECONDS = "exam.duration_s"

study = typer.Typer(
    help="Measure many robots: the paper, phases, new worlds, doubt.\n\n"
    "Compare learners, certify knowledge, search settings.",
    no_args_is_help=True,
)


def _no_default(told: str, **more: Any) -> Any:
    return typer.Option(help=told, show_default=False, **more)


def _seeds(default: str) -> str:
    return f"Robots by their seeds, e.g. {default}."


@dataclass(frozen=True, slots=True, kw_only=True)
class _Transfer(TaskOptions):
    seeds: Annotated[str, typer.Option(help=_seeds("1100-1119"))] = "1100-1119"
    world: Annotated[
        list[str] | None,
        _no_default(
            "New world, as in other commands; SEED in the name stands for the robot's seed. Repeat for several: "
            "each robot is taught in each of them separately. Default: rooms-SEED, for streets streets-SEED."
        ),
    ] = None
    checkpoint: Annotated[
        list[int] | None,
        _no_default(
            "Examine the robot after this number of presses in the new world; repeat for several. Default: 0, 2, "
            "5, 10, 15, 20.",
            min=0,
        ),
    ] = None
    seconds: Annotated[
        float | None,
        _no_default(
            "Longest time of teaching in the new world. Default: that of the lesson at home.",
            metavar="SECONDS",
            min=1.0,
        ),
    ] = None
    out: Annotated[Path, results_option("results/transfer")] = Path("results/transfer")


@takes_options(_Transfer)
def transfer(options: _Transfer) -> None:
    """Measure how many presses a robot that was taught at home needs to be right in a new world.

    Each robot is taught in the world of its task (home). Then the same teacher
    goes on in a new world, and answers and corrects as at home. After 0, 2, 5,
    10, 15 and 20 presses the robot is examined there without its teacher. It is
    examined at home once it is right in the new world, and at the end. The
    policy's own drive from the same start is the measure. The result is a curve:
    the share of robots that are right, by presses.

    For example, other rooms for each robot; and other streets:

        kurt2rt study transfer
        kurt2rt study transfer --task streets --teacher superhuman

    Results are kept in --out, so an interrupted run goes on where it was.
    """
    from kurt2rt.experiments.transfer import AFTER, Transfer, make_plan, tell

    task, robot = options.load()
    places = options.world or ["streets-SEED" if task.name == "streets" else "rooms-SEED"]
    after = tuple(sorted(set(options.checkpoint or AFTER)))
    about = Transfer(task, tuple(places), after, options.seconds)
    parts, engine = job_parts(robot, options.out), options.requested_engine()
    plan = make_plan(about, parse_seeds(options.seeds), parts, engine=engine)
    command = typed_command("study transfer", options, {"task": options.task, "seeds": options.seeds})
    run_study(plan, options, lambda _: tell(plan, command))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Compare(EngineOptions):
    learner: Annotated[
        list[str] | None,
        _no_default(
            "Learner: a name, or module:Name of your own, also from this folder. GATE is the threshold from which"
            " it asks. Repeat for several. Default: 1-nn, k-nn, weighted-vote, svm, tree.",
            metavar="NAME[=GATE]",
        ),
    ] = None
    task: Annotated[list[str] | None, task_option("Repeat for several. Default: wall_following.")] = None
    teacher: Teacher = DEFAULT_TEACHER
    seeds: Annotated[str, typer.Option(help=_seeds("4106-4125"))] = "4106-4125"
    checkpoint: Annotated[
        list[int] | None,
        _no_default(
            "Examine the robot after this number of presses, and at the end of its lesson; repeat for several. "
            "Default: 10, 20, 40.",
            min=1,
        ),
    ] = None
    changes: Changes = None
    out: Annotated[Path, results_option("results/compare")] = Path("results/compare")
    robot_settings: RobotName = None


@takes_options(_Compare)
def compare(options: _Compare) -> None:
    """Compare learners of other kinds with the RLA system, taught by the same teacher.

    The same robots are taught with each learner, through the same teacher, guard
    and sensors. They are examined without the teacher after 10, 20 and 40
    presses and at the end. The tables show the robots that pass, the teacher's
    effort, and collisions during the lesson. Each row is compared with the RLA
    system, robot by robot.

    For example, all learners of the project; one with another gate in two
    tasks; your own:

        kurt2rt study compare
        kurt2rt study compare --learner k-nn=0.8 --task fleeing --task eight
        kurt2rt study compare --learner mine:Mine

    Results are kept in --out, so an interrupted run goes on where it was.
    docs/extend.md says how to write a learner.
    """
    from kurt2rt.experiments.compare import PUPILS, Pupil, make_plan, tell

    names = dict.fromkeys(options.task or ("wall_following",))
    robot = load_robot_of(options.robot_settings, next(iter(names)))
    tasks = [taught_by_named(load_task(name, changes=changes_of(options.changes)), options.teacher) for name in names]
    for name, task in zip(names, tasks, strict=True):
        require_robot_of(task, name, robot)
    pupils, after = [Pupil.parse(name) for name in options.learner or PUPILS], options.checkpoint or (10, 20, 40)
    parts, engine = job_parts(robot, options.out), options.requested_engine()
    plan = make_plan(tasks, pupils, parse_seeds(options.seeds), sorted(set(after)), parts, engine=engine)
    command = typed_command("study compare", options, {"seeds": options.seeds})
    run_study(plan, options, lambda _: tell(plan, command))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Doubt(JobOptions):
    taught: _Taught
    task: Annotated[str, task_option("Default: wall_following.")] = "wall_following"
    seeds: Annotated[str, typer.Option(help=_seeds("0-4"))] = "0-4"
    world: Annotated[
        list[str] | None, typer.Option(help="World to drive in; repeat for several. Default: those of the exam.")
    ] = None
    seconds: Annotated[float, typer.Option(metavar="SECONDS", min=1.0, help="Seconds of each drive.")] = 200.0
    response: Annotated[
        list[DoubtResponse] | None,
        typer.Option(help="Response of the robots to doubt; repeat for several. Default: all."),
    ] = None
    reposition_after: Annotated[
        float,
        typer.Option(
            metavar="SECONDS", min=0.0, help="Move a robot that stands for this time to another start; 0: never."
        ),
    ] = 10.0
    out: Annotated[Path, results_option("results/doubt")] = Path("results/doubt")
    robot_settings: RobotName = None


@takes_options(_Doubt)
def doubt(options: _Doubt) -> None:
    """Measure how well doubt predicts wrong actions and collisions; the control is distance alone.

    Each robot drives without a teacher in each world twice: it only reports
    doubt, and doubt stops it. SEED in the name of a world stands for the robot's
    seed.

    For example:

        kurt2rt train --task wall_following --seeds 915-919
        kurt2rt study doubt results/train --seeds 915-919 --world floors-SEED
        kurt2rt study doubt results/train --seeds 915-919 --world floors-SEED --response stands --reposition-after 0

    Results are kept in --out, so an interrupted run goes on where it was.
    """
    from kurt2rt.experiments.doubt.study import DoubtDrives, make_plan, tell

    task, robot = load_task_and_robot(options.task, options.robot_settings)
    worlds, responses = tuple(options.world or task.exam.worlds), tuple(options.response or DoubtResponse)
    about = DoubtDrives(task, worlds, responses, options.seconds, options.reposition_after)
    plan = make_plan(about, parse_seeds(options.seeds), options.taught, job_parts(robot, options.out))
    command = typed_command("study doubt", options, {"task": options.task, "seeds": options.seeds})
    run_study(plan, options, lambda _: tell(plan, command))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Certify(JobOptions):
    knowledge: Annotated[Path, typer.Argument(help="Knowledge file, as kurt2rt train or kurt2rt run leaves it.")]
    runs: Annotated[
        int, typer.Option(min=1, max=1_000_000, metavar="N", help="Number of runs; each is another robot.")
    ] = 1000
    seconds: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS", min=1.0, max=100_000.0, help="Length of a run. Default: that of the task's exam."
        ),
    ] = None
    world: Annotated[
        list[str] | None,
        _no_default(
            "World to drive in; repeat for several: each run draws one of them. SEED in the name stands for the "
            "run's number: rooms-SEED is another room for each run. Default: those of the task's exam, and "
            "rooms-SEED for wall_following.",
            metavar="NAME|PATH",
        ),
    ] = None
    first: Annotated[
        int,
        typer.Option(
            "--first-seed", min=0, metavar="N", help="Seed of the first run; each further run has the next one."
        ),
    ] = 20_000
    dead_sensors: Annotated[
        float,
        typer.Option(
            metavar="SHARE",
            min=0.0,
            max=1.0,
            help="Fraction of the runs, 0 to 1, in which one range sensor breaks after 2 s. Sensor and fault (dead, "
            "stuck, unplugged and others) are drawn. These runs have a row of their own, on the CAN bus alone.",
        ),
    ] = 0.0
    pictures: Annotated[
        int, typer.Option(min=0, max=100, metavar="N", help="Number of runs to draw, the worst first.")
    ] = 6
    engine: Annotated[
        Engine,
        typer.Option(
            help="What drives the runs. compiled: a batch of runs at once, with equal results. As a check, 1 % of "
            "them, at least three, run on the CAN bus too. can: the CAN bus alone, about 100 times slower."
        ),
    ] = Engine.COMPILED
    task: TaskOfTheFile = None
    changes: Changes = None
    out: Annotated[Path, results_option("results/certify")] = Path("results/certify")
    robot_settings: RobotName = None

    def load(self) -> tuple[TaskSettings, RobotSettings]:
        changes = changes_of(self.changes) | ({} if self.seconds is None else {_SECONDS: f"{self.seconds:g}"})
        task = load_task(task_of_file(self.knowledge, self.task), changes=changes)
        refuse_if(
            task.mid is not None,
            f"task {task.name} has a mid level, whose routes and places are no worlds to draw from; use kurt2rt train "
            "--seeds",
            "KNOWLEDGE",
        )
        return task, load_robot_of(self.robot_settings, self.task or task_of_file(self.knowledge))

    @property
    def words(self) -> list[str]:
        """Words by which `kurt2rt exam` drives a run again, besides its seed and world."""
        changes = [*(self.changes or ()), *([] if self.seconds is None else [f"{_SECONDS}={self.seconds:g}"])]
        named = {"--task": self.task, "--robot-settings": self.robot_settings}
        options = [*(("--set", change) for change in changes), *((k, v) for k, v in named.items() if v is not None)]
        return [word for option in options for word in option]


@takes_options(_Certify)
def certify(options: _Certify) -> None:
    """Certify knowledge: estimate the probability of a collision, of getting stuck and of a question.

    Each run is a drive of another simulated robot without a teacher. The run's
    number is its seed: sensors, noise, wheel slip, start and world follow from
    it. Prints probabilities, and writes report.html with their 95 % intervals,
    rates, and pictures of the worst runs.

    Any run can be repeated on the simulated CAN bus, by its seed.

    For example:

        kurt2rt study certify results/demo/wall_following-1.knowledge
        kurt2rt study certify mine.knowledge --runs 10000 --world rooms-SEED
        kurt2rt exam mine.knowledge --seed 20017 --world rooms-20017

    Results are kept in --out, so an interrupted run goes on where it was. Tasks
    that the batch does not know, such as routes, are driven on the CAN bus.
    """
    from kurt2rt.experiments.certify import Extent, make_plan, picture_jobs, read_drives, tell, worst_of

    task, robot = options.load()
    if options.engine is Engine.COMPILED:
        say_if_interpreted()
    generated = ("rooms-SEED",) if task.name == "wall_following" else ()
    places = tuple(dict.fromkeys(options.world or (*task.exam.worlds, *generated)))
    extent = Extent(options.first, options.runs, places, options.engine, options.dead_sensors)
    plan = make_plan(task, options.knowledge, extent, job_parts(robot, options.out))
    engine = plan.about.extent.engine
    stated_engine = engine if engine is Engine.CAN else None  # the jobs are other ones there
    stated = {"runs": options.runs, "first": options.first, "engine": stated_engine, "pictures": None}
    command = typed_command("study certify", options, stated)

    def finish(study: RunningStudy) -> Told:
        again = picture_jobs(plan, worst_of(read_drives(plan), options.pictures))
        study.run([again])
        return tell(plan, again, options.words, command)

    run_study(plan, options, finish)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Search(JobOptions):
    search: SearchName
    trials: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Number of trials. Default: that of the file.", show_default=False),
    ] = None
    changes: Changes = None
    out: Annotated[Path | None, results_option("results/search/ and the search's name")] = None


@takes_options(_Search)
def search(options: _Search) -> None:
    """Search settings of a task on search seeds, and check the best once on other seeds and worlds.

    A file of config/searches names the keys and their ranges. It also names the
    teacher, and robots and worlds of search and check. Each trial teaches robots
    one after the other and examines them. It ends early if it cannot beat the
    median of the earlier trials. A better trial passes more exams, or as many
    with fewer presses.

    The best trials are then compared once with the shipped settings, robot by
    robot. Search seeds are 0 to 999 and 3000 to 3999; those of a check are
    others. Writes found.yaml (changed keys and their origin) and report.html to
    the output folder. --set changes all trials and the shipped settings.

    An interrupted search goes on where it was. The same file, number of trials
    and versions give the same trials, with any number of processes.

    For example:

        kurt2rt study search wall_following
        kurt2rt study search circle --trials 20 --jobs 2
    """
    from kurt2rt.experiments.search.plan import make_plan
    from kurt2rt.experiments.search.settings import load_search
    from kurt2rt.experiments.search.tables import tell
    from kurt2rt.experiments.search.trials import check_time_s, require_unchecked, run_check, run_trials, trials_time_s

    settings = load_search(options.search)
    trials = options.trials or settings.trials
    parts = job_parts(load_robot(), options.out or Path("results/search") / settings.name)
    plan = make_plan(settings, parts, changes=changes_of(options.changes))
    require_unchecked(plan, trials)
    if settings.engine is Engine.COMPILED:
        say_if_interpreted()
    trials_s = trials_time_s(plan, trials)
    held = hold_study(parts["results"], plan.made_of.source, options)
    with held as executor, one_bar(trials_s + check_time_s(plan)) as bar:
        made = run_trials(plan, trials, executor, bar.update)
        check = run_check(plan, made, trials, executor, bar.after(trials_s))
        bar.say("tables and figures")
        told = tell(plan, made, check, typed_command("study search", options))
    print_told(told, as_json=options.as_json)


@dataclass(frozen=True, slots=True)
class _Worker:
    cluster: Annotated[Path | None, typer.Option(metavar="FILE", help="Work for the cluster of this file.")] = None
    new: Annotated[Path | None, typer.Option(metavar="FILE", help="Make the file of a new cluster, and end.")] = None
    scheduler: Annotated[
        str, typer.Option(metavar="ADDRESS", help="With --new, address of its scheduler, such as tls://lab:8786.")
    ] = ""


@takes_options(_Worker)
def worker(options: _Worker) -> None:
    """Run jobs of studies that another machine sends, one at a time, until Ctrl-C.

    Start one for each processor. Jobs are Python programs, so the members of a
    cluster know each other by a file with its key: copy it to each machine, and
    keep it to yourself. `kurt2rt study worker --new` makes it, and says how to
    start the scheduler of Dask that passes the jobs on.

    For example:

        kurt2rt study worker --new lab.cluster --scheduler tls://lab:8786
        kurt2rt study worker --cluster lab.cluster
        kurt2rt study paper --cluster lab.cluster
    """
    if options.new is not None and options.cluster is None:
        from kurt2rt.experiments.study.cluster import make_cluster_file, scheduler_command

        make_cluster_file(options.new, options.scheduler)
        typer.echo(f"cluster  {options.new}: copy it to each machine, and keep it to yourself")
        typer.echo(f"scheduler  {scheduler_command(options.new, options.scheduler)}")
    elif options.cluster is not None and options.new is None:
        from kurt2rt.experiments.study.cluster import serve

        anyio.run(serve, options.cluster, lambda address: typer.echo(f"worker  {address}"))
    else:
        raise typer.BadParameter("give the file of a cluster, or make one", param_hint="--cluster, --new")


for _command in (paper, phases, transfer, compare, doubt, certify, search, worker):
    study.command()(_command)
