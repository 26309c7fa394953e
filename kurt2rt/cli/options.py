"""Options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

TaskName = Annotated[str, typer.Option("--task", help="Task by name (config/tasks) or a path to its YAML file.")]
Plain = Annotated[
    bool,
    typer.Option(
        "--plain",
        help="Learn by the plain reading of the paper: all 72 values weigh 1, corrections only replace, and no action "
        "is held.",
    ),
]
RobotName = Annotated[
    str, typer.Option("--robot-settings", help="Robot by name (config/robots) or a path to its YAML file.")
]
Seed = Annotated[
    int, typer.Option(min=0, help="Decides start poses and all chance; the same seed gives the same run, bit for bit.")
]
WireName = Annotated[
    str,
    typer.Option(
        "--wire",
        help="CAN wire between robot and notebook, by name (config/wires) or a path to a YAML file: what a frame takes "
        "of time, and what goes wrong. none: no time, and nothing.",
    ),
]
OutFolder = Annotated[Path, typer.Option("--out", help="Folder for what is made; created when absent.")]
