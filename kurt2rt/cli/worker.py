"""`kurt2rt worker`."""

import sys
from dataclasses import dataclass
from typing import Annotated

import anyio
import typer

from kurt2rt.cli.command_options import takes_options


@dataclass(frozen=True, slots=True)
class _Options:
    """Options of `kurt2rt worker`."""

    to: Annotated[str, typer.Option("--to", metavar="ADDRESS", help="Scheduler, such as tls://lab:8786.")]


@takes_options(_Options)
def worker(options: _Options) -> None:
    """Run jobs of studies that another machine sends, one at a time, until Ctrl-C.

    Start one for each processor. A scheduler of Dask (`dask scheduler`) passes
    the jobs on; `kurt2rt paper --on ADDRESS` sends them. Jobs are Python
    programs, so the address is TLS or of this machine; Dask's configuration
    names the certificates.

    For example:

        dask scheduler --host 127.0.0.1
        kurt2rt worker --to tcp://127.0.0.1:8786
        kurt2rt paper --on tcp://127.0.0.1:8786
    """
    # Not at the top: Dask is an extra, and every command is loaded where --help is said.
    from kurt2rt.experiments.study.cluster_worker import serve

    anyio.run(serve, options.to, lambda address: print(f"worker  {address}", flush=True, file=sys.stdout))
