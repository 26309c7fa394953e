"""`kurt2rt knowledge ...`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from kurt2rt.cli.printed import console_of
from kurt2rt.knowledge import journal_file
from kurt2rt.knowledge.export import export_table
from kurt2rt.knowledge.fold import check_knowledge
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.show import render_knowledge, render_lessons
from kurt2rt.knowledge.show_rla import render_rla
from kurt2rt.knowledge.undo import undo_lesson, undo_lessons_of
from kurt2rt.knowledge.writer import utc_now
from kurt2rt.network.file import FORMATS, write_network
from kurt2rt.network.network import read_network, without_rare
from kurt2rt.rla.lesson_book import LessonRecord
from kurt2rt.rla.rla import BASIC

knowledge = typer.Typer(
    help="Look after what the robot was taught. Only undo changes the file, and only while no robot runs on it; "
    "the others read it also while one does.",
    no_args_is_help=True,
)
_WIDE = 140
_TEACHER = "command line"
KnowledgeFile = Annotated[Path, typer.Argument(help="Knowledge file, as kurt2rt lesson or kurt2rt run leaves it.")]


@knowledge.command()
def show(
    file: KnowledgeFile,
    limit: Annotated[
        int | None, typer.Option(min=1, help="Show only the oldest so many RLAs; with --rla so many features.")
    ] = None,
    rla: Annotated[int | None, typer.Option(help="Show this RLA whole, with what is expected to follow it.")] = None,
) -> None:
    """List each RLA: its action, who taught it and when, instead of what, and how it is used."""
    with Journal.read_only(file) as journal:
        console = console_of(_WIDE)
        if rla is not None:
            console.print(render_rla(journal, rla, limit))
            return
        console.print(render_knowledge(journal, limit, wide=console.width >= _WIDE))


@knowledge.command()
def lessons(
    file: KnowledgeFile,
    limit: Annotated[int, typer.Option(min=1, help="Show only the newest so many lessons.")] = 20,
    of: Annotated[str | None, typer.Option(help="Only those of this teacher; the critic's are of: critic.")] = None,
) -> None:
    """List the lessons, newest first, with their ids and who undid them."""
    with Journal.read_only(file) as journal:
        console_of(_WIDE).print(render_lessons(journal, limit, of))


@knowledge.command()
def check(file: KnowledgeFile) -> None:
    """Check that every lesson in the file can be read and fits; exit code 1 when something does not."""
    with Journal.read_only(file) as journal:
        faults = check_knowledge(journal)
    for fault in faults:
        typer.echo(fault)
    if faults:
        raise typer.Exit(1)
    typer.echo(f"{file}: every lesson can be read and fits")


@knowledge.command()
def undo(
    file: KnowledgeFile,
    lesson: Annotated[
        str | None,
        typer.Option(help="Id of the lesson, as kurt2rt knowledge lessons shows it; else the last one that stands."),
    ] = None,
    of: Annotated[
        str | None,
        typer.Option(help="All lessons of this teacher that stand, newest first; the critic's are of: critic."),
    ] = None,
) -> None:
    """Take a lesson back, or all of one teacher: what it made, changed, ended or rewarded is as it was before."""
    if of is None:
        undone: tuple[LessonRecord, ...] = (undo_lesson(file, lesson, teacher=_TEACHER, stamp=utc_now()),)
    elif lesson is None:
        undone = undo_lessons_of(file, of, teacher=_TEACHER, stamp=utc_now())
    else:
        raise typer.BadParameter("give --lesson or --of, not both")
    console = Console(highlight=False)
    for record in undone:
        origin = record.event.origin
        by = f"lesson {origin.command_id} by {origin.teacher}"
        console.print(f"{file}: undone: {record.text} ({by})", markup=False, soft_wrap=True)
    if of is not None:
        console.print(f"{file}: {len(undone)} lessons of {of} undone", markup=False, soft_wrap=True)


@knowledge.command()
def export(
    file: KnowledgeFile,
    out: Annotated[Path, typer.Option(help="Folder for the table; made where it is missing.")] = Path("results/export"),
) -> None:
    """Write the RLAs as a table (CSV): one row each, with its condition, who taught it and how it was used."""
    journal_file.require_ours(file)
    saved = export_table(file, out, utc_now())
    Console(highlight=False).print(f"table  {out / saved.name}", markup=False, soft_wrap=True)
    Console(highlight=False).print(f"sha256  {saved.sha256}", markup=False, soft_wrap=True)


@knowledge.command()
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
    """Draw the RLA network: which RLA followed which, with percentages; or write it as GraphML."""
    if out.suffix not in FORMATS:
        raise typer.BadParameter(f"{out.name}: give a file that ends with {', '.join(FORMATS)}", param_hint="--out")
    with Journal.read_only(file) as journal:
        whole = read_network(journal, level=level, behaviour=behaviour)
    shown = without_rare(whole, at_least)
    what = " of ".join(part for part in (f"{len(shown)} RLAs", behaviour) if part)
    title = f"{file.stem}, level {level}: {what}; numbers: what followed, in % (from {at_least:g} %)"
    write_network(shown, title, out)
    edges = f"{shown.number_of_edges()} of {whole.number_of_edges()} edges"
    Console(highlight=False).print(
        f"network  {out}: {len(shown)} of {len(whole)} RLAs, {edges}", markup=False, soft_wrap=True
    )
