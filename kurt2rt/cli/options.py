"""Options that several commands share, and the refusal of options that cannot be taken."""

import math
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from config import CONFIG_DIR
from config.plugins import installed_plugins

_NAME_OR_PATH = "NAME|PATH"
_MOST_SEEDS = 100_000


def refuse_if(refused: bool, text: str, options: str) -> None:
    """Raise typer.BadParameter with a text on `options`, such as --set, if they cannot be taken."""
    if refused:
        raise typer.BadParameter(text, param_hint=options)


def require_finite(seconds: float | None) -> None:
    """Raise typer.BadParameter if --seconds is infinite or NaN."""
    refuse_if(seconds is not None and not math.isfinite(seconds), "must be a finite number of seconds", "--seconds")


def _names_in(kind: str) -> Callable[[str], list[str]]:
    """Return what completes the names of settings of a kind, shipped and installed, for a shell."""

    def complete(incomplete: str) -> list[str]:
        # Imported here: the help needs no robots.
        from config.robot_plugins import plugin_tasks

        names = sorted(path.stem for path in (CONFIG_DIR / kind).glob("*.yaml"))
        names += (each.name for each in installed_plugins(kind))
        names += (each.name for each in (plugin_tasks() if kind == "tasks" else ()))
        return [name for name in names if name.startswith(incomplete)]

    return complete


_TASK = "Task: a name in config/tasks or of a plug-in, module:NAME, or the path of a YAML file."
_WORLD = (
    "World: a name in config/worlds or of a plug-in, module:NAME, or the path of a YAML file (also of ROS map_server). "
    "rooms-N, flats-N, streets-N and floors-N are generated from the number N."
)


def task_option(default: str = "") -> Any:
    """Return --task, the same in every command; `default` describes the task without it."""
    return _named("--task", "tasks", f"{_TASK} {default}".rstrip())


def world_option(default: str = "") -> Any:
    """Return --world, the same in every command; `default` describes the world without it."""
    return _named("--world", "worlds", f"{_WORLD} {default}".rstrip())


def _named(option: str, kind: str, told: str) -> Any:
    return typer.Option(option, metavar=_NAME_OR_PATH, help=told, autocompletion=_names_in(kind), show_default=False)


DEFAULT_TEACHER = "ordinary"
_TEACHER = f"Scripted teacher: a name in config/teachers, or the path of a YAML file. Default: {DEFAULT_TEACHER}."
Teacher = Annotated[str, _named("--teacher", "teachers", _TEACHER)]
TASK_OF_THE_FILE = "Default: the task that the knowledge file was taught for."
TaskOfTheFile = Annotated[str | None, task_option(TASK_OF_THE_FILE)]
"""Goes to kurt2rt.knowledge.files.task_of_file."""
PaperDefaults = Annotated[
    bool,
    typer.Option(
        "--paper-defaults",
        help="Learn by the paper's own settings: all 72 values weigh 1, corrections only replace, and no action is "
        "held.",
    ),
]
RobotName = Annotated[
    str | None,
    _named(
        "--robot-settings",
        "robots",
        "Robot: a name in config/robots or of a plug-in, or the path of a YAML file. Default: the robot of the task, "
        "which is kurt2 unless the task is of another one, such as school/fleeing.",
    ),
]
SettingsName = Annotated[
    str, typer.Option("--settings", help="Runtime settings by name (config/runtime) or a path to a YAML file.")
]
RobotAddress = Annotated[
    str | None, typer.Option("--robot", help="Address of the robot. Default: as noted when the device was paired.")
]
RobotPort = Annotated[
    int | None,
    typer.Option(
        "--port", metavar="PORT", min=1, max=65535, help="UDP port of the robot. Default: as noted with the pairing."
    ),
]
RecordedRun = Annotated[
    Path | None,
    typer.Argument(help="A recorded run: its folder, a file in it, or its name in --runs. Default: the newest."),
]
RunsFolder = Annotated[
    Path | None, typer.Option("--runs", help="Folder of recorded runs. Default: as the settings say.")
]
Seed = Annotated[
    int,
    typer.Option(
        min=0, metavar="N", help="Seed of start poses and noise; the same seed gives the same run, bit for bit."
    ),
]
OutFolder = Annotated[Path, typer.Option("--out", help="Folder for the results; made if it is missing.")]
Jobs = Annotated[
    int, typer.Option("--jobs", min=1, metavar="N", help="Number of processes for many robots; 1: this process alone.")
]
SearchName = Annotated[
    str,
    typer.Argument(
        help="Search: a name in config/searches, or the path of a YAML file.", autocompletion=_names_in("searches")
    ),
]
ALL_PROCESSORS = os.cpu_count() or 1
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change one key of the task's file, with dots between its levels, such as learning.radius=600. Repeat "
        "it for several keys. Teach and examine with the same values.",
    ),
]


def _require_page_address(value: str | None) -> str | None:
    # Imported here: the help needs no settings.
    from kurt2rt.service.settings import page_address_of

    try:
        return None if value is None else page_address_of(value)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from error


PageAddressName = Annotated[
    str | None,
    typer.Option(
        "--page-address",
        metavar="ADDRESS",
        callback=_require_page_address,
        help="Address or name of the machine that serves the page, such as 192.168.0.7 or robot.example; a phone opens "
        "it. auto: all addresses of this machine. Default: as the settings say.",
    ),
]


def seeds_option(whole: str, quick: str) -> Any:
    """Return --seeds of a study; `whole` and `quick` are the seeds without it, as texts for the help."""
    return typer.Option(
        help=f"One robot per seed, e.g. {whole}, which is the default; with --quick {quick}.", show_default=False
    )


def results_option(default: str) -> Any:
    """Return --out of a study; `default` is the folder without it, as text for the help."""
    return typer.Option(
        "--out", help=f"Folder for what is made; created when absent. Default: {default}.", show_default=False
    )


def seconds_of(text: str) -> float:
    """Return the seconds of `90`, `12.34`, `1:30` or `1:02:03`. Raises typer.BadParameter for another form."""
    found = re.fullmatch(r"(?:(?:(\d+):)?(\d+):)?(\d+\.?\d*|\.\d+)", text)
    hours, minutes, seconds = (float(each or 0) for each in found.groups()) if found else (0.0, 0.0, math.inf)
    if seconds >= (60.0 if ":" in text else math.inf):
        raise typer.BadParameter(f"give seconds such as 12.34, or minutes such as 1:30 (got {text!r})")
    return 3600.0 * hours + 60.0 * minutes + seconds


def changes_of(words: list[str] | None) -> dict[str, str]:
    """Return the values of --set by key; None: no --set. Raises typer.BadParameter for a word without `=`."""
    changes = {}
    for word in words or ():
        key, equals, value = word.partition("=")
        refuse_if(
            not (key and equals and value), f"give KEY=VALUE, such as learning.radius=600 (got {word!r})", "--set"
        )
        changes[key] = value
    return changes


def parse_seeds(text: str) -> list[int]:
    """Return the seeds of `100-119` or `1,5,7-9`, in order.

    Raises typer.BadParameter for another form, too many seeds, or a seed that is named twice.
    """
    seeds: list[int] = []
    try:
        for part in text.split(","):
            seeds.extend(_seeds_of(part))
    except ValueError as error:
        expected = f"expected seeds such as 100-119 or 1,5,7-9 (got {text!r})"
        raise typer.BadParameter(expected, param_hint="--seeds") from error
    too_many = f"too many seeds (got {text!r}, allowed are {_MOST_SEEDS} at most)"
    refuse_if(len(seeds) > _MOST_SEEDS, too_many, "--seeds")
    refuse_if(len(set(seeds)) != len(seeds), f"no seed may appear twice (got {text!r})", "--seeds")
    return seeds


def _seeds_of(part: str) -> range:
    first, _, last = part.partition("-")
    seeds = range(int(first), int(last or first) + 1)
    if not seeds:
        raise ValueError(f"{part} ends before it begins")
    return seeds[: _MOST_SEEDS + 1]
