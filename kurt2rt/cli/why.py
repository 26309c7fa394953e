"""`kurt2rt why`."""

import math
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from kurt2rt.cli.printed import console_of
from kurt2rt.explain.from_run import Explained, explain_run
from kurt2rt.explain.render import render_timeline, render_why
from kurt2rt.explain.timeline import timeline_of
from kurt2rt.recording.run_folder import find_run
from kurt2rt.replay.reading import read_run
from kurt2rt.replay.run import Run
from kurt2rt.service_settings import load_service

_WIDE = 130
_FORMATS = (".png", ".svg", ".pdf")
"""As kurt2rt.explain.saving has them, which draws in matplotlib, an extra."""
_STRETCHES = 40


def why(
    run: Annotated[
        Path | None,
        typer.Argument(help="A recorded run: its folder, a file in it, or its name in --runs. Default: the newest."),
    ] = None,
    at: Annotated[float | None, typer.Option(min=0.0, help="Explain the decision at this second of the run.")] = None,
    from_s: Annotated[float, typer.Option("--from", min=0.0, help="Without --at: the run from this second.")] = 0.0,
    to_s: Annotated[float | None, typer.Option("--to", min=0.0, help="Without --at: up to this second.")] = None,
    picture: Annotated[
        Path | None, typer.Option(help="Draw it, too: a file that ends with .png, .svg or .pdf.")
    ] = None,
    runs: Annotated[Path | None, typer.Option(help="Folder of recorded runs. Default: as the settings say.")] = None,
    limit: Annotated[
        int, typer.Option(min=1, help="Of a run with more stretches show those in which it did not drive by itself.")
    ] = _STRETCHES,
    settings: Annotated[
        str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
    ] = "default",
) -> None:
    """Explain what the robot did, and why: of one moment of a run, or a run as a whole.

    Of one moment: which RLA won and by how much, which was behind it, which
    features mattered, who taught it when and instead of what, how often it was
    used since, what would have changed the decision, and what the guard made of
    it; and where the robot stood, why.

        kurt2rt why --at 12.34 --picture why.png
        kurt2rt why --from 60 --to 90 --picture minute.png
        kurt2rt why 20261122T031005Z-wall_following

    The run is replayed up to that moment, so what is told is what the robot
    knew then.
    """
    _require_picture(picture)
    if at is not None and (from_s or to_s is not None):
        raise typer.BadParameter("give a moment, or a part of the run with --from and --to", param_hint="--at")
    if to_s is not None and to_s <= from_s:
        raise typer.BadParameter(f"{to_s:g} is not behind --from {from_s:g}", param_hint="--to")
    found = find_run(run, runs or Path(load_service(settings).recordings))
    recorded = read_run(found)
    console = console_of(_WIDE)
    if at is None:
        _show_timeline(console, recorded, from_s, math.inf if to_s is None else to_s, limit, picture)
    else:
        _show_decision(console, recorded, at, picture)
    if recorded.trouble:
        console.print(f"The recording: {recorded.trouble}.", markup=False, highlight=False, soft_wrap=True)


def _require_picture(picture: Path | None) -> None:
    if picture is not None and picture.suffix not in _FORMATS:
        raise typer.BadParameter(
            f"{picture.name}: give a file that ends with {', '.join(_FORMATS)}", param_hint="--picture"
        )


def _show_timeline(console: Console, run: Run, from_s: float, to_s: float, limit: int, picture: Path | None) -> None:
    known = (lesson.event for lesson in run.lessons)
    timeline = timeline_of(run.entries(), run.robot, from_s=from_s, to_s=to_s, known=known)
    console.print(render_timeline(timeline, _of(run), limit))
    if picture is not None:
        # Not at the top: matplotlib is an extra, and a robot does without it.
        from kurt2rt.explain.timeline_picture import draw_timeline

        draw_timeline(timeline, _of(run), picture)
        _say_where(picture)


def _show_decision(console: Console, run: Run, at_s: float, picture: Path | None) -> None:
    explained = _explain(run, at_s)
    if explained.at_s < at_s - 1.0:
        raise typer.BadParameter(
            f"the run ends at {explained.at_s:.2f} s; give a moment before that", param_hint="--at"
        )
    where = f"{_of(run)}, {explained.at_s:.2f} s (tick {explained.facts.tick})"
    console.print(render_why(explained.facts, explained.tips, where))
    if explained.difference is not None:
        console.print(
            f"This program decides otherwise than the one that was recorded: {explained.difference}. "
            "What stands above is what this one makes of it; kurt2rt replay tells more.",
            markup=False,
            highlight=False,
            soft_wrap=True,
            style="yellow",
        )
    if picture is not None:
        from kurt2rt.explain.picture import draw_why

        draw_why(explained.facts, explained.tips, run.robot, where, picture)
        _say_where(picture)


def _explain(run: Run, at_s: float) -> Explained:
    columns = (TextColumn("replaying"), BarColumn(), TextColumn("{task.completed:.0f} of {task.total:.0f} s"))
    with Progress(*columns, TimeElapsedColumn(), console=Console(stderr=True), transient=True) as progress:
        bar = progress.add_task("", total=at_s)
        return explain_run(run, at_s, lambda done_s: progress.update(bar, completed=done_s))


def _of(run: Run) -> str:
    head = run.head
    return f"{Path(run.name).name}: {head.task} on {head.robot}, begun {head.started_at[:19].replace('T', ' ')} UTC"


def _say_where(picture: Path) -> None:
    Console(highlight=False).print(f"picture  {picture}", markup=False, soft_wrap=True)
