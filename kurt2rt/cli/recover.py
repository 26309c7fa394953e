"""`kurt2rt recover`."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.recorded_run import RecordedRun, RunsFolder, RuntimeSettingsName
from kurt2rt.runs.recording.recording import LAYOUT
from kurt2rt.runs.recording.run_folder import find_run, segments_in
from kurt2rt.service.settings import load_service


def recover(
    folder: Annotated[Path, typer.Argument(help="Folder for the copies; it is made.")],
    run: RecordedRun = None,
    runs: RunsFolder = None,
    settings: RuntimeSettingsName = "default",
) -> None:
    """Copy what is whole of a run to files for Foxglove.

    A file that a power cut tore lacks its index, and so does the one that a
    robot is recording to: replay and why read them, a viewer refuses them. The
    run itself stays as it is. Import the layout that this names into Foxglove
    once.

        kurt2rt recover copies
        kurt2rt recover copies 20261122T031005Z-wall_following
    """
    # Late import: mcap is in the extra `recording`, and this module is imported without it.
    from kurt2rt.runs.recording.recover import NothingRecoverableError, recover_segment

    found = find_run(run, runs or Path(load_service(settings).recordings))
    folder.mkdir(parents=True, exist_ok=True)
    segments = [found] if found.is_file() else segments_in(found)
    for segment in segments:
        try:
            truncated = recover_segment(segment, folder / segment.name)
        except NothingRecoverableError as error:
            if len(segments) == 1:
                raise
            typer.echo(f"{error}; not copied")
            continue
        typer.echo(truncated or f"{segment} is whole")
        typer.echo(f"copied to {folder / segment.name}")
    typer.echo(f"layout for Foxglove: {LAYOUT}")
