"""Worker of a cluster: one job at a time in this process."""

import logging
from collections.abc import Callable

from distributed import Worker

from kurt2rt.experiments.study.cluster import ClusterError, require_safe

_TIMEOUT_S = 10.0


async def serve(scheduler: str, on_ready: Callable[[str], None]) -> None:
    """Run jobs until the scheduler is gone; `on_ready` gets the worker's address.

    Raises ClusterError if the address is not safe, or no scheduler answers there.
    """
    require_safe(scheduler)
    logging.getLogger("distributed").setLevel(logging.WARNING)
    protocol = scheduler.partition("://")[0]
    host = "127.0.0.1" if protocol == "tcp" else None
    try:
        async with Worker(
            scheduler, nthreads=1, protocol=protocol, host=host, death_timeout=_TIMEOUT_S, dashboard=False
        ) as worker:
            on_ready(worker.address)
            try:
                await worker.finished()
            finally:  # closing breaks off a heartbeat, which Dask logs as an error with a traceback
                logging.getLogger("distributed.worker").setLevel(logging.CRITICAL)
    except (OSError, TimeoutError) as error:
        raise ClusterError("no scheduler answers", where=scheduler, do="start one there: dask scheduler") from error
