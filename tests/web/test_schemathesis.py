"""Schemathesis finds nothing: what the OpenAPI document says, the server does.

Of its coverage phase one case in ten is sent, the same ones every time; `SCHEMATHESIS_SHARE=1`
sends all of them.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import fake_analysis
import pytest
import served_things
from places import ROOT
from web_server import running, settings_for

from padstudio.web.http import wrong_tokens
from padstudio.web.server.studio import Studio

#: Links between operations that scenarios follow at the least, of some 280 that are inferred.
LEAST_LINKS = 30
TOKEN = "a-token-of-some-length"
#: Dear work is refused for its size, so that requests cost milliseconds.
SMALL = {
    "max_cells": 40,
    "generate_seconds": 5,
    "max_simulated_frames": 1,
    "max_flight_frames": 1,
    "max_simulated_pixels": 10_000,
    "max_paint_pixels": 10_000,
    "max_request_bytes": 1_000_000,
    "max_waiting": 100,
    "max_live": 1,
}


class Resting(Studio):
    """A studio whose flights stay queued."""

    def start(self) -> None:
        """Nothing is worked."""


def test_nothing_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Its check `ignored_auth` sends hundreds of wrong tokens, which would wait ten seconds each.
    monkeypatch.setattr(wrong_tokens, "_STEP_S", 0.0)
    values = settings_for(tmp_path / "data", token=TOKEN, **SMALL)
    studio = Resting.open(values, fake_analysis.analyze)
    with running(values, studio=studio) as client:
        client.headers["Authorization"] = f"Bearer {TOKEN}"
        served_things.keep(client)
        command = [
            *(sys.executable, "-m", "schemathesis.cli"),
            *("--config-file", str(ROOT / "tests/web/schemathesis.toml")),
            *("run", f"{client.base_url}/api/v1/openapi.json"),
            *("-H", f"Authorization: Bearer {TOKEN}", "--checks", "all", "--continue-on-failure"),
            *("--phases", "examples,coverage,fuzzing,stateful"),
            *("--generation-deterministic", "--no-shrink", "--no-color"),
        ]
        environment = os.environ | {"PYTHONPATH": str(ROOT / "tests/support")}
        found = subprocess.run(
            command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=False
        )
    assert found.returncode == 0, found.stdout[-20_000:] + found.stderr[-2_000:]
    for phase in ("Examples", "Coverage", "Fuzzing", "Stateful"):
        assert f"✅  {phase}" in found.stdout, found.stdout
    # Which ones is chance; without anything that the server keeps it would be four.
    links = re.search(r"API Links: +(\d+) covered", found.stdout)
    assert links is not None
    assert int(links[1]) >= LEAST_LINKS
