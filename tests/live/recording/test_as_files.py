"""The poses of a recording are a poses file to the commands that take one."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from live_sessions import MISSED, record_landing
from typer.testing import CliRunner

from padstudio.cli.program import app
from padstudio.flights.results.poses_file import read_poses


@pytest.fixture(scope="module")
def joined(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The poses of both segments, one after the other."""
    folder = record_landing(tmp_path_factory.mktemp("live") / "landing")
    path = folder / "live.jsonl"
    parts = [part.read_bytes() for part in sorted(folder.glob("0*.jsonl"))]
    assert len(parts) == 2
    path.write_bytes(b"".join(parts))
    return path


def test_joined_files_are_the_recordings_poses(joined: Path) -> None:
    records = list(read_poses(joined))
    assert [record["frame"] for record in records] == list(range(60))
    times = [record["time_s"] for record in records]
    assert times == sorted(times)
    assert {r["frame"] for r in records if r["status"] == "failed"} == MISSED


def test_compare_takes_them(joined: Path) -> None:
    result = CliRunner().invoke(app, ["compare", str(joined), str(joined), "--json"])
    assert result.exit_code == 0, result.output
    figures = json.loads(result.stdout)
    assert (figures["both"], figures["neither"]) == (60 - len(MISSED), len(MISSED))


@pytest.mark.parametrize("form", ["csv", "tum", "ros2"])
def test_export_takes_them(joined: Path, tmp_path: Path, form: str) -> None:
    target = tmp_path / f"out.{form}"
    result = CliRunner().invoke(app, ["export", str(joined), "--form", form, "-o", str(target)])
    assert result.exit_code == 0, result.output
    assert target.exists()
