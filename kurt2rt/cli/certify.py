"""`kurt2rt study certify`."""

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from hal.robot_settings import RobotSettings, load_robot_of
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.json_output import print_json
from kurt2rt.cli.options import Changes, RobotName, TaskOfTheFile, changes_of, results_option
from kurt2rt.cli.study_run import JobOptions, job_parts, say_if_interpreted, study_run
from kurt2rt.cli.tables import console_of
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.batch_mind import require_known_exams
from kurt2rt.experiments.lockstep.drive_row import PLACES, DriveRow
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.knowledge.files.task_of_file import task_of_file
from kurt2rt.platform.text_table import print_whole
from simbridge.contracts.batch import BatchRefusedError

_FOLDER = Path("results/certify")
_SECONDS = "exam.duration_s"
_LEFT_OUT = {"verdict", "unit", "progress", "least_progress", "action_changes_per_s", "findings", "teacher", *PLACES}
"""Fields of a run that a certificate does not measure."""
_GENERATED = {"wall_following": ("rooms-SEED",)}
"""Generated worlds of a task without --world, besides those of its exam."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options(JobOptions):
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
        typer.Option(
            metavar="NAME|PATH",
            help="World to drive in; repeat for several: each run draws one of them. SEED in the name stands for the "
            "run's number: rooms-SEED is another room for each run. Default: those of the task's exam, and rooms-SEED "
            "for wall_following.",
            show_default=False,
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
        int, typer.Option(min=0, max=100, metavar="N", help="Number of worst runs to draw, at most.")
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
    out: Annotated[Path, results_option(str(_FOLDER))] = _FOLDER
    robot_settings: RobotName = None


@takes_options(_Options)
def certify(options: _Options) -> None:
    """Certify knowledge: estimate the probability of a collision, of getting stuck and of a question.

    Each run is a drive of another simulated robot without a teacher. The run's
    number is its seed: sensors, noise, wheel slip, start and world follow from
    it. Prints probabilities and rates with their 95 % intervals, and writes
    report.html with pictures of the worst runs.

    Any run can be repeated on the simulated CAN bus, by its seed.

    For example:

        kurt2rt study certify results/demo/wall_following-1.knowledge
        kurt2rt study certify mine.knowledge --runs 10000 --world rooms-SEED
        kurt2rt exam mine.knowledge --seed 20017 --world rooms-20017

    Results are kept in --out, so an interrupted run goes on where it was. Tasks
    that the batch does not know, such as routes, are driven on the CAN bus.
    """
    # Not at the top: the simulator and drawing are extras, and every command is loaded where --help is said.
    from kurt2rt.experiments.certify.study import (
        BrokenShare,
        Extent,
        make_plan,
        picture_jobs,
        read_certificate,
        read_pictures,
    )
    from kurt2rt.experiments.certify.tables import all_tables, draw_worst, summarise, worst_runs, write_certificate
    from kurt2rt.experiments.study.table import as_rich

    task = _task(options)
    robot = load_robot_of(options.robot_settings, options.task or task_of_file(options.knowledge))
    places = tuple(dict.fromkeys(options.world or (*task.exam.worlds, *_GENERATED.get(task.name, ()))))
    parts = job_parts(robot, options.out)
    engine = _engine(options, task, robot)
    shares = BrokenShare(options.dead_sensors, robot.infrared.names)
    extent = Extent(options.first, options.runs, places, engine, shares)
    plan, command = make_plan(task, options.knowledge, extent, parts), _command(options, engine)
    report = options.out / "report.html"
    with study_run(plan, parts, options) as study:
        certificate = read_certificate(plan)
        worst = worst_runs(certificate.drives, options.pictures)
        broken = {run.number: run.broken for run in plan.about.runs}
        commands = [_exam_command(options, each, broken[each.seed]) for each in worst]
        again = picture_jobs(plan, worst)
        study.say("all runs")
        study.run([again])
        study.say("figures and report")
        pictures = list(draw_worst(read_pictures(again, worst), commands, parts["factory"], options.out))
        tables = list(all_tables(certificate, worst))
        write_certificate(certificate, tables, pictures, command, report)
    if not options.as_json:
        to_copy = [Text(each, no_wrap=True) for each in commands]
        print_whole(console_of(), *map(as_rich, tables), *to_copy, f"report  {report}")
        return
    print_json(
        {
            "knowledge": options.knowledge,
            "task": task.name,
            "seconds": task.exam.duration_s,
            "places": list(summarise(certificate)),
            "compared": certificate.compared,
            "worst": [
                {**each.model_dump(exclude=_LEFT_OUT), "broken": broken[each.seed], "command": word}
                for each, word in zip(worst, commands, strict=True)
            ],
            "report": report,
        }
    )


def _task(options: _Options) -> TaskSettings:
    """Return the task of the knowledge with the changes of the options.

    Raises KnowledgeError, SettingsError, and typer.BadParameter for a task above the basic level.
    """
    changes = changes_of(options.changes)
    if options.seconds is not None:
        changes = {**changes, _SECONDS: f"{options.seconds:g}"}
    task = load_task(task_of_file(options.knowledge, options.task), changes=changes)
    if task.mid is not None:
        raise typer.BadParameter(
            f"task {task.name} has a mid level, whose routes and places are no worlds to draw from; use kurt2rt train "
            "--seeds",
            param_hint="KNOWLEDGE",
        )
    return task


def _engine(options: _Options, task: TaskSettings, robot: RobotSettings) -> Engine:
    """Return the engine that drives the runs, and say why if it is slow."""
    if options.engine is Engine.CAN:
        return Engine.CAN
    try:
        require_known_exams(robot, task, policy=False)
    except BatchRefusedError as refusal:
        typer.echo(f"{refusal}: all runs are driven there, some 100 times slower", err=True)
        return Engine.CAN
    say_if_interpreted()
    return Engine.COMPILED


def _exam_command(options: _Options, run: DriveRow, broken: str) -> str:
    """Return the command that drives a run again; `broken`: its broken sensor, empty for none."""
    words = ["kurt2rt", "exam", str(options.knowledge), "--seed", str(run.seed), "--world", run.world]
    words += ["--broken-sensor", broken] if broken else []
    changes = [*(options.changes or ()), *([f"{_SECONDS}={options.seconds:g}"] if options.seconds is not None else [])]
    words += [word for change in changes for word in ("--set", change)]
    words += ["--task", options.task] if options.task is not None else []
    words += ["--robot-settings", options.robot_settings] if options.robot_settings is not None else []
    return shlex.join(words)


def _command(options: _Options, engine: Engine) -> str:
    """Return the command as far as it decides the jobs, which are other ones on the CAN bus."""
    stated_engine = engine if engine is Engine.CAN else None
    stated = {"runs": options.runs, "first": options.first, "engine": stated_engine, "pictures": None}
    return typed_command("study certify", options, stated)
