"""Records on one clock, with names of no machine."""

from __future__ import annotations

import io

import numpy as np
import pytest
from export_records import CAMERA, records
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import CameraMismatchError, SpecError
from padstudio.flights.exports.forms import export
from padstudio.flights.exports.frames.cameras import FrameCameras
from padstudio.flights.exports.frames.records import Survey, alike, on_one_clock, relative_names
from padstudio.flights.exports.options import ExportOptions

READ = {"status": "failed", "stage": "lines", "reason": "no_lattice"}
LOST = {"status": "failed", "stage": "read", "reason": "not_a_video"}


def _times(*videos: list[float]) -> list[dict]:
    return [
        READ | {"source": f"{k}.mp4", "frame": n, "time_s": time_s}
        for k, times in enumerate(videos)
        for n, time_s in enumerate(times)
    ]


def test_older_files_of_several_videos_give_no_time_twice() -> None:
    one = [each | {"source": "a.mp4"} for each in records()]
    both = one + [each | {"source": "b.mp4"} for each in records()]
    table = np.loadtxt(io.StringIO(b"".join(export("tum", both)).decode()))
    assert len(table) == 10
    # Ten frames a second, and the second video one frame after the first.
    assert table[5:, 0] == pytest.approx(table[:5, 0] + 0.6)
    assert Survey.of(both).begin_again == ["b.mp4"]


@given(
    st.lists(
        st.lists(st.integers(1, 100), min_size=1, max_size=6).map(np.cumsum),
        min_size=1,
        max_size=4,
    )
)
def test_times_rise_from_frame_to_frame(videos: list) -> None:
    begun_at_zero = [((times - times[0]) / 30).tolist() for times in videos]
    told = [each["time_s"] for each in on_one_clock(_times(*begun_at_zero))]
    assert (np.diff(told) > 0).all()
    assert told[: len(begun_at_zero[0])] == begun_at_zero[0]
    # What goes on already is left as it is.
    again = [
        READ | {"source": each["source"], "time_s": time_s}
        for each, time_s in zip(_times(*begun_at_zero), told, strict=True)
    ]
    assert [each["time_s"] for each in on_one_clock(again)] == told


def test_a_video_that_could_not_be_read_takes_no_time() -> None:
    first, last = _times([0.0, 0.1], [0.2, 0.3])[:2], _times([], [], [0.2, 0.3])
    lost = LOST | {"source": "1.mp4", "frame": 2, "time_s": 0.2}
    told = [*first, lost, *last]
    assert list(on_one_clock(told)) == told
    assert Survey.of(told).begin_again == []


def test_what_has_no_one_clock_is_refused() -> None:
    still = READ | {"source": "a.jpg", "frame": 2, "time_s": None}
    with pytest.raises(SpecError, match="stills have no times"):
        Survey.of([*_times([0.0, 0.1]), still]).check_clock("tum", is_matched=False)
    older = Survey.of(_times([0.0, 0.1], [0.0, 0.1]))
    older.check_clock("tum", is_matched=False)
    with pytest.raises(SpecError, match=r"the times of 1\.mp4 begin again"):
        older.check_clock("px4", is_matched=True)


def test_one_order_of_fields() -> None:
    (first, *_) = records()
    backwards = dict(reversed(first.items()))
    assert list(next(alike([backwards]))) == list(next(alike([first])))


@pytest.mark.parametrize(
    ("sources", "names"),
    [
        (["/media/card/flight/a.mp4"], ["a.mp4"]),
        (["/media/card/x/a.mp4", "/media/card/y/a.mp4"], ["x/a.mp4", "y/a.mp4"]),
        (["C:/me/a.mp4", "C:/me/b.mp4"], ["a.mp4", "b.mp4"]),
        (["../x/a.mp4", "../y/b.mp4"], ["x/a.mp4", "y/b.mp4"]),
        (["../../a.mp4", "../b.mp4"], ["a.mp4", "b.mp4"]),
        (["two/a b/flight.mp4", "/media/c.mp4"], ["two/a b/flight.mp4", "c.mp4"]),
        (["two/a.mp4", "./b.mp4"], ["two/a.mp4", "./b.mp4"]),
    ],
)
def test_names_hold_no_folders_of_a_machine(sources: list[str], names: list[str]) -> None:
    found = relative_names(sources)
    assert [found.get(source, source) for source in sources] == names


def test_models_name_pictures_of_absolute_sources_relatively() -> None:
    told = [each | {"source": "/media/card/a flight.mp4"} for each in records()]
    names = relative_names(["/media/card/a flight.mp4"])
    rows = b"".join(export("csv", told, ExportOptions(names=names))).decode()
    assert "/media" not in rows
    assert rows.count("a flight.mp4") == len(told)


def test_cameras_of_frames_of_several_sizes() -> None:
    cameras = FrameCameras(CAMERA, None)
    half = cameras.of({"frame_px": [320, 240]})
    assert half is not None
    # A ray keeps its place in the picture.
    x, y = CAMERA.project([[0.1, 0.2, 1.0]])[0]
    assert half.project([[0.1, 0.2, 1.0]])[0] == pytest.approx(((x - 0.5) / 2, (y - 0.5) / 2))
    assert cameras.of({"frame_px": [320, 240]}) is half
    with pytest.raises(CameraMismatchError):
        cameras.of({"frame_px": [320, 320]})
    with pytest.raises(SpecError, match="nothing says how large"):
        cameras.of({"source": "a.mp4", "status": "ok"})


def test_frames_that_were_not_read_take_their_neighbours_camera() -> None:
    sizes = [None, (640, 480), None, (320, 240), None]
    told = [LOST | ({"frame_px": size, "stage": "lines"} if size else {}) for size in sizes]
    found = [
        (camera.width, camera.height)
        for _, camera in FrameCameras(CAMERA, None).beside(told, lambda record: record)
    ]
    assert found == [(640, 480)] * 3 + [(320, 240)] * 2
    only_lost = FrameCameras(CAMERA, None).beside([LOST] * 2, lambda record: record)
    assert [camera for _, camera in only_lost] == [CAMERA] * 2
