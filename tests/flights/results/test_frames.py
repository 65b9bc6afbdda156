"""Pages, filters and figures of frames, compared with the same thing done in plain Python."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import flight_orders
import numpy as np
import pytest
import videos
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from padstudio.errors import NotFoundError
from padstudio.flights.jobs import Flights
from padstudio.flights.results.frames import FrameFilter, Results
from padstudio.flights.results.rows import insert_rows, rows_of
from padstudio.flights.results.summaries import Summaries
from padstudio.geometry.pose import look_at_pad, rotation_from_quaternion
from padstudio.store.database.flight_tables import FlightRow
from padstudio.store.store import Store
from padstudio.vision.stage.detection import pose_fields

FRAMES = 300
REASONS = ("unknown_code", "no_edges", "motion_blur")


def record(number: int, *, ok: bool) -> dict[str, Any]:
    """A line of a poses file; the camera comes down 10 mm a frame."""
    head = {"source": "a.mp4", "frame": number, "time_s": number / 30, "elapsed_ms": {"total": 9.0}}
    if not ok:
        reason = REASONS[number % 3]
        failure = {"stage": "decode", "reason": reason, "detail": "", "advice": ""}
        return {**head, "status": "failed", **failure}
    pose = look_at_pad(5000.0 - 10 * number, tilt_deg=0, heading_deg=float(number))
    layer = "red" if number % 2 else "blue"
    told = {"quality": "bearing" if number < 40 else "full"}
    told |= {"range_sigma_mm": 0.3, "bearing_sigma_deg": 0.1, "covariance": [0.1] * 21}
    return {**head, "status": "ok", **pose_fields(pose), "layer": layer, **told}


RECORDS = [record(n, ok=n % 7 != 3 and not 100 <= n < 120) for n in range(FRAMES)]
for item in RECORDS[150:160]:
    item["damaged"] = True
Made = tuple[Results, Summaries, FlightRow]


@pytest.fixture(scope="module")
def make(
    tmp_path_factory: pytest.TempPathFactory, new_database: Callable[[], str | None]
) -> Iterator[Callable[..., Made]]:
    folder = tmp_path_factory.mktemp("store")
    store = Store(folder / "data", new_database())
    upload = flight_orders.upload(store, videos.write(folder / "a.mp4", 2))
    flights = Flights(store.session)

    def fill(records: list[dict[str, Any]], **request: Any) -> Made:
        flight = flights.create(flight_orders.order(upload, **request))
        frames, details = rows_of(flight.key, 1, records)
        with store.session.begin() as session:
            if frames:
                insert_rows(session, flight.request, frames, details)
        return Results(store.session), Summaries(store.session), flight

    yield fill
    store.close()


@pytest.fixture(scope="module")
def full(make: Callable[..., Made]) -> Made:
    make([record(n, ok=True) for n in range(50)])
    return make(RECORDS)


def test_records_come_back_as_they_were(full: Made) -> None:
    results, _, flight = full
    for found, expected in zip(results.every(flight), RECORDS, strict=True):
        rotation = found.pop("rotation", None)
        expected = dict(expected)
        if rotation is not None:
            np.testing.assert_allclose(rotation, expected.pop("rotation"), atol=1e-12)
        assert found == expected
    assert results.frame(flight, 8)["frame"] == 8
    with pytest.raises(NotFoundError):
        results.frame(flight, FRAMES)


@given(st.integers(0, 2**32 - 1))
def test_rotations_follow_from_quaternions(seed: int) -> None:
    q = np.random.default_rng(seed).normal(size=4)
    rotation = rotation_from_quaternion(q.tolist())
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1)


FILTERS = st.builds(
    FrameFilter,
    status=st.sampled_from([None, "ok", "failed"]),
    reason=st.sampled_from([None, *REASONS]),
    layer=st.sampled_from([None, "red", "blue"]),
    quality=st.sampled_from([None, "full", "bearing"]),
    from_s=st.none() | st.floats(-1, 12),
    to_s=st.none() | st.floats(-1, 12),
    min_height=st.none() | st.floats(1000, 6000),
    max_height=st.none() | st.floats(1000, 6000),
)


def fits(item: dict[str, Any], wanted: FrameFilter) -> bool:
    height = item["position_mm"][2] if item["status"] == "ok" else None
    tests = [
        wanted.status in (None, item["status"]),
        wanted.reason in (None, item.get("reason")),
        wanted.layer in (None, item.get("layer")),
        wanted.quality in (None, item.get("quality")),
        wanted.from_s is None or item["time_s"] >= wanted.from_s,
        wanted.to_s is None or item["time_s"] < wanted.to_s,
        wanted.min_height is None or (height is not None and height >= wanted.min_height),
        wanted.max_height is None or (height is not None and height <= wanted.max_height),
    ]
    return all(tests)


@hypothesis_settings(deadline=None, max_examples=60, database=None)
@given(wanted=FILTERS, limit=st.integers(1, 120))
def test_pages_hold_every_frame_that_fits_once(full: Made, wanted: FrameFilter, limit: int) -> None:
    results, _, flight = full
    expected = [item["frame"] for item in RECORDS if fits(item, wanted)]
    found: list[int] = []
    while page := results.page(flight, wanted, limit, found[-1] if found else None):
        assert len(page) <= limit
        found += [item["frame"] for item in page]
    assert found == expected
    before = [item["frame"] for item in results.page(flight, wanted, limit, before=150)]
    assert before == [n for n in expected if n < 150][-limit:]


def test_figures(full: Made) -> None:
    _, summaries, flight = full
    figures = summaries.of(flight)
    ok = [item for item in RECORDS if item["status"] == "ok"]
    assert (figures["frames"], figures["ok"]) == (FRAMES, len(ok))
    assert figures["share_ok"] == len(ok) / FRAMES
    assert figures["stages"] == {"decode": FRAMES - len(ok)}
    assert sum(figures["reasons"].values()) == FRAMES - len(ok)
    assert sum(figures["layers"].values()) == len(ok)
    counts = Counter(item["quality"] for item in ok)
    assert figures["qualities"] == counts | {"unknown": 0}
    assert figures["damaged"] == sum(item.get("damaged", False) for item in RECORDS) > 0
    gap = figures["longest_gap"]
    assert (gap["first_frame"], gap["last_frame"], gap["frames"]) == (100, 119, 20)
    assert gap["seconds"] == pytest.approx(21 / 30)


@pytest.mark.parametrize(
    ("outcomes", "stride", "gap"),
    [
        ("", 1, None),
        ("+++", 1, None),
        ("---", 1, (0, 2, 3)),
        ("--+-", 1, (0, 1, 2)),
        ("+-+---", 1, (3, 5, 3)),
        ("+--+-+", 5, (5, 10, 2)),
    ],
)
def test_longest_gap(
    outcomes: str, stride: int, gap: tuple[int, int, int] | None, make: Callable[..., Made]
) -> None:
    records = [record(stride * n, ok=sign == "+") for n, sign in enumerate(outcomes)]
    _, summaries, flight = make(records, stride=stride)
    found = summaries.of(flight)["longest_gap"]
    shown = found and (found["first_frame"], found["last_frame"], found["frames"])
    assert shown == gap
