"""Options of the commands that read recorded runs."""

from pathlib import Path
from typing import Annotated

import typer

RecordedRun = Annotated[
    Path | None,
    typer.Argument(help="A recorded run: its folder, a file in it, or its name in --runs. Default: the newest."),
]
RunsFolder = Annotated[Path | None, typer.Option(help="Folder of recorded runs. Default: as the settings say.")]
RuntimeSettingsName = Annotated[
    str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
]
