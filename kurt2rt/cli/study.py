"""`kurt2rt study ...`: measurements of many robots."""

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
from kurt2rt.cli.paper import paper
from kurt2rt.cli.phases import phases
from kurt2rt.cli.search import search
from kurt2rt.cli.transfer import transfer

_Cluster = Annotated[Path | None, typer.Option(metavar="FILE", help="Work for the cluster of this file.")]
_New = Annotated[Path | None, typer.Option(metavar="FILE", help="Make the file of a new cluster, and end.")]
_Scheduler = Annotated[
    str, typer.Option(metavar="ADDRESS", help="With --new, address of its scheduler, such as tls://lab:8786.")
]
study = typer.Typer(
    help="Measure many robots: the paper, phases, new worlds, doubt.\n\n"
    "Compare learners, certify knowledge, search settings.",
    no_args_is_help=True,
)


@dataclass(frozen=True, slots=True)
class _Options:
    cluster: _Cluster = None
    new: _New = None
    scheduler: _Scheduler = ""


@takes_options(_Options)
def worker(options: _Options) -> None:
    """Run jobs of studies that another machine sends, one at a time, until Ctrl-C.

    Start one for each processor. Jobs are Python programs, so the members of a
    cluster know each other by a file with its key: copy it to each machine, and
    keep it to yourself. `kurt2rt study worker --new` makes it, and says how to
    start the scheduler of Dask that passes the jobs on.

    For example:

        kurt2rt study worker --new lab.cluster --scheduler tls://lab:8786
        kurt2rt study worker --cluster lab.cluster
        kurt2rt study paper --cluster lab.cluster
    """
    # Not at the top: Dask is an extra, and every command is loaded where --help is said.
    if options.new is not None and options.cluster is None:
        from kurt2rt.experiments.study.cluster_file import make_cluster_file, scheduler_command

        make_cluster_file(options.new, options.scheduler)
        print(f"cluster  {options.new}: copy it to each machine, and keep it to yourself", file=sys.stdout)
        print(f"scheduler  {scheduler_command(options.new, options.scheduler)}", file=sys.stdout)
    elif options.cluster is not None and options.new is None:
        from kurt2rt.experiments.study.cluster import serve

        anyio.run(serve, options.cluster, lambda address: print(f"worker  {address}", flush=True, file=sys.stdout))
    else:
        raise typer.BadParameter("give the file of a cluster, or make one", param_hint="--cluster, --new")


for _command in (paper, phases, transfer, compare, doubt, certify, search, worker):
    study.command()(_command)
