"""Tasks in the workers of a cluster, by Dask; started when there is work."""

from __future__ import annotations

import asyncio
import concurrent.futures
import contextlib
import logging
import pickle
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from padstudio.errors import SpecError
from padstudio.flights.cluster.task import Kind, Outcome, Task, crashed, outcome, perform

if TYPE_CHECKING:
    from distributed import Client, Future

logger = logging.getLogger(__name__)

# Until a scheduler that does not answer is given up.
_CONNECT_S = 15
# How often a task asks whether it is to stop; the question goes to the scheduler and back.
_ASK_EVERY_S = 0.25


@dataclass(frozen=True, kw_only=True)
class Cluster:
    """Where a cluster's scheduler is.

    Attributes
    ----------
    scheduler : str
        Its address, ``tls://host:8786``.
    tls_ca, tls_cert, tls_key : str or None
        PEM files; None leaves them to Dask's own configuration.
    """

    scheduler: str
    tls_ca: str | None = None
    tls_cert: str | None = None
    tls_key: str | None = None

    def __post_init__(self) -> None:
        check_scheduler(self.scheduler)


class ClusterEngine:
    """An `Engine` of a scheduler's workers.

    Parameters
    ----------
    cluster : Cluster
    """

    def __init__(self, cluster: Cluster) -> None:
        self._cluster = cluster
        self._lock = threading.Lock()
        self._client: Client | None = None
        self._futures: dict[str, Future[Any]] = {}

    def room(self, at_work: int) -> int:
        """As of `Engine`; reaches for the scheduler where there is something at work."""
        if not at_work:
            return 1
        workers = self._started().scheduler_info(n_workers=-1)["workers"]
        # A task that waited beside another would be blamed for the death of its worker.
        return max(1, sum(int(worker["nthreads"]) for worker in workers.values())) - at_work

    def submit(self, key: str, task: Task, ended: Callable[[Outcome], None]) -> None:
        """As of `Engine`."""
        client = self._started()
        # Crashes are counted by who calls, chunk by chunk.
        future = client.submit(_perform, pickle.dumps(task), key, key=key, pure=False, retries=0)
        self._futures[key] = future
        future.add_done_callback(lambda done: self._ended(key, done, ended))

    def stop(self, key: str) -> None:
        """As of `Engine`."""
        future = self._futures.get(key)
        if future is None or self._client is None or self._client.status != "running":
            return
        from distributed import Event

        with contextlib.suppress(Exception):
            Event(key, client=self._client).set()
        with contextlib.suppress(Exception):
            future.cancel()

    def end_worker_of(self, key: str) -> None:
        """As of `Engine`; its nanny starts another."""
        client = self._client
        if client is None:
            return
        with contextlib.suppress(Exception):
            addresses = [a for a, keys in client.processing().items() if key in keys]
            if addresses:
                client.restart_workers(addresses, timeout=30, raise_for_error=False)

    def tend(self) -> str | None:
        """As of `Engine`; whoever lends workers sees to them."""
        client = self._client
        if client is None or client.status != "running":
            return None
        at_work = client.scheduler_info(n_workers=1)["workers"]
        return None if at_work else "no worker is connected to the scheduler; start some"

    def is_lost(self) -> bool:
        """True where the engine was started and its scheduler is gone."""
        return self._client is not None and self._client.status not in ("running", "connecting")

    def rest(self) -> None:
        """As of `Engine`: the connection to the scheduler, which never stands still."""
        self.close()

    def close(self) -> None:
        """As of `Engine`."""
        with self._lock:
            self._drop(timeout_s=10)

    def _started(self) -> Client:
        with self._lock:
            if self._client is not None and self.is_lost():
                self._drop(timeout_s=2)
            if self._client is None:
                started = time.monotonic()
                self._client = self._connect()
                logger.info("the scheduler was reached in %.1f s", time.monotonic() - started)
            return self._client

    def _connect(self) -> Client:
        from distributed import Client

        configure()
        return Client(
            self._cluster.scheduler,
            security=security_of(self._cluster),
            timeout=_CONNECT_S,
            set_as_default=False,
        )

    def _drop(self, timeout_s: float) -> None:
        client, self._client = self._client, None
        self._futures.clear()
        if client is not None:
            with contextlib.suppress(Exception):
                client.close(timeout=timeout_s)

    def _ended(self, key: str, future: Future[Any], ended: Callable[[Outcome], None]) -> None:
        found = _outcome_of(future)
        self._futures.pop(key, None)
        with contextlib.suppress(Exception):
            future.release()
        ended(found)


def security_of(cluster: Cluster) -> Any:
    """Dask's security for a scheduler's address."""
    from distributed.security import Security

    given = {
        "tls_ca_file": cluster.tls_ca,
        "tls_client_cert": cluster.tls_cert,
        "tls_client_key": cluster.tls_key,
        "tls_worker_cert": cluster.tls_cert,
        "tls_worker_key": cluster.tls_key,
    }
    known = {name: value for name, value in given.items() if value is not None}
    return Security(**known, require_encryption=True)


def check_scheduler(address: str) -> None:
    """Refuse an address over which anybody could send tasks.

    Raises
    ------
    SpecError
        If it is not encrypted.
    """
    if urlsplit(address).scheme != "tls":
        raise SpecError(
            f"the scheduler's address {address} is not encrypted, and tasks are programs: start it "
            "with TLS and give tls://host:port (PADSTUDIO_SCHEDULER)",
            code="invalid_setting",
        )


def configure() -> None:
    """Set what every client and worker of ours needs."""
    import dask

    dask.config.set(
        {
            # One task a worker: a dead worker is blamed on the task that it worked on.
            "distributed.scheduler.worker-saturation": 1.0,
            "distributed.scheduler.allowed-failures": 0,
            "distributed.worker.memory.target": False,
            "distributed.worker.memory.spill": False,
            "distributed.worker.memory.pause": False,
            # Stacks sampled a hundred times a second, and kept for an hour.
            "distributed.worker.profile.enabled": False,
            # For what it measures of itself an idle worker would wake 62 times a second.
            "distributed.admin.tick.interval": "1s",
            "distributed.admin.system-monitor.interval": "10s",
            "distributed.admin.system-monitor.disk": False,
            "distributed.worker.memory.monitor-interval": "500ms",
            "distributed.admin.large-graph-warning-threshold": "1GB",
            # Large frames come and go; giving their memory back each time costs a sixth.
            "distributed.nanny.pre-spawn-environ": {
                "MALLOC_TRIM_THRESHOLD_": 268435456,
                "MALLOC_MMAP_THRESHOLD_": 268435456,
                "OMP_NUM_THREADS": 1,
                "MKL_NUM_THREADS": 1,
                "OPENBLAS_NUM_THREADS": 1,
            },
        }
    )


def _perform(packed: bytes, stop: str) -> tuple[Kind, Any]:
    return perform(packed, _stop_signal(stop))


def _stop_signal(name: str) -> Callable[[], bool]:
    from distributed import Event

    event = Event(name)
    asked, answer = time.monotonic(), False

    def stopped() -> bool:
        nonlocal asked, answer
        if time.monotonic() - asked >= _ASK_EVERY_S:
            asked, answer = time.monotonic(), bool(event.is_set())
        return answer

    return stopped


def _outcome_of(future: Future[Any]) -> Outcome:
    from distributed.scheduler import KilledWorker

    try:
        return outcome(*future.result(timeout=60))
    except KilledWorker:
        return crashed()
    except (asyncio.CancelledError, concurrent.futures.CancelledError):
        return Outcome("lost")
    except Exception as error:
        if future.status == "error":
            logger.exception("a task brought a defect to light")
            return crashed(error)
        return Outcome("lost")
