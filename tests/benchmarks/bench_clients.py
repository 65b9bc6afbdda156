#!/usr/bin/env python3
"""How soon many clients are answered while two flights run: milliseconds of each address.

    bench_clients.py [--clients N] [--seconds N] [--frames N] [--json FILE]

A server of its own works on flights of the footage. Each client asks for pages and results, one
address after the other, with a pause as a reader makes one. Among what they ask for is a made-up
flight of many frames that has ended. Beside the times stands what the server's process itself took
of a processor for each answer, which other work on the machine does not change.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import numpy as np
from bench_results import fill
from studio_server import LANDING, OPEN, order, serving

from padstudio.store.database.engine import Sessions, open_database, sqlite_url

#: What 95 % of the answers shall take at most, ms.
WANTED_MS = 500.0
_PAUSE_S = (0.5, 1.5)
_ORDERED_AHEAD = 40


def addresses(flight: str, long: str) -> dict[str, str]:
    """What clients ask for, of a flight that runs and of a long one that has ended."""
    return {
        "first page": "/",
        "page of flights": "/flights",
        "page of a flight": f"/flights/{flight.rsplit('/', 1)[1]}",
        "flights": "/api/v1/flights",
        "flight": flight,
        "frames, a page of 25": f"{flight}/frames?limit=25",
        "frame": f"{flight}/frames/3",
        "timeline": f"{flight}/timeline?columns=800",
        "figures": f"{flight}/figures",
        "summary": f"{flight}/summary",
        "long: summary": f"{long}/summary",
        "long: timeline": f"{long}/timeline?columns=800",
        "long: timeline, a part": f"{long}/timeline?columns=800&first_frame=0&last_frame=9999",
        "long: failed frames": f"{long}/frames?limit=25&status=failed",
    }


class Clients:
    """Clients that ask until they are told to stop, each in a thread."""

    def __init__(self, base: httpx.URL, places: dict[str, str], clients: int) -> None:
        self._base, self._places = base, places
        self._stopped = threading.Event()
        self.taken_ms: dict[str, list[float]] = defaultdict(list)
        self.failed: dict[int, int] = defaultdict(int)
        self._threads = [threading.Thread(target=self._ask, args=(k,)) for k in range(clients)]

    def run(self, seconds: float) -> None:
        """Let them ask for so long."""
        for thread in self._threads:
            thread.start()
        time.sleep(seconds)
        self._stopped.set()
        for thread in self._threads:
            thread.join()

    def _ask(self, number: int) -> None:
        chance = random.Random(number)
        names = list(self._places)
        with httpx.Client(base_url=self._base, timeout=60, trust_env=False) as client:
            while not self._stopped.wait(chance.uniform(*_PAUSE_S)):
                name = chance.choice(names)
                start = time.perf_counter()
                answer = client.get(self._places[name])
                self.taken_ms[name].append(1e3 * (time.perf_counter() - start))
                if answer.is_error:
                    self.failed[answer.status_code] += 1


def costs_ms(
    client: httpx.Client, places: dict[str, str], cpu: Callable[[], float], times: int
) -> dict[str, float]:
    """What the server's process takes of a processor for an answer of each address, ms."""
    found = {}
    for name, place in places.items():
        client.get(place).raise_for_status()
        start = cpu()
        for _ in range(times):
            client.get(place).raise_for_status()
        found[name] = 1e3 * (cpu() - start) / times
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description="Answers for many clients while flights run.")
    parser.add_argument("--clients", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--frames", type=int, default=1_000_000, help="of the flight that is over")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "data"
        data.mkdir()
        engine = open_database(sqlite_url(data / "padstudio.db"))
        fill(Sessions(engine), given.frames)
        engine.dispose()
        with serving(data) as (client, process):

            def cpu() -> float:
                used = process.cpu_times()
                return float(used.user + used.system)

            flights = order(client, LANDING, _ORDERED_AHEAD)
            while client.get(flights[0]).json()["frames_done"] == 0:
                time.sleep(0.1)
            places = addresses(flights[0], "/api/v1/flights/long")
            clients = Clients(client.base_url, places, given.clients)
            clients.run(given.seconds)
            assert client.get(flights[-1]).json()["state"] in OPEN, "the flights ended too soon"
            costs = costs_ms(client, places, cpu, times=50)
    report = _report(clients, costs)
    if given.json:
        given.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    return int(bool(clients.failed))


def _report(clients: Clients, costs: dict[str, float]) -> dict[str, Any]:
    every = [ms for each in clients.taken_ms.values() for ms in each]
    report: dict[str, Any] = {}
    print("| address | answers | median, ms | 95 %, ms | most, ms | CPU an answer, ms |")
    print("|---|---|---|---|---|---|")
    for name, ms in [*sorted(clients.taken_ms.items()), ("all", every)]:
        p50, p95, most = np.percentile(ms, [50, 95, 100])
        cost = costs.get(name, float(np.mean(list(costs.values()))))
        report[name] = {"answers": len(ms), "p50_ms": p50, "p95_ms": p95, "cpu_ms": cost}
        print(f"| {name} | {len(ms)} | {p50:.0f} | {p95:.0f} | {most:.0f} | {cost:.1f} |")
    within = 100 * float(np.mean(np.array(every) <= WANTED_MS))
    print(f"{within:.1f} % within {WANTED_MS:.0f} ms; errors: {dict(clients.failed)}")
    return report


if __name__ == "__main__":
    sys.exit(main())
