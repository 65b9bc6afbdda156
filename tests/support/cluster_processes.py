"""A scheduler and lent workers as processes, for tests of a cluster."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from distributed.security import Security

PROGRAM = "from padstudio.cli.program import main; main()"
PATIENCE_S = 60


def certificates(folder: Path) -> dict[str, str]:
    """PEM files of a certificate that is its own authority: ``ca``, ``cert``, ``key``."""
    security = Security.temporary()
    files = {"ca": security.tls_ca_file, "cert": security.tls_client_cert}
    files["key"] = security.tls_client_key
    for name, content in files.items():
        (folder / f"{name}.pem").write_text(str(content))
    return {name: str(folder / f"{name}.pem") for name in files}


@contextlib.contextmanager
def scheduler(
    tls: dict[str, str], folder: Path, port: int = 0
) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """A scheduler's process and address; port 0 takes a free one."""
    address_file = folder / "scheduler.json"
    address_file.unlink(missing_ok=True)
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--protocol", "tls"]
    command += ["--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
    command += ["--tls-ca-file", tls["ca"], "--tls-cert", tls["cert"], "--tls-key", tls["key"]]
    command += ["--scheduler-file", str(address_file)]
    with running(command) as process:
        wait_for(address_file)
        description: dict[str, Any] = json.loads(address_file.read_text())
        yield process, str(description["address"])


@contextlib.contextmanager
def worker(
    tls: dict[str, str], address: str, options: Sequence[str] = ()
) -> Iterator[subprocess.Popen[bytes]]:
    """``padstudio worker`` with one process."""
    command = [sys.executable, "-c", PROGRAM, "worker", address, "--jobs", "1", *options]
    command += ["--ca", tls["ca"], "--cert", tls["cert"], "--key", tls["key"]]
    with running(command) as process:
        yield process


@contextlib.contextmanager
def plain_worker(tls: dict[str, str], address: str) -> Iterator[subprocess.Popen[bytes]]:
    """Dask's own ``dask worker`` with one process."""
    command = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-dashboard"]
    command += ["--nworkers", "1", "--nthreads", "1"]
    command += ["--tls-ca-file", tls["ca"], "--tls-cert", tls["cert"], "--tls-key", tls["key"]]
    with running(command) as process:
        yield process


@contextlib.contextmanager
def running(command: list[str]) -> Iterator[subprocess.Popen[bytes]]:
    """A process that is ended with the context."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.terminate()
        process.wait(PATIENCE_S)


def wait_for(path: Path) -> None:
    """Wait until a file is there; one with a suffix must hold something."""
    end = time.monotonic() + PATIENCE_S
    while not path.exists() or (path.suffix and not path.stat().st_size):
        assert time.monotonic() < end
        time.sleep(0.01)
