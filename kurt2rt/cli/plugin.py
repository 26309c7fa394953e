"""`kurt2rt plugin ...`: parts of other authors."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.checks.plugins.kinds import KINDS, KindName, find_subjects, list_parts
from kurt2rt.checks.plugins.part_text import TextKind, text_of_part
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.options import RobotName
from kurt2rt.cli.tables import console_of
from kurt2rt.platform.text_table import TextTable, print_whole

plugin = typer.Typer(
    help="List, show, begin and check plug-ins: learners, policies, judges, metrics, actions, tasks, worlds, robots.",
    no_args_is_help=True,
)


@plugin.command("list")
def list_(
    kind: Annotated[KindName | None, typer.Option(help="List only this kind.")] = None, as_json: AsJson = False
) -> None:
    """List the parts of each kind: the shipped ones and those of installed packages.

    For example:

        kurt2rt plugin list
        kurt2rt plugin list --kind policies
    """
    chosen = KINDS.values() if kind is None else [KINDS[kind]]
    listed = [each for one in chosen for each in list_parts(one)]
    if as_json:
        print_json({"plugins": listed})
        return
    table = TextTable()
    for heading in ("kind", "name", "from", "note"):
        table.add_column(heading, whole=heading == "name")
    for each in listed:
        table.add_row(*each)
    print_whole(console_of(), table)


@plugin.command()
def show(
    kind: Annotated[
        TextKind, typer.Argument(help="Kind of the part; also repertoires and situations, which tasks name.")
    ],
    name: Annotated[
        str, typer.Argument(help="Shipped or installed name, such as fleeing or school/fleeing, or module:Name.")
    ],
) -> None:
    """Print the YAML or the source of a part, to start one of your own from.

    For example:

        kurt2rt plugin show tasks school/fleeing > my_task.yaml
        kurt2rt plugin show repertoires school/basic
        kurt2rt plugin show policies sector_fleeing > my_policy.py
    """
    typer.echo(text_of_part(kind, name), nl=False)


@plugin.command()
def new(
    kind: Annotated[KindName, typer.Argument(help="Kind of the plug-in.")],
    name: Annotated[str, typer.Argument(help="Its name, such as wandering; also that of its module and its folder.")],
    out: Annotated[Path, typer.Option(help="Folder that gets the plug-in's folder.")] = Path(),
) -> None:
    """Write a plug-in to begin with: a folder that installs, with a test that it passes.

    For example:

        kurt2rt plugin new policies wandering
        kurt2rt plugin check wandering
        kurt2rt plugin new robots rover
    """
    from kurt2rt.checks.plugins.skeleton import write_skeleton

    for path in write_skeleton(kind, name, out):
        typer.echo(path)
    typer.echo(f"next: kurt2rt plugin check {out / name}")


@plugin.command()
def check(
    name: Annotated[
        str,
        typer.Argument(
            help="Plug-in: an installed name, module:Name in this folder, a folder with a pyproject.toml, or the YAML "
            "file of a task or a world.",
        ),
    ],
    kind: Annotated[KindName | None, typer.Option(help="Kind of the plug-in, where it is not clear.")] = None,
    robot_settings: RobotName = None,
    as_json: AsJson = False,
) -> None:
    """Check that a plug-in keeps the promises of its kind, on made-up readings, lessons and poses.

    For example:

        kurt2rt plugin check wandering
        kurt2rt plugin check my_policy:Wandering
        kurt2rt plugin check my_task.yaml
        kurt2rt plugin check my_policy:Dodging --robot-settings school

    A part is tried on the robot that --robot-settings names, else on that of
    its task. A folder may hold parts for several robots: each part that a task
    in it names is tried on the robot of that task.
    """
    subjects = find_subjects(name, kind)
    # Not at the top: the simulator is an extra, and every command is loaded where --help is said.
    from kurt2rt.checks.plugins.check import check_all

    found = check_all(subjects, robot_settings)
    if as_json:
        plugins = [
            {"kind": each.subject.group, "name": each.subject.name, "robot": each.robot}
            | {"broken": each.broken, "note": each.note}
            for each in found
        ]
        print_json({"plugins": plugins})
    else:
        for (group, part, _), robot, broken, note in found:
            tried = "" if robot is None else f", tried on the robot {robot} (--robot-settings names another)"
            typer.echo(f"{part} ({group}): " + (f"breaks promises{tried}" if broken else "keeps all promises"))
            for line in (*broken, *filter(None, (note,))):
                typer.echo(f"  {line}")
    if any(each.broken for each in found):
        raise typer.Exit(1)
