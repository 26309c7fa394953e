"""`kurt2rt recover`."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.runs.recording.recover import NothingRecoverableError, recover_segment
from kurt2rt.runs.recording.run_folder import find_run, segments_in
from kurt2rt.service.settings import load_service


def recover(
    folder: Annotated[Path, typer.Argument(help="Folder for the copies; it is made.")],
    run: Annotated[
        Path | None,
        typer.Argument(help="A recorded run: its folder, a file in it, or its name in --runs. Default: the newest."),
    ] = None,
    runs: Annotated[Path | None, typer.Option(help="Folder of recorded runs. Default: as the settings say.")] = None,
    settings: Annotated[
        str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
    ] = "default",
) -> None:
    """Copy what is whole of a recorded run to files that Foxglove opens.

    A file that a power cut tore lacks its index, and so does the one that a
    robot is recording to: replay and why read them, a viewer refuses them. The
    run itself stays as it is.

        kurt2rt recover copies
        kurt2rt recover copies 20261122T031005Z-wall_following
    """
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
