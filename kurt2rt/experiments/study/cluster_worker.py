"""Worker of a cluster: one job at a time in this process."""

import logging
from collections.abc import Callable
from pathlib import Path

from distributed import Worker

from kurt2rt.experiments.study.cluster_file import no_scheduler, read_cluster_file

_TIMEOUT_S = 10.0


async def serve(file: Path, on_ready: Callable[[str], None]) -> None:
    """Run jobs until the scheduler is gone.

    Args:
        file: of the cluster.
        on_ready: gets the worker's address.

    Raises ClusterError if that is no file of a cluster, or no scheduler with its certificate answers.
    """
    address, security = read_cluster_file(file)
    logging.getLogger("distributed").setLevel(logging.WARNING)
    try:
        async with Worker(
            address, nthreads=1, protocol="tls", security=security, death_timeout=_TIMEOUT_S, dashboard=False
        ) as worker:
            worker.http_server.stop()  # Dask's pages about a worker, which any program could read
            on_ready(worker.address)
            try:
                await worker.finished()
            finally:  # closing breaks off a heartbeat, which Dask logs as an error with a traceback
                logging.getLogger("distributed.worker").setLevel(logging.CRITICAL)
    except (OSError, TimeoutError) as error:
        raise no_scheduler(file, address) from error
