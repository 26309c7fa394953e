"""`kurt2rt knowledge export`, `import` and `table`."""

from pathlib import Path
from typing import Annotated

import typer

from behaviors.action_groups import usual_speeds
from hal.robot_settings import load_robot_of
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.knowledge.shared import KnowledgeFile
from kurt2rt.cli.options import RobotName, TaskOfTheFile, refuse_if, task_option
from kurt2rt.cli.tables import say
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.exchange.package import export_knowledge, import_knowledge, read_package
from kurt2rt.knowledge.files.table import export_table
from kurt2rt.knowledge.files.task_of_file import task_of_elsewhere, task_of_file
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.knowledge.show.table_cells import printable


def export(
    file: KnowledgeFile,
    out: Annotated[Path, typer.Option(help="File to write; nothing may be there yet.")],
    task_name: TaskOfTheFile = None,
    robot_name: RobotName = None,
) -> None:
    """Write one file to give away: all lessons and counts, and the settings of their task.

    For example:

        kurt2rt knowledge export var/wall_following.knowledge --out walls.zip
    """
    name = task_of_file(file, task_name)
    robot, task = load_robot_of(robot_name, name), load_task(name)
    size = export_knowledge(file, out, robot, task, stamp=utc_now())
    say(f"export  {out}: {size / 1000:.0f} kB")


def import_(
    file: Annotated[Path, typer.Argument(help="File that kurt2rt knowledge export wrote.")],
    out: Annotated[Path, typer.Option(help="Knowledge file to make; nothing may be there yet.")],
    task_name: Annotated[str | None, task_option("Default: the task whose settings came with it.")] = None,
    robot_name: RobotName = None,
) -> None:
    """Make a knowledge file from an exported one; refuse a changed file, or one of other features.

    For example:

        kurt2rt knowledge import walls.zip --out var/walls.knowledge
    """
    named = read_package(file).task
    name = task_name or task_of_elsewhere(named, file)
    robot, task = load_robot_of(robot_name, name), load_task(name)
    imported = import_knowledge(file, out, robot, task, stamp=utc_now())
    package = imported.package
    say(f"import  {out}: {len(package.lessons)} rows of {package.binding.system}")
    if imported.differing_settings:
        say(f"settings that differ here: {', '.join(imported.differing_settings)}")


def table(
    file: KnowledgeFile,
    out: Annotated[Path, typer.Option(help="Folder for the table; made where it is missing.")] = Path("results/export"),
    as_json: AsJson = False,
) -> None:
    """Write the RLAs as a table (CSV): one row each, with condition, teacher and use.

    Numbers are exact. A text that a spreadsheet would run as a formula gets an
    apostrophe before it.

    For example:

        kurt2rt knowledge table var/wall_following.knowledge --out results/export
    """
    journal_file.require_ours(file)
    saved = export_table(file, out, utc_now())
    if as_json:
        print_json({"table": out / saved.name, "sha256": saved.sha256})
        return
    say(f"table  {out / saved.name}")
    say(f"sha256  {saved.sha256}")


def graph(
    file: KnowledgeFile,
    out: Annotated[
        Path, typer.Option(help="File to write: a picture (.svg, .png), or .graphml for other programs.")
    ] = Path("results/network.svg"),
    level: Annotated[str, typer.Option(help="Level whose RLAs are shown: basic or mid.")] = BASIC,
    behaviour: Annotated[str | None, typer.Option(help="Only RLAs of this taught behaviour.")] = None,
    at_least: Annotated[
        float, typer.Option(min=0, max=100, metavar="PERCENT", help="Leave out what followed less often.")
    ] = 20.0,
    task_name: TaskOfTheFile = None,
    robot_name: RobotName = None,
) -> None:
    """Draw the RLAs by their actions, and which followed which, in percent; or write GraphML.

    For example:

        kurt2rt knowledge graph var/wall_following.knowledge
        kurt2rt knowledge graph var/streets.knowledge --level mid --out net.graphml
    """
    # Late import: networkx is in the extra `simulation`, and every command is loaded where --help is said.
    from kurt2rt.knowledge.graph.graph import FORMATS, GRAPHML, drop_rare_edges, read_network, write_graphml
    from kurt2rt.runs.explain.network_picture import draw_network

    refuse_if(out.suffix not in FORMATS, f"{out.name}: give a file that ends with {', '.join(FORMATS)}", "--out")
    with Journal.read_only(file) as journal:
        whole = read_network(journal, level=level, behaviour=behaviour)
    shown = drop_rare_edges(whole, at_least)
    what = " of ".join(part for part in (f"{len(shown)} RLAs", behaviour) if part)
    title = f"{printable(file.stem)}, level {level}: {what}; numbers: what followed, in % (from {at_least:g} %)"
    if out.suffix == GRAPHML:  # shows neither robot nor actions, so the task need not be known here
        write_graphml(shown, title, out)
    else:
        name = task_of_file(file, task_name)
        draw_network(shown, title, out, load_robot_of(robot_name, name), usual_speeds(load_task(name).repertoire))
    edges = f"{shown.number_of_edges()} of {whole.number_of_edges()} edges"
    say(f"network  {out}: {len(shown)} of {len(whole)} RLAs, {edges}")
