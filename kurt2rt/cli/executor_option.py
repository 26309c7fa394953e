"""--on, with one meaning in every study: workers on other machines run the jobs."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.experiments.study.local_executor import open_processes
from kurt2rt.experiments.study.plan import Executor

OnOption = Annotated[
    Path | None,
    typer.Option(
        "--on",
        metavar="FILE",
        help="Run the jobs on the workers of the cluster of this file (kurt2rt study worker --new makes one).",
        show_default=False,
    ),
]


@contextmanager
def open_executor(cluster: Path | None, jobs: int) -> Iterator[Executor]:
    """Yield the executor of --on; without it, one with processes of this machine.

    `jobs`: number of these processes. Raises ClusterError if `cluster` is no file of a cluster, or no scheduler of it
    answers.
    """
    if cluster is None:
        with open_processes(jobs) as local:
            yield local
        return
    # Not at the top: Dask is an extra, and takes a second.
    from kurt2rt.experiments.study.cluster import open_cluster

    with open_cluster(cluster) as executor:
        yield executor
