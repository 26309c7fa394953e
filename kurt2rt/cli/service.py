"""`kurt2rt service ...`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from hal.settings import find_config
from kurt2rt.service_settings import load_service
from kurt2rt.systemd.error import UnitError
from kurt2rt.systemd.examination import MOST_EXPOSURE, examine
from kurt2rt.systemd.installing import install as install_unit
from kurt2rt.systemd.installing import uninstall as uninstall_unit
from kurt2rt.systemd.unit import Unit, closed_to_others, program, unit_of

service = typer.Typer(
    help="Run the robot's program as a unit of systemd, which starts it with the machine and again whenever it fell.",
    no_args_is_help=True,
)

RobotBus = Annotated[str, typer.Option("--robot", help="The bus that the robot is on, as for kurt2rt run.")]
RuntimeSettings = Annotated[
    str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
]
UnitName = Annotated[str, typer.Option(help="Name of the unit and of its user; one for each robot of a machine.")]
WithPage = Annotated[bool, typer.Option("--page", help="Let the unit serve the teacher's page as well.")]


@service.command()
def show(
    robot: RobotBus = "can0", settings: RuntimeSettings = "default", name: UnitName = "kurt2rt", page: WithPage = False
) -> None:
    """Print the unit as install would write it."""
    typer.echo(_unit(robot, settings, name, page=page).service, nl=False)


@service.command()
def check(
    robot: RobotBus = "can0", settings: RuntimeSettings = "default", name: UnitName = "kurt2rt", page: WithPage = False
) -> None:
    """Let systemd's own tools look at the unit: does it load, what may it do.

    Changes nothing. Ends with code 1 if it does not load, its user could not
    read this installation, or its exposure (systemd-analyze security, 0 to 10,
    less is safer) is above 2.
    """
    unit = _unit(robot, settings, name, page=page)
    found = examine(unit)
    console = Console()
    for line in found.open:
        console.print(f"open: {line}", markup=False, highlight=False, soft_wrap=True)
    console.print(f"exposure {found.exposure} of 10, at most {MOST_EXPOSURE} is well", markup=False, highlight=False)
    closed = closed_to_others()
    wrong = (*found.complaints, *([closed] if closed else []))
    for line in wrong:
        console.print(line, style="red", markup=False, highlight=False, soft_wrap=True)
    if wrong or not found.passed:
        raise typer.Exit(1)
    console.print(f"{name}.service loads")


@service.command()
def install(
    robot: RobotBus = "can0", settings: RuntimeSettings = "default", name: UnitName = "kurt2rt", page: WithPage = False
) -> None:
    """Write the unit and make its user; starts nothing yet.

    Needs root. The unit keeps what it is taught in /var/lib/NAME. After any
    start the robot stands until its teacher says Go.
    """
    closed = closed_to_others()
    if closed:
        raise UnitError(closed)
    files = install_unit(_unit(robot, settings, name, page=page))
    for path in files:
        typer.echo(f"{path} is written")
    typer.echo(f"start it, now and with the machine: systemctl enable --now {name}")


@service.command()
def uninstall(name: UnitName = "kurt2rt") -> None:
    """End the unit and remove it; what was taught in /var/lib/NAME stays."""
    for path in uninstall_unit(name):
        typer.echo(f"{path} is removed")
    typer.echo(f"what was taught stays in /var/lib/{name}")


def _unit(robot: str, settings: str, name: str, *, page: bool) -> Unit:
    found = find_config("runtime", settings)
    loaded = load_service(settings)
    named = settings if found.stem == settings else str(found.absolute())
    command = (*program(), "run", "--service", "--robot", robot, "--settings", named, *(("--page",) if page else ()))
    folders = (Path(loaded.knowledge).parent, *map(Path, (loaded.teachers, loaded.devices, loaded.recordings)))
    return unit_of(name, robot, command, [each for each in folders if each.is_absolute()])
