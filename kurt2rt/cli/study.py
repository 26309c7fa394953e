"""`kurt2rt study ...`: commands of studies besides those of the paper."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import anyio
import typer

from kurt2rt.cli.certify import certify
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.compare import compare
from kurt2rt.cli.doubt import doubt
from kurt2rt.cli.search import search
from kurt2rt.cli.transfer import transfer

_To = Annotated[Path | None, typer.Option("--to", metavar="FILE", help="Work for the cluster of this file.")]
_New = Annotated[Path | None, typer.Option("--new", metavar="FILE", help="Make the file of a new cluster, and end.")]
_At = Annotated[
    str, typer.Option("--at", metavar="ADDRESS", help="With --new, address of its scheduler, such as tls://lab:8786.")
]
study = typer.Typer(
    help="Measure taught robots: new worlds, doubt, certificates.\n\nAnd compare learners, and search settings.",
    no_args_is_help=True,
)


@dataclass(frozen=True, slots=True)
class _Options:
    """Options of `kurt2rt study worker`."""

    to: _To = None
    new: _New = None
    at: _At = ""


@takes_options(_Options)
def worker(options: _Options) -> None:
    """Run jobs of studies that another machine sends, one at a time, until Ctrl-C.

    Start one for each processor. Jobs are Python programs, so the members of a
    cluster know each other by a file with its key: copy it to each machine, and
    keep it to yourself. `kurt2rt study worker --new` makes it, and says how to
    start the scheduler of Dask that passes the jobs on.

    For example:

        kurt2rt study worker --new lab.cluster --at tls://lab:8786
        kurt2rt study worker --to lab.cluster
        kurt2rt paper --on lab.cluster
    """
    # Not at the top: Dask is an extra, and every command is loaded where --help is said.
    if options.new is not None and options.to is None:
        from kurt2rt.experiments.study.cluster_file import make_cluster_file, scheduler_command

        make_cluster_file(options.new, options.at)
        print(f"cluster  {options.new}: copy it to each machine, and keep it to yourself", file=sys.stdout)
        print(f"scheduler  {scheduler_command(options.new, options.at)}", file=sys.stdout)
    elif options.to is not None and options.new is None:
        from kurt2rt.experiments.study.cluster import serve

        anyio.run(serve, options.to, lambda address: print(f"worker  {address}", flush=True, file=sys.stdout))
    else:
        raise typer.BadParameter("give the file of a cluster, or make one", param_hint="--to, --new")


for _command in (transfer, compare, doubt, certify, search, worker):
    study.command()(_command)
