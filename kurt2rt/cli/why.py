"""`kurt2rt why`."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from config.robot_plugins import plugin_task, robot_of_task
from config.settings import SettingsError
from hal.robot_settings import RobotSettings, load_robot
from kurt2rt.channel.security.pairing import ONLOOKER, open_device
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.options import RecordedRun, RobotAddress, RobotPort, RunsFolder, SettingsName, refuse_if, seconds_of
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.tables import console_of, say
from kurt2rt.cli.why_live import ask_why
from kurt2rt.core.perception.sensor_words import words_for
from kurt2rt.platform.text_table import print_whole
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.runs.explain.recorded import explain_run
from kurt2rt.runs.explain.terminal import render_timeline, render_why
from kurt2rt.runs.explain.timeline import Timeline, build_timeline, telling_moment
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.run_folder import find_run
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.run import Run, progress_reporter
from kurt2rt.service.settings import ServiceSettings, load_service

_FORMATS = (".png", ".svg", ".pdf")
"""Suffixes of kurt2rt.platform.save_figure, which cannot be imported here: matplotlib is an extra."""
_MOST_PARTS = 40
"""Parts of a run that are listed; if it has more, those in which it did not drive by itself."""
_TIME = "SECONDS|M:SS"


@dataclass(frozen=True, slots=True)
class _Options:
    run: RecordedRun = None
    at: Annotated[
        float | None,
        typer.Option(
            metavar=_TIME,
            parser=seconds_of,
            help="Explain the decision at this second of the run. Default: the last touch, else the last question, "
            "surprise or change of action.",
        ),
    ] = None
    from_s: Annotated[
        float | None, typer.Option("--from", metavar=_TIME, parser=seconds_of, help="Tell the run from this second.")
    ] = None
    to_s: Annotated[
        float | None, typer.Option("--to", metavar=_TIME, parser=seconds_of, help="Tell the run up to this second.")
    ] = None
    picture: Annotated[Path | None, typer.Option(help="Draw it, too: a file that ends with .png, .svg or .pdf.")] = None
    runs: RunsFolder = None
    live: Annotated[
        bool, typer.Option("--live", help="Ask a running robot what it decides now, and why, instead of a recording.")
    ] = False
    device: Annotated[
        str | None,
        typer.Option(help="With --live, ask as this paired device. Default: as an onlooker of this machine."),
    ] = None
    robot: RobotAddress = None
    port: RobotPort = None
    settings: SettingsName = "default"
    as_json: AsJson = False

    @property
    def is_of_a_part(self) -> bool:
        """Return whether the course of the run is asked for, or of a part of it."""
        return self.from_s is not None or self.to_s is not None

    def check(self) -> None:
        """Raise typer.BadParameter for options that exclude each other."""
        of_a_run, of_a_part = self.run is not None or self.at is not None, self.is_of_a_part
        of_a_robot = any(each is not None for each in (self.device, self.robot, self.port))
        picture = self.picture
        if picture is not None:
            formats = ", ".join(_FORMATS)
            refuse_if(
                picture.suffix not in _FORMATS, f"{picture.name}: give a file that ends with {formats}", "--picture"
            )
        refuse_if(self.at is not None and of_a_part, "give a moment, or a part of the run with --from and --to", "--at")
        from_s = self.from_s or 0.0
        refuse_if(self.to_s is not None and self.to_s <= from_s, f"is not after --from {from_s:g}", "--to")
        refuse_if(self.live and (of_a_run or of_a_part), "is of now; leave out run, --at, --from and --to", "--live")
        refuse_if(of_a_robot and not self.live, "are for a robot that runs; give --live", "--device, --robot, --port")


@takes_options(_Options)
def why(options: _Options) -> None:
    """Explain what the robot did, and why: in a run, or now.

    For one moment it shows which RLA won, by how much, and which came second. It
    shows who taught the RLA, when and instead of what, and how often it was used
    since. It shows what would have changed the decision, and what the guard made
    of it. If the robot stood, it shows why.

        kurt2rt why
        kurt2rt why --at 1:30 --picture why.png
        kurt2rt why --from 60 --to 90 --picture minute.png
        kurt2rt why 20261122T031005Z-wall_following --from 0
        kurt2rt why --live

    Without a time it picks the most telling moment, and says which. The run is
    replayed up to that moment, so the answer uses only what the robot knew then.
    """
    options.check()
    service = load_service(options.settings)
    if options.live:
        _show_live(service, options)
        return
    path, console = find_run(options.run, options.runs or Path(service.recordings)), console_of()
    recorded = read_run(path, partial=options.at is None)
    if options.at is None:
        timeline = _read_timeline(recorded, options)
        # A run with gaps cannot be replayed up to a moment.
        told_whole = options.is_of_a_part or options.as_json or recorded.trouble
        moment = None if told_whole else telling_moment(timeline)
        if moment is None:
            _show_timeline(console, recorded, timeline, options)
        else:
            what = f"Most telling at {moment.at_s:.2f} s: {moment.what}. --at picks another moment, --from 0 tells all."
            print_whole(console, what)
            _show_decision(console, read_run(path), moment.at_s, options)
    else:
        _show_decision(console, recorded, options.at, options)
    if recorded.trouble and not options.as_json:
        say(f"The recording: {recorded.trouble}.")


def _read_timeline(run: Run, options: _Options) -> Timeline:
    to_s = math.inf if options.to_s is None else options.to_s
    known = (lesson.event for lesson in run.lessons)
    with job_bars(transient=True) as report:
        entries = _counted(run.partial_entries(), progress_reporter(run, report))
        return build_timeline(entries, run.robot, from_s=options.from_s or 0.0, to_s=to_s, known=known)


def _show_timeline(console: Console, run: Run, timeline: Timeline, options: _Options) -> None:
    if options.as_json:
        numbers = {"from_s": timeline.from_s, "to_s": timeline.to_s, "ticks": timeline.ticks, "missed": timeline.missed}
        told = {**numbers, "stretches": timeline.stretches, "notes": timeline.notes, "trouble": run.trouble}
        print_json({"run": run.name, "task": run.head.task, **told, "picture": options.picture})
    else:
        print_whole(console, render_timeline(timeline, _of(run), _MOST_PARTS))
    if options.picture is not None:
        # Late import: matplotlib is an extra that a robot does not need.
        from kurt2rt.runs.explain.timeline_picture import draw_timeline

        draw_timeline(timeline, _of(run), options.picture)
        _say_where(options)


def _counted(entries: Iterator[TickEntry], on_entry: Callable[[TickEntry], None]) -> Iterator[TickEntry]:
    for entry in entries:
        on_entry(entry)
        yield entry


def _show_decision(console: Console, run: Run, at_s: float, options: _Options) -> None:
    with job_bars(transient=True) as report:
        explained = explain_run(run, at_s, lambda done_s: report("replaying", done_s, at_s))
    ends = f"the run ends at {explained.at_s:.2f} s; give a moment before that"
    refuse_if(explained.at_s < at_s - 1.0, ends, "--at")
    where = f"{_of(run)}, {explained.at_s:.2f} s (tick {explained.facts.tick})"
    if options.as_json:
        told = {
            "facts": explained.facts,
            "tips": explained.counterfactuals,
            "difference": None if explained.difference is None else str(explained.difference),
            "trouble": run.trouble,
        }
        print_json({"run": run.name, "at_s": explained.at_s, **told, "picture": options.picture})
    else:
        words = words_for(run.robot.infrared)
        print_whole(console, render_why(explained.facts, explained.counterfactuals, where, words))
    if explained.difference is not None and not options.as_json:
        say(
            f"This program decides otherwise than the one that was recorded: {explained.difference}. "
            "What stands above is what this one makes of it; kurt2rt replay tells more.",
            "yellow",
        )
    _draw(explained.facts, explained.counterfactuals, run.robot, where, options)


def _show_live(service: ServiceSettings, options: _Options) -> None:
    noted = open_device(service.pairings, options.device or ONLOOKER, service.port)
    device = replace(noted, host=options.robot or noted.host, port=options.port or noted.port)

    def robot_of(task: str) -> RobotSettings:
        noted, other = load_robot(service.robot), robot_of_task(plugin_task(task) or "")
        return noted if other in (None, noted.kind) else load_robot(other)

    facts, found, robot = ask_why(device, robot_of)
    where = f"now: {facts.task} on {facts.robot}, tick {facts.tick}"
    if options.as_json:
        print_json({"facts": facts, "tips": found, "picture": options.picture})
    else:
        print_whole(console_of(), render_why(facts, found, where, words_for(robot.infrared)))
    if options.picture is not None and not set(robot.infrared.names) <= set(facts.basic.names):
        raise SettingsError(
            "has other sensors than the robot that answers",
            where=robot.name,
            do="name its settings in runtime settings",
        )
    _draw(facts, found, robot, where, options)


def _draw(
    facts: DecisionFacts,
    found: tuple[SensorCounterfactual, ...],
    robot: RobotSettings,
    where: str,
    options: _Options,
) -> None:
    if options.picture is None:
        return
    # Late import: matplotlib is an extra that a robot does not need.
    from kurt2rt.runs.explain.picture import draw_why

    draw_why(facts, found, robot, where, options.picture)
    _say_where(options)


def _of(run: Run) -> str:
    head = run.head
    return f"{Path(run.name).name}: {head.task} on {head.robot}, begun {head.started_at[:19].replace('T', ' ')} UTC"


def _say_where(options: _Options) -> None:
    Console(highlight=False, quiet=options.as_json).print(f"picture  {options.picture}", markup=False, soft_wrap=True)
