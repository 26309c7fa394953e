"""`kurt2rt service ...`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from config.settings_files import find_config
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import SettingsName
from kurt2rt.service.settings import load_service
from kurt2rt.service.systemd.access import RequiredAccess, paths_to_chown, require_access, start_command
from kurt2rt.service.systemd.install import install as install_unit
from kurt2rt.service.systemd.install import uninstall as uninstall_unit
from kurt2rt.service.systemd.unit import STATE, Unit, build_unit, require_name
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError

service = typer.Typer(
    help="Run the robot's program as a unit of systemd.\n\nIt starts with the machine, and restarts after a crash.",
    no_args_is_help=True,
)

_BUS = "can0"
UnitName = Annotated[str, typer.Option(help="Name of the unit and of its user; one for each robot of a machine.")]


@dataclass(frozen=True, slots=True)
class _UnitOptions:
    bus: Annotated[str, typer.Option("--bus", help="Bus that the robot is on, as for kurt2rt run.")] = _BUS
    settings: SettingsName = "default"
    name: UnitName = "kurt2rt"
    page: Annotated[bool, typer.Option("--page", help="Let the unit serve the teacher's page as well.")] = False


@service.command()
@takes_options(_UnitOptions)
def show(options: _UnitOptions) -> None:
    """Print the unit as `install` would write it.

    For example:

        kurt2rt service show --bus can0
    """
    unit, _ = _unit(options)
    typer.echo(unit.service, nl=False)


@service.command()
@takes_options(_UnitOptions)
def install(options: _UnitOptions) -> None:
    """Write the unit and make its user; start nothing yet.

    Needs root. The unit keeps what it is taught in /var/lib/NAME. After any
    start the robot stands until its teacher says Go.

    For example:

        sudo .venv/bin/kurt2rt service install --bus can0
        sudo systemctl enable --now kurt2rt
    """
    unit, wanted = _unit(options)
    name = options.name
    require_access(wanted)
    for path in install_unit(unit):
        typer.echo(f"{path} is written")
    for finding in paths_to_chown(name, wanted):
        typer.echo(f"first of all: {finding}")
    typer.echo(f"start it, now and with the machine: systemctl enable --now {name}")


@service.command()
def uninstall(name: UnitName = "kurt2rt") -> None:
    """End the unit and remove it; keep what was taught in /var/lib/NAME.

    For example:

        sudo .venv/bin/kurt2rt service uninstall
    """
    for path in uninstall_unit(name):
        typer.echo(f"{path} is removed")
    typer.echo(f"what was taught stays in {STATE / name}")


def _unit(options: _UnitOptions) -> tuple[Unit, RequiredAccess]:
    """Return the unit, and the files and folders that it needs. Raises SettingsError, UnitError."""
    bus, settings, name = options.bus, options.settings, options.name
    require_name(name)
    found = find_config("runtime", settings)
    loaded = load_service(settings)
    named = settings if found.stem == settings else str(found.absolute())
    command = (
        *start_command(),
        "run",
        "--service",
        "--bus",
        bus,
        "--settings",
        named,
        *(("--page",) if options.page else ()),
    )
    state = STATE / name
    files = [found.absolute(), _as_the_service_finds("robot", loaded.robot, state)]
    files.append(_as_the_service_finds("task", loaded.task, state))
    folders = (Path(loaded.knowledge).parent, *map(Path, (loaded.teachers, loaded.devices, loaded.recordings)))
    wanted = RequiredAccess(
        tuple(each for each in files if not each.is_relative_to(state)),
        tuple(each for each in sorted(set(folders)) if each.is_absolute() and not each.is_relative_to(state)),
    )
    return build_unit(name, bus, command, wanted.folders), wanted


def _as_the_service_finds(key: str, given: str, state: Path) -> Path:
    """Return the file that a setting names. Raises SettingsError; UnitError if the service would find another file."""
    found = find_config(key + "s", given)
    if found == Path(given) and not found.is_absolute():
        raise UnitError(UnitCode.RELATIVE_PATH, where=key, given=given, state=state)
    return found.absolute()
