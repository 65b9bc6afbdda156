"""``padstudio compare`` on poses files."""

from __future__ import annotations

import csv
import json

import pytest
from typer.testing import CliRunner

from padstudio.cli.program import app


def line(frame, *, x=None, reason=None, source="a.mp4", pad="aaaa"):
    record = {"source": source, "frame": frame, "time_s": frame / 30}
    if x is None:
        told = {
            "status": "failed",
            "stage": "lines",
            "reason": reason or "no_lattice",
            "detail": "",
        }
        return json.dumps(record | told)
    pose = {
        "status": "ok",
        "position_mm": [x, 0.0, 1000.0],
        "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0],
        "rotation": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
        "layer": "red",
        "pad_id": pad,
    }
    return json.dumps(record | pose)


@pytest.fixture
def files(tmp_path):
    first, second = tmp_path / "a.jsonl", tmp_path / "b.jsonl"
    first.write_text("\n".join([line(0, x=0), line(1), line(2, x=0), line(3), line(9, x=1)]) + "\n")
    second.write_text("\n".join([line(0, x=4), line(1, x=0), line(2), line(3), line(4)]) + "\n")
    return first, second


def run(*args):
    return CliRunner().invoke(app, ["compare", *map(str, args)])


def test_figures_in_words_and_as_json(files):
    said = run(*files)
    assert said.exit_code == 0, said.output
    assert "won         1" in said.output
    assert "worst 4 mm (0.4 %): a.mp4, frame 0" in said.output
    figures = json.loads(run(*files, "--json").stdout)
    assert [figures[name] for name in ("frames", "won", "lost", "both", "neither")] == [
        4,
        1,
        1,
        1,
        1,
    ]
    assert (figures["only_first"], figures["only_second"]) == (1, 1)
    assert figures["moved"]["worst_frame"] == ["a.mp4", 0, None]


def test_changed_frames_go_into_a_table(files, tmp_path):
    table = tmp_path / "changes.csv"
    assert run(*files, "-o", table).exit_code == 0
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert [(row["frame"], row["change"]) for row in rows] == [
        ("0", "moved"),
        ("1", "won"),
        ("2", "lost"),
    ]
    assert (rows[0]["moved_mm"], rows[1]["reason_before"], rows[2]["reason_after"]) == (
        "4.0", "no_lattice", "no_lattice",
    )  # fmt: skip
    assert run(*files, "-o", table).exit_code == 2
    assert run(*files, "-o", table, "--force", "--least-mm", "5").exit_code == 0
    assert "moved,4" not in table.read_text()


def test_of_several_pads_in_a_frame_each_is_compared_with_itself(tmp_path):
    first, second = tmp_path / "a.jsonl", tmp_path / "b.jsonl"
    first.write_text("\n".join([line(0, x=0), line(0, x=500, pad="bbbb"), line(1)]) + "\n")
    second.write_text("\n".join([line(0, x=500, pad="bbbb"), line(0, x=2), line(1, x=0)]) + "\n")
    figures = json.loads(run(first, second, "--json").stdout)
    assert [figures[name] for name in ("frames", "won", "both")] == [3, 1, 2]
    assert figures["moved"]["worst_mm"] == 2.0
    assert figures["moved"]["worst_frame"] == ["a.mp4", 0, "aaaa"]


def test_files_without_a_frame_in_common_are_refused(files, tmp_path):
    other = tmp_path / "c.jsonl"
    other.write_text(line(0, x=0, source="b.mp4") + "\n")
    said = run(files[0], other)
    assert said.exit_code != 0
    assert not (tmp_path / "changes.csv").exists()
