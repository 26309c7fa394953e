"""`kurt2rt plugin ...`: parts of other authors."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.checks.plugins.kinds import KINDS, KindName, TextKind, list_parts, text_of_part
from kurt2rt.checks.plugins.skeleton import SkeletonKind, write_skeleton
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.tables import console_of
from kurt2rt.platform.text_table import Column, TextTable, print_whole

plugin = typer.Typer(
    help="List, show and begin plug-ins: parts of other authors.",
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
    table = TextTable("kind", Column("name", whole=True), "from", "note")
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
    kind: Annotated[SkeletonKind, typer.Argument(help="Kind of the plug-in.")],
    name: Annotated[str, typer.Argument(help="Its name, such as nearest; also that of its module and its folder.")],
    out: Annotated[Path, typer.Option(help="Folder that gets the plug-in's folder.")] = Path(),
) -> None:
    """Write a learner or a robot to begin with: a folder that installs, with tests.

    Its test inherits one for each promise of its kind; pytest runs them. A part
    of another kind is one file, and its tests another (docs/extend.md).

    For example:

        kurt2rt plugin new learners nearest
        kurt2rt plugin new robots rover
    """
    for path in write_skeleton(kind, name, out):
        typer.echo(path)
    folder, uses = out / name, {"learners": f"study compare --learner {name}", "robots": f"demo --task {name}/fleeing"}
    typer.echo(f"next:\n  pip install -e {folder}\n  pytest {folder}\n  kurt2rt {uses[kind.value]}")
