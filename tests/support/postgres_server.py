"""A PostgreSQL of the tests' own: a cluster in a temporary folder, reached by its socket alone."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import psycopg
from sqlalchemy import make_url

OWNER = "padstudio"
# Where distributions and Homebrew keep a server's programs, which are on no PATH.
FOLDERS = ("/usr/lib/postgresql", "/usr/pgsql", "/opt/homebrew/opt", "/usr/local/opt")


def program(name: str) -> str:
    """Path of one of PostgreSQL's programs; the newest where there are several."""
    found = shutil.which(name)
    if found:
        return found
    places = [path for folder in FOLDERS for path in Path(folder).glob(f"*/bin/{name}")]
    assert places, f"{name} of PostgreSQL is missing; tests/install-tools.sh installs it"
    return str(max(places))


@contextlib.contextmanager
def running() -> Iterator[str]:
    """URL of a server's database; that of PADSTUDIO_TEST_POSTGRESQL where it is set."""
    given = os.environ.get("PADSTUDIO_TEST_POSTGRESQL")
    if given:
        yield given
        return
    # Not in pytest's own folders, which are closed to other users.
    with tempfile.TemporaryDirectory(prefix="padstudio-pg-") as name:
        cluster = Cluster(Path(name))
        cluster.start()
        try:
            yield cluster.url
        finally:
            cluster.stop()


class Cluster:
    """A server's files, and the server while it runs.

    Parameters
    ----------
    folder : Path
        Empty, and open to other users, as PostgreSQL refuses to run as root.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._user = "nobody" if os.geteuid() == 0 else None
        self._process: subprocess.Popen[bytes] | None = None
        self.url = f"postgresql://{OWNER}@/postgres?host={folder}"
        if self._user:
            shutil.chown(folder, self._user)
        data = ["-D", str(folder / "data")]
        initialize = [program("initdb"), *data, "-U", OWNER, "-A", "trust", "--no-sync"]
        subprocess.run(
            initialize, user=self._user, cwd=folder, check=True, stdout=subprocess.DEVNULL
        )
        self._command = [program("postgres"), *data, "-k", str(folder)]
        self._command += ["-c", "listen_addresses=", "-c", "fsync=off", "-c", "max_connections=50"]

    def start(self) -> None:
        """Start the server, and wait until it answers."""
        with (self._folder / "log").open("ab") as log:
            self._process = subprocess.Popen(
                self._command, user=self._user, cwd=self._folder, stderr=log
            )
        _wait(self.url, self._process)

    def stop(self, how: signal.Signals = signal.SIGINT) -> None:
        """End the server: SIGINT ends sessions, SIGQUIT breaks off as a crash does."""
        assert self._process is not None
        self._process.send_signal(how)
        self._process.wait(60)


def _wait(url: str, process: subprocess.Popen[bytes]) -> None:
    end = time.monotonic() + 60
    while True:
        try:
            psycopg.connect(url).close()
            return
        except psycopg.OperationalError:
            assert process.poll() is None
            assert time.monotonic() < end
            time.sleep(0.05)


def create(server: str, name: str) -> str:
    """Make a database; its URL."""
    _execute(server, f'CREATE DATABASE "{name}"')
    return make_url(server).set(database=name).render_as_string(hide_password=False)


def drop(server: str, name: str) -> None:
    """Remove a database, whoever is still connected."""
    _execute(server, f'DROP DATABASE "{name}" WITH (FORCE)')


def _execute(server: str, statement: str) -> None:
    with contextlib.closing(psycopg.connect(server, autocommit=True)) as connection:
        connection.execute(statement)
