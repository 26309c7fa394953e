"""--on, with one meaning in every study: workers on other machines run the jobs."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

from kurt2rt.experiments.study.local_executor import open_processes
from kurt2rt.experiments.study.plan import Executor

OnOption = Annotated[
    str | None,
    typer.Option(
        "--on",
        metavar="ADDRESS",
        help="Run the jobs on the workers of this scheduler (kurt2rt worker), such as tls://lab:8786; local: start "
        "one here with --jobs workers.",
        show_default=False,
    ),
]


@contextmanager
def open_executor(address: str | None, jobs: int) -> Iterator[Executor]:
    """Yield the executor of --on; without it, one with processes of this machine.

    `jobs`: number of processes, or of workers of `local`. Raises ClusterError if no scheduler answers, or the address
    is not safe.
    """
    if address is None:
        with open_processes(jobs) as local:
            yield local
        return
    # Not at the top: Dask is an extra, and takes a second.
    from kurt2rt.experiments.study.cluster import open_cluster

    with open_cluster(address, jobs) as executor:
        yield executor
