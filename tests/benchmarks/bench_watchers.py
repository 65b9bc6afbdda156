#!/usr/bin/env python3
"""What event streams cost a server: its processor time with few and with many of them.

    bench_watchers.py [--streams N …] [--seconds S]

Two long flights are read, and so many streams watch them, half each. Told is the processor time of
the server's own process, without its workers, and how often the watchers were told something.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import resource
import sys
import tempfile
import time
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import psutil
import studio_server
from looped import looped

# A thousand streams may cost so many times what ten do, or so little of a core.
_MOST_RATIO, _MOST_SHARE = 2.0, 0.10


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--streams", type=int, nargs="+", default=[10, 1000])
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--minutes", type=float, default=10.0, help="length of each flight")
    given = parser.parse_args()
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4 * max(given.streams) + 100), hard))
    with (
        tempfile.TemporaryDirectory() as folder,
        studio_server.serving(Path(folder), os.environ) as (client, server),
    ):
        video = looped(studio_server.LANDING, Path(folder) / "long.mp4", minutes=given.minutes)
        flights = studio_server.order(client, video, flights=2)
        shares = [_share(client, server, flights, n, given.seconds) for n in given.streams]
    is_cheap = shares[-1] <= max(_MOST_RATIO * shares[0], _MOST_SHARE)
    return int(not is_cheap)


def _share(
    client: httpx.Client, server: psutil.Process, flights: list[str], streams: int, seconds: float
) -> float:
    """The share of a core that the server takes, printed."""
    return asyncio.run(_measure(client, server, flights, streams, seconds))


async def _measure(
    client: httpx.Client, server: psutil.Process, flights: list[str], streams: int, seconds: float
) -> float:
    address = urlsplit(str(client.base_url))
    told = [0]
    reads = [
        asyncio.create_task(_watch(address.hostname or "", address.port or 80, path, told))
        for path in (flights * streams)[:streams]
    ]
    # Each is told something at once; that all are there is what is measured.
    while told[0] < streams:
        await asyncio.sleep(0.1)
    await asyncio.sleep(3.0)
    before_s, told[0], begun_s = _processor_s(server), 0, time.monotonic()
    while time.monotonic() - begun_s < seconds:
        await asyncio.sleep(1.0)
    elapsed_s = time.monotonic() - begun_s
    share = (_processor_s(server) - before_s) / elapsed_s
    open_streams = sum(not read.done() for read in reads)
    print(
        f"{streams:5d} streams: {100 * share:.1f} % of a core, {told[0] / elapsed_s:.0f} reads a "
        f"second; {open_streams} open at the end",
        flush=True,
    )
    for read in reads:
        read.cancel()
    await asyncio.gather(*reads, return_exceptions=True)
    return share


async def _watch(host: str, port: int, flight: str, told: list[int]) -> None:
    """Follow a flight until it is over."""
    reader, writer = await asyncio.open_connection(host, port)
    try:
        writer.write(f"GET {flight}/events HTTP/1.1\r\nHost: {host}:{port}\r\n\r\n".encode())
        while await reader.read(65536):
            told[0] += 1
    finally:
        writer.close()


def _processor_s(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


if __name__ == "__main__":
    sys.exit(main())
