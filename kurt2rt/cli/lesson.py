"""`kurt2rt lesson`."""

from pathlib import Path
from typing import Annotated

import anyio
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from hal.robot_settings import load_robot
from kurt2rt.cli.options import (
    ALL_PROCESSORS,
    Changes,
    Jobs,
    OutFolder,
    Plain,
    RobotName,
    Seed,
    TaskName,
    WireName,
    changes_of,
)
from kurt2rt.cli.progress import job_bars
from kurt2rt.experiments.curriculum import CurriculumResult, Report, run_lesson
from kurt2rt.experiments.fitting import require_course
from kurt2rt.experiments.report import render_curriculum, render_seeds
from kurt2rt.experiments.seeds import SeedJob, run_seeds
from kurt2rt.knowledge.set_aside import set_aside
from kurt2rt.tasks.settings import load_task


def lesson(
    task: TaskName = "wall_following",
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
    out: OutFolder = Path("results/lesson"),
    robot_settings: RobotName = "kurt2",
    wire: WireName = "none",
) -> None:
    """Teach the simulated robot with a scripted teacher, in simulated time.

    One lesson lasts as long as its task says (config/tasks), in robot time.
    Settings were searched on seeds 0 to 79 and worlds rooms-0 to rooms-59; results
    are reported on others:

        kurt2rt lesson --seeds 100-119
    """
    # Not at the top: the simulator is an extra, and `kurt2rt run` on the robot does without it.
    from kurt2rt.simulated import SimulatedStage

    settings = load_robot(robot_settings)
    taught = load_task(task, plain=plain, changes=changes_of(changes))
    stage = SimulatedStage(settings, wire)
    worlds = (taught.teaching.world, *(taught.exam.worlds if seeds is not None else ()))
    stage.require_worlds(*worlds)
    require_course(stage, taught, worlds)
    out.mkdir(parents=True, exist_ok=True)
    console = Console()
    if seeds is None:
        file = knowledge or out / f"{taught.name}-{seed}.knowledge"
        if knowledge is None:
            set_aside(file)

        async def run(report: Report) -> CurriculumResult:
            result, _ = await run_lesson(stage, settings, taught, file, seed=seed, report=report)
            return CurriculumResult(result, ())

        with job_bars() as report:
            result = anyio.run(run, report)
        console.print(render_curriculum(result, taught))
        console.print(f"knowledge  {file}", markup=False, highlight=False, soft_wrap=True)
        return
    if knowledge is not None:
        raise typer.BadParameter("each seed needs a file of its own: give --out instead", param_hint="--knowledge")
    work = []
    for each in parse_seeds(seeds):
        file = out / f"{taught.name}-{each}.knowledge"
        set_aside(file)
        work.append(SeedJob(stage, settings, taught, taught.exam.worlds, each, file))
    columns = (TextColumn("seeds"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bar = progress.add_task("seeds", total=len(work))
        results = run_seeds(work, jobs, lambda _seed: progress.advance(bar))
    console.print(render_seeds(results, taught))


def parse_seeds(text: str) -> list[int]:
    """Seeds of `100-119` or `1,5,7-9`. Raises typer.BadParameter."""
    seeds: list[int] = []
    try:
        for part in text.split(","):
            seeds.extend(_seeds_of(part))
    except ValueError as error:
        raise typer.BadParameter(f"{text!r} is no list of seeds; give e.g. 100-119 or 1,5,7-9") from error
    if len(set(seeds)) != len(seeds):
        raise typer.BadParameter(f"{text!r} names a seed twice; give e.g. 100-119 or 1,5,7-9")
    return seeds


def _seeds_of(part: str) -> range:
    first, _, last = part.partition("-")
    seeds = range(int(first), int(last or first) + 1)
    if not seeds:
        raise ValueError(f"{part} ends before it begins")
    return seeds
