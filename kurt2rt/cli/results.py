"""`kurt2rt results ...`: commands on folders of results."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.tables import console_of
from kurt2rt.experiments.study.study_record import StudyRecord, read_records
from kurt2rt.platform.text_table import TextTable, print_whole

results = typer.Typer(
    help="Look at the results of studies, and put together those of several machines.", no_args_is_help=True
)

_MOST_NAMES = 3
Folder = Annotated[Path, typer.Argument(help="Folder of results, which a study was given with --out.")]


@results.command()
def show(folder: Folder, as_json: AsJson = False) -> None:
    """Show the studies of a folder: commands, jobs done and missing, source and versions.

    For example:

        kurt2rt results show results/paper
    """
    _show(folder, read_records(folder), as_json=as_json)


@results.command()
def merge(
    out: Annotated[Path, typer.Argument(help="Folder that gets all results; created when absent.")],
    parts: Annotated[list[Path], typer.Argument(help="Folder of a shard; name one or more.")],
    as_json: AsJson = False,
) -> None:
    """Merge the results of shards into one folder.

    A part of another source, other settings or versions is refused, and so is a
    job that has two results. Nothing is copied before all parts were checked. A
    merge that was interrupted goes on if it is run again. Then the study's own
    command with --out OUT has nothing left to do but the report.

    For example:

        kurt2rt paper --shard 1/2 --out part-1
        kurt2rt paper --shard 2/2 --out part-2
        kurt2rt results merge results/paper part-1 part-2
        kurt2rt paper --out results/paper
    """
    # Not at the top: knowledge files need packages that --help does without.
    from kurt2rt.experiments.study.merge import merge_results

    merged = merge_results(out, parts)
    if as_json:
        print_json({"parts": merged.parts, "studies": [_as_data(each, out) for each in merged.records]})
        return
    lines = [f"{part.folder}: {part.results} results, {part.copied} copied" for part in merged.parts]
    print_whole(console_of(), *lines)
    _show(out, merged.records, as_json=False)


def _show(folder: Path, records: Sequence[StudyRecord], *, as_json: bool) -> None:
    if as_json:
        print_json({"studies": [_as_data(each, folder) for each in records]})
        return
    table = TextTable(title=f"Studies in {folder}")
    for heading, number in (("command", False), ("jobs done", True), ("missing", False), ("source", False)):
        table.add_column(heading, number=number)
    for each in records:
        missing = [job.name for job in each.missing(folder)]
        done = f"{len(each.jobs) - len(missing)} of {len(each.jobs)}"
        table.add_row(each.command, done, _some(missing), ", ".join(each.sources))
    versions = "; ".join(dict.fromkeys(text for each in records for text in each.versions))
    complete = [each.command for each in records if not each.missing(folder)]
    nexts = (f"next: {command} --out {folder}" for command in complete)
    print_whole(console_of(), table, f"versions  {versions}", *nexts)


def _some(names: Sequence[str]) -> str:
    """Return the first names, and the number of further ones."""
    more = len(names) - _MOST_NAMES
    return "; ".join([*names[:_MOST_NAMES], *([f"and {more} more"] if more > 0 else [])]) or "none"


def _as_data(record: StudyRecord, folder: Path) -> dict[str, Any]:
    return {
        "command": record.command,
        "jobs": len(record.jobs),
        "missing": [job.name for job in record.missing(folder)],
        "sources": record.sources,
        "versions": record.versions,
    }
