"""`kurt2rt recording ...`: recorded runs, listed, repaired, and written for other programs."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.options import RecordedRun, RunsFolder, SettingsName
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.tables import console_of, say
from kurt2rt.platform.text_table import TextTable, print_whole
from kurt2rt.runs.recording.recording import LAYOUT
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_folder import find_run, runs_in, segments_in
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.service.settings import load_service

recording = typer.Typer(help="List recorded runs, repair or export them.", no_args_is_help=True)


@recording.command("list")
def list_(runs: RunsFolder = None, as_json: AsJson = False, settings: SettingsName = "default") -> None:
    """List the recorded runs, the newest last: task, robot, length and size.

    For example:

        kurt2rt recording list
        kurt2rt recording list --runs results/runs --json
    """
    folder = runs or Path(load_service(settings).recordings)
    rows = [_row(each) for each in runs_in(folder)]
    if as_json:
        print_json({"folder": folder, "runs": rows})
        return
    table = TextTable()
    for heading in ("run", "task", "robot", "seconds", "MB", "note"):
        table.add_column(heading, number=heading in ("seconds", "MB"), whole=heading == "run")
    for row in rows:
        table.add_row(*(f"{each:.1f}" if isinstance(each, float) else each for each in row.values()))
    print_whole(console_of(), table if rows else f"{folder}: holds no recorded run")


def _row(folder: Path) -> dict[str, str | float]:
    """Return what the list tells of a run; of one that cannot be read, its size and the reason."""
    size_mb = sum(each.stat().st_size for each in segments_in(folder)) / 1e6
    try:
        run = read_run(folder, partial=True)
        task, robot, seconds, note = run.head.task, run.head.robot, run.duration_s, run.trouble
    except RecordingError as error:
        task, robot, seconds, note = "", "", 0.0, str(error)
    return {"run": folder.name, "task": task, "robot": robot, "seconds": seconds, "mb": size_mb, "note": note}


@recording.command()
def repair(
    run: RecordedRun = None,
    out: Annotated[Path, typer.Option(help="Folder for the copies; made if it is missing.")] = Path("results/repaired"),
    runs: RunsFolder = None,
    settings: SettingsName = "default",
) -> None:
    """Copy what is whole of a run to files for Foxglove.

    A file lacks its index after a power cut, and while the robot still records.
    kurt2rt replay and why read it anyway; a viewer such as Foxglove refuses it.
    The run itself stays as it is. Import the layout that this prints into
    Foxglove once.

        kurt2rt recording repair
        kurt2rt recording repair 20261122T031005Z-wall_following --out copies
    """
    # Late import: mcap is in the extra `recording`, and this module is imported without it.
    from kurt2rt.runs.recording.recover import NothingRecoverableError, recover_segment

    found = find_run(run, runs or Path(load_service(settings).recordings))
    out.mkdir(parents=True, exist_ok=True)
    segments = [found] if found.is_file() else segments_in(found)
    for segment in segments:
        try:
            truncated = recover_segment(segment, out / segment.name)
        except NothingRecoverableError as error:
            if len(segments) == 1:
                raise
            say(f"{error}; not copied")
            continue
        say(truncated or f"{segment} is whole")
        say(f"copied to {out / segment.name}")
    say(f"layout for Foxglove: {LAYOUT}")


@recording.command()
def export(
    run: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Recorded runs: their folders, files in them, or their names in --runs. Default: the newest."
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the data set; nothing may be there yet.")] = Path(
        "results/lerobot"
    ),
    fps: Annotated[
        int, typer.Option(metavar="N", help="Frames a second, a divisor of the robot's ticks a second.")
    ] = 100,
    runs: RunsFolder = None,
    as_json: AsJson = False,
    settings: SettingsName = "default",
) -> None:
    """Write recorded runs as a data set for LeRobot (LeRobotDataset v3.0), an episode for each run or 1 000 s of it.

    A frame holds wheel speeds (observation.state), sensor readings
    (observation.environment_state) and the decided speeds (action). It also
    holds the teacher's rewards (next.reward), and whether a teacher drove.
    docs/python.md explains each column.

        kurt2rt recording export
        kurt2rt recording export var/runs/*-wall_following --fps 20
    """
    # Late import: pyarrow is in the extra `export`, and this module is imported without it.
    from kurt2rt.runs.export.lerobot import export_lerobot

    folder = runs or Path(load_service(settings).recordings)
    named = [find_run(each, folder) for each in run] if run else [find_run(None, folder)]
    found = [read_run(each, partial=True) for each in dict.fromkeys(named)]
    with job_bars() as report:
        exported = export_lerobot(found, out, fps, report)
    if as_json:
        print_json({"folder": out, "fps": fps, "runs": exported})
        return
    for each in exported:
        episodes = "1 episode" if each.episodes == 1 else f"{each.episodes} episodes"
        say(f"{each.run}: {episodes}, {each.frames} frames" + (f"; {each.trouble}" if each.trouble else ""))
    say(f"data set  {out}")
