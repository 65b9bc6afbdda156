"""Frames won, lost and moved between two runs, against counting them one by one."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.flights.results.comparing import (
    RunColumns,
    columns_of,
    compare_runs,
    kind_of,
    moved_between,
)

FRAMES = st.dictionaries(
    st.integers(0, 60),
    st.none() | st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(1, 1e4)),
)


def run(frames):
    keys = sorted(frames)
    place = [frames[key] or (np.nan,) * 3 for key in keys]
    ok = np.array([frames[key] is not None for key in keys], dtype=bool)
    return RunColumns(np.array(keys, dtype=np.int64), ok, np.array(place, float).reshape(-1, 3))


@given(first=FRAMES, second=FRAMES, most=st.integers(1, 70))
def test_every_frame_of_both_is_counted_once(first, second, most):
    changes = compare_runs(run(first), run(second))
    found = changes.summary()
    common = sorted(first.keys() & second.keys())
    won = [f for f in common if first[f] is None and second[f]]
    lost = [f for f in common if first[f] and second[f] is None]
    both = [f for f in common if first[f] and second[f]]
    assert (found["frames"], found["won"], found["lost"]) == (len(common), len(won), len(lost))
    assert (found["both"], found["neither"]) == (
        len(both),
        len(common) - len(won) - len(lost) - len(both),
    )
    assert found["only_first"] == len(first.keys() - second.keys())
    assert found["only_second"] == len(second.keys() - first.keys())
    moved = {f: float(np.linalg.norm(np.subtract(second[f], first[f]))) for f in both}
    if both:
        worst = max(moved.values())
        assert found["moved"]["worst_mm"] == pytest.approx(worst, abs=1e-4)
        assert moved[found["moved"]["worst_frame"]] == pytest.approx(worst, abs=1e-4)
    else:
        assert found["moved"] is None
    columns = changes.columns(most)
    assert len(columns) <= most
    for name in ("won", "lost", "both", "neither"):
        assert sum(column[name] for column in columns) == found[name]
    told = [(c["first_frame"], c["last_frame"]) for c in columns]
    assert all(a <= b for a, b in told)
    assert all(a[1] < b[0] for a, b in itertools.pairwise(told))


def record(frame, pose=True, x=0.0, quaternion=(1.0, 0.0, 0.0, 0.0)):
    own = {"position_mm": [x, 0.0, 1000.0], "quaternion_xyzw": list(quaternion)}
    return {"source": "a.mp4", "frame": frame, "status": "ok" if pose else "failed"} | (
        own if pose else {}
    )


def test_records_say_how_far_a_pose_moved_and_turned():
    turned = (np.cos(np.radians(5)), np.sin(np.radians(5)), 0.0, 0.0)
    moved = moved_between(record(1), record(1, x=10.0, quaternion=turned))
    assert moved == {
        "moved_mm": 10.0,
        "moved_share": 0.01,
        "turned_deg": pytest.approx(10, abs=1e-3),
    }
    assert moved_between(record(1), record(1, pose=False))["moved_mm"] is None
    kinds = [kind_of(record(1, a), record(1, b)) for a in (False, True) for b in (False, True)]
    assert kinds == ["neither", "won", "lost", "both"]


def test_of_several_records_of_a_frame_the_first_with_a_pose_counts():
    records = [record(1, pose=False), record(1, x=3.0), record(1, x=5.0), record(2, pose=False)]
    found = columns_of(records, lambda each: str(each["frame"]))
    assert found.key.tolist() == ["1", "2"]
    assert found.ok.tolist() == [True, False]
    assert found.position_mm[0].tolist() == [3.0, 0.0, 1000.0]
    nothing = columns_of([], str)
    assert compare_runs(nothing, nothing).summary()["frames"] == 0
