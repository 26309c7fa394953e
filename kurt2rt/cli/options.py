"""Options that several commands share."""

import os
from pathlib import Path
from typing import Annotated, Any

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
Jobs = Annotated[
    int, typer.Option("--jobs", min=1, help="Processes to use where there are many robots; 1: this one alone.")
]
ALL_PROCESSORS = os.cpu_count() or 1
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Another value for one key of the task's file, dots between its levels, e.g. learning.past_weight=1; "
        "repeat for several. Teach and examine with the same ones.",
    ),
]


def seeds_option(whole: str, quick: str) -> Any:
    """--seeds of a study, and those that are taken unless it is given."""
    return typer.Option(
        help=f"One robot per seed, e.g. {whole}, which is the default; with --quick {quick}.", show_default=False
    )


def results_option(default: str) -> Any:
    """--out of a study; `default` says where its results go else."""
    return typer.Option(
        "--out", help=f"Folder for what is made; created when absent. Default: {default}.", show_default=False
    )


def changes_of(words: list[str] | None) -> dict[str, str]:
    """What --set says, by key. Raises typer.BadParameter."""
    changes = {}
    for word in words or ():
        key, equals, value = word.partition("=")
        if not (key and equals and value):
            raise typer.BadParameter(f"{word!r} is no KEY=VALUE; give e.g. learning.past_weight=1", param_hint="--set")
        changes[key] = value
    return changes
