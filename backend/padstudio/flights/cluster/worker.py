"""Worker processes of this machine, lent to a cluster's scheduler."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from padstudio.errors import StudioError
from padstudio.flights.cluster.engine import Cluster, configure, security_of

# Until all processes have joined; their imports take most of it.
_CONNECT_S = 30


class ClusterError(StudioError):
    """The scheduler cannot be reached."""

    code = "no_scheduler"
    exit_code = 2


def lend_workers(
    cluster: Cluster,
    workers: int,
    memory_bytes: int,
    idle_s: float,
    *,
    joined: Callable[[int], None],
) -> None:
    """Work for a scheduler until it ends or the process is interrupted.

    Parameters
    ----------
    cluster : Cluster
    workers : int
        Processes.
    memory_bytes : int
        What each of them may take before it is ended.
    idle_s : float
        After so long without a task a process gives its memory back: another takes its place.
    joined : callable
        Called with the number of processes once all have joined.

    Raises
    ------
    ClusterError
        If the scheduler cannot be reached, or does not take the certificate.
    """
    configure()
    logging.getLogger("distributed").setLevel(logging.ERROR)
    nannies = [partial(_nanny, cluster, memory_bytes, idle_s)] * workers
    asyncio.run(_lend(cluster, nannies, joined))


async def _lend(
    cluster: Cluster, made: Sequence[Callable[[], Any]], joined: Callable[[int], None]
) -> None:
    nannies = [make() for make in made]
    try:
        try:
            await asyncio.wait_for(asyncio.gather(*nannies), _CONNECT_S)
        except (OSError, TimeoutError, RuntimeError) as error:
            raise ClusterError(
                f"no scheduler answers at {cluster.scheduler}: check the address, that dask "
                f"scheduler runs there, and the certificates ({error or 'time is over'})"
            ) from error
        joined(len(nannies))
        # Workers leave when the scheduler does; whoever keeps them running starts them again.
        await asyncio.gather(*(nanny.finished() for nanny in nannies))
    finally:
        await asyncio.gather(*(nanny.close(timeout=5) for nanny in nannies), return_exceptions=True)


def _nanny(cluster: Cluster, memory_bytes: int, idle_s: float) -> Any:
    from distributed import Nanny

    from padstudio.flights.cluster.idle import RestartIdle

    return Nanny(
        cluster.scheduler,
        nthreads=1,
        memory_limit=memory_bytes,
        security=security_of(cluster),
        dashboard=False,
        plugins=(RestartIdle(idle_s),),
    )
