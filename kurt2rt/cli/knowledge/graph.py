"""`kurt2rt knowledge graph`."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.knowledge.shared import KnowledgeFile, say
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.show.table_cells import printable


def graph(
    file: KnowledgeFile,
    out: Annotated[
        Path, typer.Option(help="File to write: a picture (.svg, .png), or .graphml for other programs.")
    ] = Path("results/network.svg"),
    level: Annotated[str, typer.Option(help="Level whose RLAs are shown: basic or mid.")] = BASIC,
    behaviour: Annotated[str | None, typer.Option(help="Only RLAs of this taught behaviour.")] = None,
    at_least: Annotated[
        float, typer.Option(min=0, max=100, metavar="PERCENT", help="Leave out what followed less often.")
    ] = 5.0,
) -> None:
    """Draw the RLA network: which RLA followed which, in percent; or write it as GraphML.

    For example:

        kurt2rt knowledge graph var/wall_following.knowledge
        kurt2rt knowledge graph var/streets.knowledge --level mid --out net.graphml
    """
    # Late import: networkx is in the extra `simulation`, and every command is loaded where --help is said.
    from kurt2rt.knowledge.graph.graph import FORMATS, drop_rare_edges, read_network
    from kurt2rt.knowledge.graph.picture import write_network

    if out.suffix not in FORMATS:
        raise typer.BadParameter(f"{out.name}: give a file that ends with {', '.join(FORMATS)}", param_hint="--out")
    with Journal.read_only(file) as journal:
        whole = read_network(journal, level=level, behaviour=behaviour)
    shown = drop_rare_edges(whole, at_least)
    what = " of ".join(part for part in (f"{len(shown)} RLAs", behaviour) if part)
    title = f"{printable(file.stem)}, level {level}: {what}; numbers: what followed, in % (from {at_least:g} %)"
    write_network(shown, title, out)
    edges = f"{shown.number_of_edges()} of {whole.number_of_edges()} edges"
    say(f"network  {out}: {len(shown)} of {len(whole)} RLAs, {edges}")
