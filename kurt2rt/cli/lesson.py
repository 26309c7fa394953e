"""`kurt2rt lesson`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import anyio
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from hal.robot_settings import RobotSettings, load_robot
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.lesson_errands import ERRANDS, errands, runs_errands
from kurt2rt.cli.lesson_route import (
    ROUTES,
    RouteOptions,
    many_routes,
    one_route,
    require_no_route_options,
    teaches_route,
)
from kurt2rt.cli.options import (
    ALL_PROCESSORS,
    Changes,
    Jobs,
    Plain,
    RobotName,
    Seed,
    WireName,
    changes_of,
    task_option,
)
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.tables import console_of
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, Report, run_lesson
from kurt2rt.experiments.lockstep.report import curriculum_as_data, render_curriculum, render_seeds
from kurt2rt.experiments.study.seeds import SeedJob, run_seeds
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.knowledge.files.task_of_file import task_of_file
from kurt2rt.platform.text_table import print_whole

if TYPE_CHECKING:
    from simbridge.simulation import Kurt2SimulationFactory

_TASK = "wall_following"
_FOLDER = Path("results/lesson")
_MOST_SEEDS = 100_000
_OLDER_SPELLING = typer.Argument(hidden=True, metavar=" ", help="The task, as --task names it.")


def lesson(
    task_word: Annotated[str | None, _OLDER_SPELLING] = None,
    task: Annotated[str | None, task_option(f"Default: the task of the file in --knowledge, else {_TASK}.")] = None,
    plain: Plain = False,
    changes: Changes = None,
    seed: Seed = 1,
    knowledge: Annotated[
        Path | None,
        typer.Option(help="Knowledge file to teach into; goes on from what it holds. Default: a new one in --out."),
    ] = None,
    seeds: Annotated[
        str | None,
        typer.Option(
            help="Teach and examine many robots, one per seed, e.g. 100-119; prints medians, quartiles and intervals."
        ),
    ] = None,
    jobs: Jobs = ALL_PROCESSORS,
    out: Annotated[
        Path | None,
        typer.Option(
            help=f"Folder for what is made; created when absent. Default: {_FOLDER}, of routes {ROUTES}, of errands "
            f"{ERRANDS}.",
            show_default=False,
        ),
    ] = None,
    robot_settings: RobotName = "kurt2",
    wire: WireName = "none",
    decisions: Annotated[
        list[int] | None,
        typer.Option(
            help="Of a route: how many junctions its loop has; with --seeds repeat for several. Default: the task's."
        ),
    ] = None,
    basic: Annotated[
        Path | None,
        typer.Option(
            help="Of a route, or errands: knowledge of the streets, or a folder with one file per seed, as kurt2rt "
            "lesson --task streets leaves them. Without it the streets are taught first."
        ),
    ] = None,
    controls: Annotated[
        bool,
        typer.Option(
            "--controls", help="Of routes, with --seeds, and of errands: also go about it in other ways, to compare."
        ),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Teach the simulated robot with a scripted teacher, in simulated time.

    One lesson lasts as long as its task says (config/tasks), in robot time.
    Settings were searched on seeds 0 to 79 and worlds rooms-0 to rooms-59;
    results are reported on others:

        kurt2rt lesson --task streets --seeds 100-119

    The task route teaches the mid level a fixed route through the streets, a
    closed loop that the robot's seed draws, and then lets it drive without a
    teacher. With --seeds results are kept in --out with hashes of what made
    them; a run that was interrupted goes on where it was:

        kurt2rt lesson --task route
        kurt2rt lesson --task route --seeds 0-9 --decisions 8 --decisions 12

    The task errands leads the robot about the town and names places, and then
    sends it to them by ways that it was never led as a whole; kept in --out
    likewise:

        kurt2rt lesson --task errands --seeds 0-9 --controls
    """
    # Not at the top: the simulator is an extra, and `kurt2rt run` on the robot does without it.
    from simbridge.simulation import Kurt2SimulationFactory

    name = _one_of(task, task_word)
    if knowledge is not None and knowledge.exists():
        name = task_of_file(knowledge, name)
    name = name or _TASK
    settings = load_robot(robot_settings)
    taught = load_task(name, plain=plain, changes=changes_of(changes))
    stage = Kurt2SimulationFactory(settings, wire)
    if seeds is not None and knowledge is not None:
        raise typer.BadParameter("each seed needs a file of its own: give --out instead", param_hint="--knowledge")
    options = RouteOptions(tuple(decisions or ()), basic, controls)
    if runs_errands(taught):
        if decisions or knowledge is not None:
            raise typer.BadParameter("errands take neither --decisions nor --knowledge; leave them out")
        errands(
            stage,
            settings,
            taught,
            seeds=[seed] if seeds is None else parse_seeds(seeds),
            basic=basic,
            controls=controls,
            jobs=jobs,
            out=out or ERRANDS,
            as_json=as_json,
        )
    elif not teaches_route(taught):
        require_no_route_options(taught, options)
        _lesson(
            stage,
            settings,
            taught,
            seed=seed,
            knowledge=knowledge,
            seeds=seeds,
            jobs=jobs,
            out=out or _FOLDER,
            as_json=as_json,
        )
    elif seeds is None:
        one_route(stage, settings, taught, options, seed=seed, knowledge=knowledge, out=out or ROUTES, as_json=as_json)
    else:
        command = _command(name, seeds, options, plain=plain, changes=changes or [])
        many_routes(
            stage,
            settings,
            taught,
            options,
            seeds=parse_seeds(seeds),
            jobs=jobs,
            out=out or ROUTES,
            command=command,
            as_json=as_json,
        )


def _lesson(
    stage: "Kurt2SimulationFactory",
    settings: RobotSettings,
    task: TaskSettings,
    *,
    seed: int,
    knowledge: Path | None,
    seeds: str | None,
    jobs: int,
    out: Path,
    as_json: bool,
) -> None:
    worlds = (task.teaching.world, *(task.exam.worlds if seeds is not None else ()))
    stage.require_worlds(*worlds)
    require_course(stage, task, worlds)
    out.mkdir(parents=True, exist_ok=True)
    if seeds is None:
        file = knowledge or out / f"{task.name}-{seed}.knowledge"
        if knowledge is None:
            archive_existing(file)

        async def run(report: Report) -> CurriculumResult:
            result, _ = await run_lesson(stage, settings, task, file, seed=seed, report=report)
            return CurriculumResult(result, ())

        with job_bars() as report:
            result = anyio.run(run, report)
        if as_json:
            print_json({**curriculum_as_data(result, task), "knowledge": file})
        else:
            print_whole(console_of(), render_curriculum(result, task), f"knowledge  {file}")
        return
    work = []
    for each in parse_seeds(seeds):
        file = out / f"{task.name}-{each}.knowledge"
        archive_existing(file)
        work.append(SeedJob(stage, settings, task, task.exam.worlds, each, file))
    columns = (TextColumn("seeds"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bar = progress.add_task("seeds", total=len(work))
        results = run_seeds(work, jobs, lambda _seed: progress.advance(bar))
    if as_json:
        print_json({"task": task.name, "robots": [curriculum_as_data(each, task) for each in results]})
    else:
        print_whole(console_of(), render_seeds(results, task))


def _one_of(task: str | None, task_word: str | None) -> str | None:
    """Return the task, which may be given in two ways. Raises typer.BadParameter if they differ."""
    if task_word is not None and task not in (None, task_word):
        raise typer.BadParameter(f"{task!r} or {task_word!r}? Say it once", param_hint="--task")
    return task or task_word


def _command(name: str, seeds: str, options: RouteOptions, *, plain: bool, changes: list[str]) -> str:
    """What was typed as far as it decides the numbers; no paths of this machine."""
    words = [f"kurt2rt lesson --task {Path(name).name}", *(["--plain"] if plain else []), f"--seeds {seeds}"]
    words += [f"--decisions {each}" for each in options.decisions]
    words += ["--basic FOLDER"] if options.basic is not None else []
    words += ["--controls"] if options.controls else []
    return " ".join([*words, *(f"--set {each}" for each in changes)])


def parse_seeds(text: str) -> list[int]:
    """Seeds of `100-119` or `1,5,7-9`. Raises typer.BadParameter."""
    seeds: list[int] = []
    try:
        for part in text.split(","):
            seeds.extend(_seeds_of(part))
    except ValueError as error:
        raise typer.BadParameter(f"{text!r} is no list of seeds; give e.g. 100-119 or 1,5,7-9") from error
    if len(seeds) > _MOST_SEEDS:
        raise typer.BadParameter(f"{text!r} names too many seeds, allowed are {_MOST_SEEDS} at most")
    if len(set(seeds)) != len(seeds):
        raise typer.BadParameter(f"{text!r} names a seed twice; give e.g. 100-119 or 1,5,7-9")
    return seeds


def _seeds_of(part: str) -> range:
    first, _, last = part.partition("-")
    seeds = range(int(first), int(last or first) + 1)
    if not seeds:
        raise ValueError(f"{part} ends before it begins")
    return seeds[: _MOST_SEEDS + 1]
