"""Figures over all frames of a flight: shares, the longest gap, counts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import select
from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.results.answer_cache import KeptAnswers
from padstudio.flights.results.bins import add_up, pose_gaps, read_bins
from padstudio.store.database.flight_tables import FlightRow, FrameRow


class _Span(NamedTuple):
    """What of a bin tells gaps; ``poses`` as in its body."""

    first_frame: int
    last_frame: int
    poses: tuple[int, ...]


class Summaries:
    """The figures of a database's flights; the last ones are kept.

    Parameters
    ----------
    session : sessionmaker
    """

    def __init__(self, session: sessionmaker[Session]) -> None:
        self._session = session
        self._kept = KeptAnswers()

    def of(self, flight: FlightRow) -> dict[str, Any]:
        """Figures over all frames that have a result, JSON-serialisable.

        Returns
        -------
        dict
            ``frames``, ``ok``, ``share_ok``; ``qualities`` (poses that are ``full``, those of
            which only the ``bearing`` and range can be used, and ``unknown``); ``longest_gap``
            (first and last frame, frames without a pose, seconds between the poses around them);
            ``stages``, ``reasons`` and ``layers`` (counts, highest first); ``damaged``: frames of
            which the decoder made up a part.
        """

        def find_out() -> dict[str, Any]:
            with self._session() as session:
                return _summary(session, flight)

        return self._kept.of(flight, "summary", find_out)


def _summary(session: Session, flight: FlightRow) -> dict[str, Any]:
    frames = ok = damaged = unknown = 0
    counts: dict[str, dict[str, int]] = {
        name: {} for name in ("stages", "reasons", "layers", "bearings")
    }
    spans: list[_Span] = []
    for row in read_bins(session, flight):
        body = row.body
        frames, ok = frames + row.frames, ok + row.ok
        damaged, unknown = damaged + body["damaged"], unknown + body["unknown"]
        for name, total in counts.items():
            add_up(total, body[name])
        spans.append(_Span(row.first_frame, row.last_frame, tuple(body["poses"])))
    bearing = sum(counts.pop("bearings").values())
    return {
        "frames": frames,
        "ok": ok,
        "share_ok": ok / frames if frames else None,
        "qualities": {"full": ok - bearing - unknown, "bearing": bearing, "unknown": unknown},
        "longest_gap": _longest_gap(session, flight, spans),
        "damaged": damaged,
        **{name: _highest_first(total) for name, total in counts.items()},
    }


def _highest_first(counts: Mapping[str, int]) -> dict[str, int]:
    return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))


def _longest_gap(
    session: Session, flight: FlightRow, spans: Sequence[_Span]
) -> dict[str, Any] | None:
    """The longest run of frames without a pose, and the seconds between the poses around it.

    Frames that are not read yet are no gap, nor do gaps reach over them.
    """
    if flight.request.get("only"):
        # What lies between frames that were chosen is not known.
        return None
    stride = flight.request["stride"]
    gaps = [_gap_in(session, flight, part) for part in _unbroken(spans, stride)]
    return max(filter(None, gaps), key=lambda gap: int(gap["frames"]), default=None)


def _unbroken(spans: Iterable[_Span], stride: int) -> Iterator[list[_Span]]:
    """The spans in parts between which frames are missing."""
    part: list[_Span] = []
    for span in spans:
        if part and span.first_frame != part[-1].last_frame + stride:
            yield part
            part = []
        part.append(span)
    if part:
        yield part


def _gap_in(session: Session, flight: FlightRow, spans: Sequence[_Span]) -> dict[str, Any] | None:
    stride = flight.request["stride"]
    ends = spans[0].first_frame, spans[-1].last_frame
    # Poses thought of just before the first frame and just after the last one.
    edges = ends[0] - stride, ends[1] + stride
    gaps = [
        (edges[0] if before is None else before, edges[1] if after is None else after)
        for before, after in pose_gaps(span.poses for span in spans)
    ]
    start, end = max(gaps, key=lambda gap: gap[1] - gap[0])
    frames = (end - start) // stride - 1
    if frames < 1:
        return None
    return {
        "first_frame": start + stride,
        "last_frame": end - stride,
        "frames": frames,
        "seconds": _seconds_between(session, flight.key, max(start, ends[0]), min(end, ends[1])),
    }


def _seconds_between(session: Session, flight: int, start: int, end: int) -> float | None:
    found = session.execute(
        select(FrameRow.number, FrameRow.time_s).where(
            FrameRow.flight == flight, FrameRow.number.in_((start, end))
        )
    )
    times = {row.number: row.time_s for row in found}
    first, last = times.get(start), times.get(end)
    return None if first is None or last is None else last - first
