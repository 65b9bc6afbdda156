"""``padstudio worker``: processes of this machine for a cluster."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import Annotated, Any

import typer

from padstudio.cli.support import note
from padstudio.flights.cluster.engine import Cluster
from padstudio.flights.cluster.worker import lend_workers

_EXAMPLES = (
    "Example: [bold]padstudio worker tls://studio.example:8786 --ca ca.pem --cert me.pem "
    "--key me.key[/]. A plain [bold]dask worker --nthreads 1[/] in an environment with padstudio "
    "works as well."
)


Scheduler = Annotated[
    str, typer.Argument(envvar="PADSTUDIO_SCHEDULER", help="Scheduler's address, tls://host:port.")
]
Jobs = Annotated[
    int,
    typer.Option("-j", "--jobs", min=0, max=256, help="Processes; 0 takes one for every core."),
]
Memory = Annotated[int, typer.Option(min=500, help="Memory that each of them may take, MB.")]
Idle = Annotated[
    float,
    typer.Option(
        "--idle-s",
        min=1,
        envvar="PADSTUDIO_WORKER_IDLE_SECONDS",
        help="After so long without a task a process gives its memory back.",
    ),
]


def _pem(variable: str, holds: str) -> Any:
    """An option for a PEM file."""
    return typer.Option(
        envvar=f"PADSTUDIO_SCHEDULER_{variable}",
        exists=True,
        dir_okay=False,
        help=f"PEM file of {holds}.",
    )


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(worker)


def worker(
    scheduler: Scheduler,
    ca: Annotated[Path | None, _pem("CA", "the authority that the certificates are of")] = None,
    cert: Annotated[Path | None, _pem("CERT", "this machine's certificate")] = None,
    key: Annotated[Path | None, _pem("KEY", "its key")] = None,
    jobs: Jobs = 0,
    memory_mb: Memory = 3000,
    idle_s: Idle = 600,
) -> None:
    """Work on flights for a cluster's scheduler until it ends, or Ctrl-C.

    The server is given the same scheduler by PADSTUDIO_SCHEDULER. Workers read uploads from where
    PADSTUDIO_STORAGE says, which has to be reached under the same name from here.
    """
    cluster = Cluster(
        scheduler=scheduler,
        tls_ca=str(ca) if ca else None,
        tls_cert=str(cert) if cert else None,
        tls_key=str(key) if key else None,
    )
    with contextlib.suppress(KeyboardInterrupt):
        lend_workers(
            cluster,
            jobs or os.cpu_count() or 1,
            memory_mb * 1_000_000,
            idle_s,
            joined=lambda count: note(f"{count} workers joined {scheduler} (Ctrl-C ends them)"),
        )
