"""Uploads behind an S3 server: copied there by the server, read from there by worker processes."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import flight_orders
import httpx
import numpy as np
import pytest
import videos

from padstudio.errors import StorageError
from padstudio.flights.cluster.local import LocalEngine
from padstudio.flights.service import FlightOptions, FlightService
from padstudio.media.remote import Storage, open_source
from padstudio.media.video_frames import read_frames
from padstudio.media.video_index import read_index
from padstudio.store.store import Store
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool

FRAMES = 24


@pytest.fixture(scope="module")
def bucket() -> Iterator[str]:
    """URL of a bucket of a server of our own."""
    import fsspec

    command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", "0"]
    server = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    environment = pytest.MonkeyPatch()
    try:
        address = _address(server)
        _wait(address)
        environment.setenv("AWS_ENDPOINT_URL", address)
        environment.setenv("AWS_ACCESS_KEY_ID", "tests")
        environment.setenv("AWS_SECRET_ACCESS_KEY", "tests")
        environment.setenv("AWS_DEFAULT_REGION", "us-east-1")
        fsspec.filesystem("s3").mkdir("studio")
        yield "s3://studio/flights"
    finally:
        environment.undo()
        server.terminate()
        server.communicate(timeout=60)


def _address(server: subprocess.Popen[str]) -> str:
    """The address that the server tells on stderr when it has found a free port."""
    assert server.stderr is not None
    for line in server.stderr:
        if "Running on " in line:
            return line.split("Running on ")[1].split()[0]
    raise AssertionError("the S3 server did not start")


def _wait(address: str) -> None:
    end = time.monotonic() + 60
    while True:
        with contextlib.suppress(httpx.TransportError):
            httpx.get(address)
            return
        assert time.monotonic() < end
        time.sleep(0.05)


def test_a_video_in_a_bucket_is_read_as_one_on_the_disk(bucket: str, tmp_path: Path) -> None:
    video = videos.write(tmp_path / "a.mp4", FRAMES, keyframe_every=8)
    url = Storage(bucket).place(video)
    assert url == f"{bucket}/a.mp4"
    here, there = read_index(str(video)), read_index(url)
    np.testing.assert_array_equal(there.pts, here.pts)
    wanted = here.pts[[5, 6, 17]].tolist()
    pairs = zip(read_frames(url, wanted), read_frames(str(video), wanted), strict=True)
    for remote, local in pairs:
        assert remote.bgr is not None
        np.testing.assert_array_equal(remote.bgr, local.bgr)


def test_a_flight_is_read_from_a_bucket(bucket: str, tmp_path: Path) -> None:
    store = Store(tmp_path / "data")
    video = videos.write(tmp_path / "a.mp4", FRAMES, keyframe_every=8, paint=videos.blank)
    upload = flight_orders.upload(store, video)
    pool = WorkerPool(1, Limits(1_000_000_000), max_waiting=0)
    service = FlightService(
        store.session,
        store.uploads,
        LocalEngine(pool),
        Storage(bucket),
        FlightOptions(pictures=tmp_path / "pictures"),
    )
    service.start()
    try:
        flight = service.order(flight_orders.order(upload))
        end = time.monotonic() + 120
        while (found := service.flights.get(flight.id)).state in ("queued", "running"):
            assert time.monotonic() < end
            time.sleep(0.05)
        assert (found.state, found.frames_done, found.error) == ("done", FRAMES, None)
        assert found.sources[0]["url"].startswith(bucket)
    finally:
        service.close()
        pool.close()
        store.close()


def test_a_bucket_that_is_not_there(bucket: str, tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"frames")
    with pytest.raises(StorageError, match="cannot copy an upload to s3://nobodys"):
        Storage("s3://nobodys-bucket").place(tmp_path / "a")
    with pytest.raises(StorageError, match="PADSTUDIO_STORAGE"), open_source(f"{bucket}/none"):
        raise AssertionError("there is nothing to open")
