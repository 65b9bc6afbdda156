"""``padstudio reproduce``, with frames that were not simulated."""

from __future__ import annotations

from pathlib import Path

import pytest
import synthetic_frames

from padstudio.cli.program import app
from padstudio.experiments.reproduction import experiment


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    def read(shot: experiment.Shot) -> experiment.FrameRead:
        return synthetic_frames.synthetic(shot, lambda kind, shot: True)

    monkeypatch.setattr(experiment, "read_shot", read)


def run(*words: str) -> int:
    with pytest.raises(SystemExit) as ended:
        app(["reproduce", "--workers", "1", *words])
    return int(ended.value.code or 0)


def test_a_report_in_all_forms(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, page = tmp_path / "out", tmp_path / "page.md"
    assert run("-o", str(out), "--seeds", "2", "--only", "attitude", "--page", str(page)) == 0
    names = {path.name for path in out.iterdir()}
    assert {"report.md", "report.html", "attitude.csv", "attitude.svg", "tilts.svg"} <= names
    assert (tmp_path / "images" / "page-tilts.svg").is_file()
    said = capsys.readouterr()
    assert "attitudes of 10° to 40° are measured. Held." in said.out
    assert "18 frames" in said.err


def test_nothing_is_written_over_without_force(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("-o", str(tmp_path / "out"), "--seeds", "1", "--only", "horizontal")
    assert run(*words) == 0
    assert run(*words) == 2
    assert "(file_exists)" in capsys.readouterr().err
    assert run(*words, "--force") == 0


def test_an_unknown_experiment_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("-o", str(tmp_path / "out"), "--only", "flight") == 2
    assert "choose from stages" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
