"""Where the work on flights runs: Dask's workers, on this machine or on a cluster.

Started when there is work. Without an address it is a cluster of worker processes on the loopback
interface, encrypted with keys of its own, so that other users of the machine cannot send it tasks.
The engine may be lost at any time; who uses it asks again.
"""

from __future__ import annotations

import contextlib
import logging
import os
import pickle
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from padstudio.errors import SpecError
from padstudio.flights.cluster.task import Outcome, Task, configure, outcome_of, perform

if TYPE_CHECKING:
    from distributed import Client, Future

logger = logging.getLogger(__name__)

_CONNECT_S = 15


@dataclass(frozen=True, kw_only=True)
class EngineOptions:
    """How the engine is started.

    Attributes
    ----------
    scheduler : str or None
        Address of a scheduler, ``tls://host:8786``; None starts worker processes here.
    tls_ca, tls_cert, tls_key : str or None
        PEM files for a scheduler's address; None leaves it to Dask's own configuration.
    workers : int
        Processes here.
    worker_memory_bytes : int
        What each of them may take before it is ended.
    """

    scheduler: str | None = None
    tls_ca: str | None = None
    tls_cert: str | None = None
    tls_key: str | None = None
    workers: int = 2
    worker_memory_bytes: int = 3_000_000_000

    def __post_init__(self) -> None:
        check_scheduler(self.scheduler)


class Engine:
    """Runs tasks and says how they ended.

    Parameters
    ----------
    options : EngineOptions
    """

    def __init__(self, options: EngineOptions) -> None:
        self._options = options
        self._lock = threading.Lock()
        self._client: Client | None = None
        self._cluster: Any = None
        self._futures: dict[str, Future[Any]] = {}

    @property
    def capacity(self) -> int:
        """Tasks that can run at a time; starts the engine. At least 1."""
        if self._options.scheduler is None:
            self._started()
            return self._options.workers
        workers = self._started().scheduler_info(n_workers=-1)["workers"]
        return max(1, sum(int(worker["nthreads"]) for worker in workers.values()))

    def submit(self, key: str, task: Task, ended: Callable[[Outcome], None]) -> None:
        """Run a task.

        Parameters
        ----------
        key : str
            Names the task; never used twice.
        task : Task
        ended : callable
            Called once, from another thread.

        Raises
        ------
        OSError, TimeoutError
            If the engine cannot be started or reached.
        """
        client = self._started()
        # Crashes are counted by who calls, chunk by chunk.
        future = client.submit(perform, pickle.dumps(task), key, key=key, pure=False, retries=0)
        self._futures[key] = future
        future.add_done_callback(lambda done: self._ended(key, done, ended))

    def stop(self, key: str) -> None:
        """Tell a task to stop: at once where it waits, soon where it runs."""
        future = self._futures.get(key)
        if future is None or self._client is None or self._client.status != "running":
            return
        from distributed import Event

        with contextlib.suppress(Exception):
            Event(key, client=self._client).set()
        with contextlib.suppress(Exception):
            future.cancel()

    def restart_worker_of(self, key: str) -> None:
        """End the process that hangs in a task; its nanny starts another."""
        client = self._client
        if client is None:
            return
        with contextlib.suppress(Exception):
            addresses = [a for a, keys in client.processing().items() if key in keys]
            if addresses:
                client.restart_workers(addresses, timeout=30, raise_for_error=False)

    def tend(self) -> str | None:
        """Replace workers here that died while they started, which their nannies do not survive.

        Returns
        -------
        str or None
            A sentence where there is no worker, for who waits for one.
        """
        cluster, client = self._cluster, self._client
        if client is None or client.status != "running":
            return None
        if cluster is None:
            at_work = client.scheduler_info(n_workers=1)["workers"]
            return None if at_work else "no worker is connected to the scheduler; start some"
        at_work = cluster.scheduler_info["workers"]
        if len(at_work) < self._options.workers:
            cluster.loop.add_callback(_replace_failed, cluster, self._options.workers)
        return None if at_work else "no worker process is up; others are being started"

    def worker_pids(self) -> list[int]:
        """Process ids of the workers, for tests and for who watches over them."""
        return list(self._started().run(os.getpid).values())

    def is_lost(self) -> bool:
        """True where the engine was started and its scheduler is gone."""
        return self._client is not None and self._client.status not in ("running", "connecting")

    def close(self) -> None:
        """End the workers started here; tasks at work are lost."""
        with self._lock:
            client, cluster = self._client, self._cluster
            self._client = self._cluster = None
        for part in (client, cluster):
            if part is not None:
                with contextlib.suppress(Exception):
                    part.close(timeout=10)
        self._futures.clear()

    def _started(self) -> Client:
        with self._lock:
            if self._client is not None and self.is_lost():
                self._drop()
            if self._client is None:
                started = time.monotonic()
                self._start()
                logger.info("engine started in %.1f s", time.monotonic() - started)
            assert self._client is not None
            return self._client

    def _start(self) -> None:
        from distributed import Client, LocalCluster
        from distributed.security import Security

        configure()
        options = self._options
        if options.scheduler is not None:
            self._client = Client(
                options.scheduler,
                security=security_of(options),
                timeout=_CONNECT_S,
                set_as_default=False,
            )
            return
        security = Security.temporary()
        self._cluster = LocalCluster(
            n_workers=options.workers,
            threads_per_worker=1,
            processes=True,
            memory_limit=options.worker_memory_bytes,
            host="127.0.0.1",
            protocol="tls://",
            security=security,
            dashboard_address=None,
            preload=["padstudio.flights.cluster.priority"],
            worker_dashboard_address=None,
            # The scheduler serves its state in any case; a free port, as two studios may run.
            scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
            silence_logs=logging.ERROR,
        )
        self._client = Client(self._cluster, security=security, set_as_default=False)

    def _drop(self) -> None:
        client, cluster, self._client, self._cluster = self._client, self._cluster, None, None
        self._futures.clear()
        for part in (client, cluster):
            if part is not None:
                with contextlib.suppress(Exception):
                    part.close(timeout=2)

    def _ended(self, key: str, future: Future[Any], ended: Callable[[Outcome], None]) -> None:
        outcome = outcome_of(future)
        self._futures.pop(key, None)
        with contextlib.suppress(Exception):
            future.release()
        ended(outcome)


def _replace_failed(cluster: Any, workers: int) -> None:
    """Forget nannies that ended, and start others; in the cluster's own thread."""
    from distributed.core import Status

    for name, nanny in list(cluster.workers.items()):
        if nanny.status in (Status.failed, Status.closed):
            del cluster.workers[name]
    cluster.scale(workers)


def security_of(options: EngineOptions) -> Any:
    """Dask's security for a scheduler's address."""
    from distributed.security import Security

    given = {
        "tls_ca_file": options.tls_ca,
        "tls_client_cert": options.tls_cert,
        "tls_client_key": options.tls_key,
        "tls_worker_cert": options.tls_cert,
        "tls_worker_key": options.tls_key,
    }
    known = {name: value for name, value in given.items() if value is not None}
    return Security(**known, require_encryption=True)


def check_scheduler(address: str | None) -> None:
    """Refuse an address over which anybody could send tasks.

    Raises
    ------
    SpecError
        If it is not encrypted.
    """
    if address is not None and urlsplit(address).scheme != "tls":
        raise SpecError(
            f"the scheduler's address {address} is not encrypted, and tasks are programs: start it "
            "with TLS and give tls://host:port (PADSTUDIO_SCHEDULER)",
            code="invalid_setting",
        )
