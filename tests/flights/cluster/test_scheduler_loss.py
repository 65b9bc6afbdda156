"""A cluster whose scheduler is killed while flights are at work: nothing is lost or taken twice."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from pathlib import Path
from urllib.parse import urlsplit

import cluster_processes
import flight_orders
import videos

from padstudio.flights.cluster.engine import Cluster, ClusterEngine
from padstudio.flights.results.frames import Results
from padstudio.flights.service import FlightOptions, FlightService
from padstudio.flights.tasks.from_rows import WorkLimits
from padstudio.media.remote import Storage
from padstudio.store.store import Store

FLIGHTS, FRAMES = 16, 6


def wait_until(reached: Callable[[], bool]) -> None:
    end = time.monotonic() + 180
    while not reached():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_all_that_is_unfinished_is_done_by_the_next_scheduler(tmp_path: Path) -> None:
    tls = cluster_processes.certificates(tmp_path)
    with contextlib.ExitStack() as stack:
        first, address = stack.enter_context(cluster_processes.scheduler(tls, tmp_path))
        lent = stack.enter_context(cluster_processes.worker(tls, address))
        store = Store(tmp_path / "data")
        stack.callback(store.close)
        video = videos.write(tmp_path / "a.mp4", FRAMES, keyframe_every=3, paint=videos.blank)
        upload = flight_orders.upload(store, video)
        service = FlightService(
            store.session,
            store.uploads,
            ClusterEngine(
                Cluster(
                    scheduler=address, tls_ca=tls["ca"], tls_cert=tls["cert"], tls_key=tls["key"]
                )
            ),
            Storage(str(tmp_path / "shared")),
            FlightOptions(pictures=tmp_path / "pictures", limits=WorkLimits(chunk_frames=3)),
        )
        stack.callback(service.close)
        service.start()
        for _ in range(FLIGHTS):
            service.order(flight_orders.order(upload))

        def done() -> int:
            return service.flights.list(1, 0, "done")[1]

        wait_until(lambda: done() >= 3)
        first.kill()
        first.wait()
        # Workers leave with their scheduler, so that whoever keeps them starts fresh ones.
        lent.wait(cluster_processes.PATIENCE_S)
        before = done()
        assert before < FLIGHTS
        port = urlsplit(address).port or 0
        stack.enter_context(cluster_processes.scheduler(tls, tmp_path, port))
        stack.enter_context(cluster_processes.worker(tls, address))
        wait_until(lambda: done() == FLIGHTS)
        results = Results(store.session)
        for flight in service.flights.list(FLIGHTS, 0)[0]:
            assert (flight.frames_done, flight.error) == (FRAMES, None)
            assert [record["frame"] for record in results.every(flight)] == list(range(FRAMES))
