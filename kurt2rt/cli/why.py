"""`kurt2rt why`."""

import math
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from hal.robot_plugins import plugin_task, robot_of_task
from hal.robot_settings import RobotSettings, load_robot
from hal.settings import SettingsError
from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, ONLOOKER, Device, local_pairing, read_device
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.recorded_run import RecordedRun, RunsFolder, RuntimeSettingsName
from kurt2rt.cli.tables import console_of
from kurt2rt.cli.why_live import ask_why
from kurt2rt.core.perception.sensor_words import words_for
from kurt2rt.platform.text_table import print_whole
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.runs.explain.recorded import ExplainedMoment, explain_run
from kurt2rt.runs.explain.terminal import render_timeline, render_why
from kurt2rt.runs.explain.timeline import build_timeline
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.run_folder import find_run
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.run import Run
from kurt2rt.service.settings import ServiceSettings, load_service

_FORMATS = (".png", ".svg", ".pdf")
"""Suffixes of kurt2rt.runs.explain.save_figure, which cannot be imported here: matplotlib is an extra."""
_STRETCHES = 40
_REPORT_EVERY = 1000
_DONE = TextColumn("{task.completed:.0f} s of the run")


_At = Annotated[
    float | None, typer.Option(metavar="SECONDS", min=0.0, help="Explain the decision at this second of the run.")
]
_From = Annotated[
    float, typer.Option("--from", metavar="SECONDS", min=0.0, help="Without --at: the run from this second.")
]
_To = Annotated[float | None, typer.Option("--to", metavar="SECONDS", min=0.0, help="Without --at: up to this second.")]
_Picture = Annotated[Path | None, typer.Option(help="Draw it, too: a file that ends with .png, .svg or .pdf.")]
_Limit = Annotated[
    int,
    typer.Option(
        metavar="N",
        min=1,
        help="Most parts of a run to list; if it has more, those in which it did not drive by itself.",
    ),
]
_Live = Annotated[
    bool, typer.Option("--live", help="Ask a running robot what it decides now, and why, instead of a recording.")
]
_Device = Annotated[
    str | None,
    typer.Option(help="With --live, ask as this paired device. Default: as an onlooker of this machine."),
]
_Robot = Annotated[
    str | None, typer.Option(help="With --live, address of the robot. Default: as noted with the pairing.")
]
_Port = Annotated[
    int | None,
    typer.Option(
        metavar="PORT", min=1, max=65535, help="With --live, UDP port of the robot. Default: as noted with the pairing."
    ),
]


def why(
    run: RecordedRun = None,
    at: _At = None,
    from_s: _From = 0.0,
    to_s: _To = None,
    picture: _Picture = None,
    runs: RunsFolder = None,
    limit: _Limit = _STRETCHES,
    live: _Live = False,
    device: _Device = None,
    robot: _Robot = None,
    port: _Port = None,
    settings: RuntimeSettingsName = "default",
    as_json: AsJson = False,
) -> None:
    """Explain what the robot did, and why: in a run, or now.

    For one moment it shows which RLA won, by how much, and which came second. It
    shows who taught the RLA, when and instead of what, and how often it was used
    since. It shows what would have changed the decision, and what the guard made
    of it. If the robot stood, it shows why.

        kurt2rt why --at 12.34 --picture why.png
        kurt2rt why --from 60 --to 90 --picture minute.png
        kurt2rt why 20261122T031005Z-wall_following
        kurt2rt why --live

    The run is replayed up to that moment, so the answer uses only what the robot
    knew then.
    """
    _require_picture(picture)
    _require_times(at, from_s, to_s)
    service = load_service(settings)
    if live:
        if run is not None or at is not None or from_s or to_s is not None:
            raise typer.BadParameter("is of now; leave out run, --at, --from and --to", param_hint="--live")
        _show_live(service, device, robot, port, picture, as_json=as_json)
        return
    if device is not None or robot is not None or port is not None:
        raise typer.BadParameter("are for a robot that runs; give --live", param_hint="--device, --robot, --port")
    found = find_run(run, runs or Path(service.recordings))
    recorded = read_run(found, partial=at is None)
    console = console_of()
    if at is None:
        _show_timeline(console, recorded, from_s, math.inf if to_s is None else to_s, limit, picture, as_json=as_json)
    else:
        _show_decision(console, recorded, at, picture, as_json=as_json)
    if recorded.trouble and not as_json:
        console.print(f"The recording: {recorded.trouble}.", markup=False, highlight=False, soft_wrap=True)


def _require_times(at_s: float | None, from_s: float, to_s: float | None) -> None:
    if at_s is not None and (from_s or to_s is not None):
        raise typer.BadParameter("give a moment, or a part of the run with --from and --to", param_hint="--at")
    if to_s is not None and to_s <= from_s:
        raise typer.BadParameter(f"{to_s:g} is not after --from {from_s:g}", param_hint="--to")


def _require_picture(picture: Path | None) -> None:
    if picture is not None and picture.suffix not in _FORMATS:
        raise typer.BadParameter(
            f"{picture.name}: give a file that ends with {', '.join(_FORMATS)}", param_hint="--picture"
        )


def _show_timeline(
    console: Console, run: Run, from_s: float, to_s: float, limit: int, picture: Path | None, *, as_json: bool
) -> None:
    known = (lesson.event for lesson in run.lessons)
    with Progress(TextColumn("reading"), _DONE, console=Console(stderr=True), transient=True) as progress:
        bar = progress.add_task("", total=None)
        entries = _counted(run.partial_entries(), lambda read_s: progress.update(bar, completed=read_s))
        timeline = build_timeline(entries, run.robot, from_s=from_s, to_s=to_s, known=known)
    if as_json:
        numbers = {"from_s": timeline.from_s, "to_s": timeline.to_s, "ticks": timeline.ticks, "missed": timeline.missed}
        told = {**numbers, "stretches": timeline.stretches, "notes": timeline.notes, "trouble": run.trouble}
        print_json({"run": run.name, "task": run.head.task, **told, "picture": picture})
    else:
        print_whole(console, render_timeline(timeline, _of(run), limit))
    if picture is not None:
        # Late import: matplotlib is an extra that a robot does not need.
        from kurt2rt.runs.explain.timeline_picture import draw_timeline

        draw_timeline(timeline, _of(run), picture)
        _say_where(picture, as_json=as_json)


def _counted(entries: Iterable[TickEntry], report: Callable[[float], None]) -> Iterator[TickEntry]:
    """Yield the entries and report the seconds of the run that were read."""
    began_s = None
    for entry in entries:
        began_s = entry.now_s if began_s is None else began_s
        if entry.tick % _REPORT_EVERY == 0:
            report(entry.now_s - began_s)
        yield entry


def _show_decision(console: Console, run: Run, at_s: float, picture: Path | None, *, as_json: bool) -> None:
    explained = _explain(run, at_s)
    if explained.at_s < at_s - 1.0:
        raise typer.BadParameter(
            f"the run ends at {explained.at_s:.2f} s; give a moment before that", param_hint="--at"
        )
    where = f"{_of(run)}, {explained.at_s:.2f} s (tick {explained.facts.tick})"
    if as_json:
        difference = None if explained.difference is None else str(explained.difference)
        told = {
            "facts": explained.facts,
            "tips": explained.counterfactuals,
            "difference": difference,
            "trouble": run.trouble,
        }
        print_json({"run": run.name, "at_s": explained.at_s, **told, "picture": picture})
    else:
        print_whole(
            console, render_why(explained.facts, explained.counterfactuals, where, words_for(run.robot.infrared))
        )
    if explained.difference is not None and not as_json:
        console.print(
            f"This program decides otherwise than the one that was recorded: {explained.difference}. "
            "What stands above is what this one makes of it; kurt2rt replay tells more.",
            markup=False,
            highlight=False,
            soft_wrap=True,
            style="yellow",
        )
    if picture is not None:
        _draw(explained.facts, explained.counterfactuals, run.robot, where, picture, as_json=as_json)


def _show_live(
    service: ServiceSettings,
    name: str | None,
    host: str | None,
    port: int | None,
    picture: Path | None,
    *,
    as_json: bool,
) -> None:
    device = _device(service, name or ONLOOKER)

    def robot_of(task: str) -> RobotSettings:
        noted, other = load_robot(service.robot), robot_of_task(plugin_task(task) or "")
        return noted if other in (None, noted.kind) else load_robot(other)

    facts, found, robot = ask_why(device, host or device.host, port or device.port, robot_of)
    where = f"now: {facts.task} on {facts.robot}, tick {facts.tick}"
    if as_json:
        print_json({"facts": facts, "tips": found, "picture": picture})
    else:
        print_whole(console_of(), render_why(facts, found, where, words_for(robot.infrared)))
    if picture is not None:
        if not set(robot.infrared.names) <= set(facts.basic.names):
            raise SettingsError(
                "has other sensors than the robot that answers",
                where=robot.name,
                do="name its settings in runtime settings",
            )
        _draw(facts, found, robot, where, picture, as_json=as_json)


def _device(service: ServiceSettings, name: str) -> Device:
    if name in OF_THIS_MACHINE:
        return local_pairing(Path(service.teachers), Path(service.devices), name, port=service.port).device
    return read_device(Path(service.devices) / name)


def _draw(
    facts: DecisionFacts,
    found: tuple[SensorCounterfactual, ...],
    robot: RobotSettings,
    where: str,
    picture: Path,
    *,
    as_json: bool,
) -> None:
    # Late import: matplotlib is an extra that a robot does not need.
    from kurt2rt.runs.explain.picture import draw_why

    draw_why(facts, found, robot, where, picture)
    _say_where(picture, as_json=as_json)


def _explain(run: Run, at_s: float) -> ExplainedMoment:
    columns = (TextColumn("replaying"), BarColumn(), TextColumn("{task.completed:.0f} of {task.total:.0f} s"))
    with Progress(*columns, TimeElapsedColumn(), console=Console(stderr=True), transient=True) as progress:
        bar = progress.add_task("", total=at_s)
        return explain_run(run, at_s, lambda done_s: progress.update(bar, completed=done_s))


def _of(run: Run) -> str:
    head = run.head
    return f"{Path(run.name).name}: {head.task} on {head.robot}, begun {head.started_at[:19].replace('T', ' ')} UTC"


def _say_where(picture: Path, *, as_json: bool) -> None:
    Console(highlight=False, quiet=as_json).print(f"picture  {picture}", markup=False, soft_wrap=True)
