"""A shoot-out from the order to the report, on the smallest of flights."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from padstudio.errors import LimitError, SpecError
from padstudio.experiments.report import Report
from padstudio.experiments.shootout.boards import catalogue
from padstudio.experiments.shootout.contest import Contest
from padstudio.experiments.shootout.entry import Entry
from padstudio.experiments.shootout.losses import losses
from padstudio.experiments.shootout.machine import Beside
from padstudio.experiments.shootout.order import MAX_FRAMES, Shootout
from padstudio.experiments.shootout.report import report_of, run
from padstudio.experiments.shootout.scores import Outcome
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Layer, Pad

CAMERA = Camera(320, 180, np.array([[222.0, 0, 159.5], [0, 222.0, 89.5], [0, 0, 1]]), np.zeros(5))
PAD = Pad((Layer("red", 50.0, np.eye(25, dtype=np.uint8)),), quiet_mm=25.0)


def _order(**changes: Any) -> Shootout:
    return Shootout(pad=PAD, camera=CAMERA, frames=2, **changes)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Report:
    """Of the pad, a single marker, and a board whose reader is not there."""
    folder = tmp_path_factory.mktemp("shootout")
    gone = replace(catalogue.BOARDS["apriltag-36h11"], package=("no-reader", "no_such_module"))
    pad, camera, steps = folder / "pad.json", folder / "camera.yaml", []
    PAD.save(pad)
    CAMERA.save(camera)
    order = {
        "pad": pad.read_text(),
        "camera": camera.read_text(),
        "frames": 2,
        "from_mm": 2500.0,
        "to_mm": 100.0,
        "boards": ["aruco-single", "apriltag-36h11"],
        "kind": "shootout",
    }
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(catalogue.BOARDS, "apriltag-36h11", gone)
        found = run(order, folder, lambda done, total: steps.append((done, total)))
    assert [done for done, _ in steps] == list(range(len(steps)))
    assert steps[-1][0] == steps[-1][1]
    return found


def test_a_marker_is_read_where_it_is_in_view_alone(report: Report) -> None:
    table = next(table for table in report.tables if table.name == "boards")
    fast = next(row for row in table.rows if row[:2] == ("ArUco single", "fast"))
    assert fast[2:5] == (1, 0, 1)
    assert fast[-2:] == (1.0, "0 of 4")
    frames = next(table for table in report.tables if table.name == "frames")
    column = [column.title for column in frames.columns].index("ArUco single, fast")
    assert 0 < frames.rows[0][column] < 3
    assert frames.rows[1][column] == "missed"


def test_who_is_left_out_is_named_with_the_way_to_install_it(report: Report) -> None:
    words = next(words for words in report.words if "left out" in words)
    assert words.startswith("AprilTag 36h11")
    assert "no-reader is not installed" in words
    assert 'pip install "padstudio[shootout]"' in words


def test_the_report_has_strips_a_chart_and_pictures_of_each_board(report: Report) -> None:
    names = [figure.file for figure in report.figures]
    assert names == ["strips.svg", "errors.svg", "frames-pad.webp", "frames-aruco-single.webp"]
    strips = report.figures[0].data.decode()
    assert strips.count("<circle") + strips.count('height="16"') + strips.count("l10 10") == 6


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"flight": "dive"}, "no flight 'dive'"),
        ({"boards": ("aruco",)}, "no board 'aruco'"),
        ({"boards": ("charuco", "charuco")}, "twice"),
        ({"disturbances": ("copy=900:10",)}, "copy"),
        ({"disturbances": ("rain=1",)}, "no disturbance 'rain'"),
        ({"look": "gloom"}, "no look 'gloom'"),
        ({"to_mm": 0.5}, "to_mm"),
    ],
)
def test_a_wrong_order_is_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(SpecError, match=words):
        _order(**changes)


def test_more_frames_than_the_limit_are_refused() -> None:
    with pytest.raises(LimitError):
        Shootout(pad=PAD, camera=CAMERA, frames=MAX_FRAMES + 1)


def test_looks_at_the_edge_meet_the_rim_of_the_print() -> None:
    order = Shootout(pad=PAD, camera=CAMERA, frames=8, flight="edge", from_mm=2000.0, to_mm=200.0)
    met = []
    for view in order.views:
        forward = view.pose.rotation[:, 2]
        met.append(view.pose.position_mm + forward * view.distance_mm)
    half = order.page.width_mm / 2
    assert half == PAD.width_mm / 2 + PAD.quiet_mm
    assert np.abs(met)[:, :2].max(axis=1) == pytest.approx([half] * 8)
    assert np.abs(np.array(met)[:, 2]).max() < 1e-6


def _entry(board: str, setting: str, *outcomes: tuple[str, float | None]) -> Entry:
    heights = (1000.0, 500.0, 100.0)
    return Entry(
        board,
        setting,
        [
            Outcome(height, 0.0, verdict, error, 0.1, cpu_ms=5.0 if board == "pad" else 2.0)  # type: ignore[arg-type]
            for height, (verdict, error) in zip(heights, outcomes, strict=True)
        ],
    )


def _contest(*entries: Entry, cores: float) -> Contest:
    return Contest(_order(), list(entries), beside=Beside(cores=cores))


def test_all_that_another_board_does_better_is_published() -> None:
    pad = _entry("pad", "single", ("missed", None), ("read", 0.2), ("false", 9.0))
    other = _entry("charuco", "fast", ("read", 0.5), ("read", 0.1), ("missed", None))
    found = {row[2]: row[3:] for row in losses(_contest(pad, other, cores=0.0))}
    assert found["frames read"] == ("2", "1")
    assert found["false poses"] == ("0", "1")
    assert found["frames that the pad does not read"] == ("1 (1 … 1 m)", "0")
    assert found["largest height"] == ("1 m", "0.5 m")
    assert found["range ratio"] == ("2", "1")
    assert found["median error over the 1 frames that both read"] == ("0.1000 %", "0.2000 %")
    assert found["median time"] == ("2.0 ms", "5.0 ms")
    changed = Entry("pad", "single", other.outcomes), Entry("charuco", "fast", pad.outcomes)
    assert not list(losses(_contest(*changed, cores=0.0)))


def test_readers_that_are_missing_are_named_where_nobody_asked_for_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gone = replace(catalogue.BOARDS["charuco"], package=("no-reader", "no_such_module"))
    monkeypatch.setitem(catalogue.BOARDS, "charuco", gone)
    pad = _entry("pad", "single", ("read", 0.1), ("read", 0.2), ("read", 0.3))
    words = report_of(_contest(pad, cores=1.0)).words[-1]
    assert "ChArUco" in words
    assert 'pip install "padstudio[shootout]"' in words


def test_times_are_compared_only_where_the_run_was_alone() -> None:
    pad = _entry("pad", "single", ("read", 0.1), ("read", 0.2), ("read", 0.3))
    other = _entry("charuco", "fast", ("missed", None), ("missed", None), ("missed", None))
    alone, busy = (report_of(_contest(pad, other, cores=cores)) for cores in (0.05, 1.2))
    assert [table.name for table in alone.tables].count("times") == 1
    assert "times" not in [table.name for table in busy.tables]
    assert any("times are not compared" in word for s in busy.sections for word in s.words)
    assert not list(losses(_contest(pad, other, cores=1.2)))
