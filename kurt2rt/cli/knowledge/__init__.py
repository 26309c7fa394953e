"""`kurt2rt knowledge ...`: commands on knowledge files."""

import typer

from kurt2rt.cli.knowledge.export import export, graph, import_, table
from kurt2rt.cli.knowledge.listing import list_files
from kurt2rt.cli.knowledge.merge import merge
from kurt2rt.cli.knowledge.show import check, contradictions, lessons, show
from kurt2rt.cli.knowledge.undo import redo, undo

knowledge = typer.Typer(
    help="Look after what the robot was taught: show, undo, merge.\n\n"
    "A file is changed only while no robot runs on it; it is read also while one\ndoes.",
    no_args_is_help=True,
)
knowledge.command("list")(list_files)
knowledge.command("import")(import_)
for _command in (show, lessons, contradictions, check, undo, redo, merge, export, table, graph):
    knowledge.command()(_command)
