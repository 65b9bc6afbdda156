"""Finds what a bundle of a flight's frame needs, in the database."""

from __future__ import annotations

from padstudio.flights.bundles.around import around
from padstudio.flights.bundles.making import Beside, RunFrame
from padstudio.flights.results.frames import FrameFilter, Results
from padstudio.flights.tasks import from_rows
from padstudio.flights.tasks.frames import StillPart, VideoPart
from padstudio.store.database.flight_tables import FlightRow

# The pad is followed anew where a run began to, which is at most so far before; beyond, what a
# frame is told of those before it has long converged.
_MOST_BEFORE = 600


def frame_of_run(flight: FlightRow, results: Results, number: int) -> RunFrame:
    """A frame as a flight's run read it.

    Parameters
    ----------
    flight : FlightRow
        With its texts.
    results : Results
    number : int

    Raises
    ------
    NotFoundError
        If the flight does not read that frame, or it has no result yet.
    """
    recorded = results.frame(flight, number)
    near = {
        -1: results.page(flight, FrameFilter(), 1, before=number),
        1: results.page(flight, FrameFilter(), 1, after=number),
    }
    beside = [
        Beside(offset, _part(flight, results, record["frame"], 0), record)
        for offset, records in near.items()
        for record in records
    ]
    return RunFrame(
        from_rows.recipe_of(flight),
        _part(flight, results, number, _MOST_BEFORE),
        recorded,
        str(flight.request.get("version", "")),
        tuple(beside),
        around(flight, results, recorded),
    )


def _part(flight: FlightRow, results: Results, number: int, before: int) -> VideoPart | StillPart:
    """A frame, with those before it in its chunk."""
    chunk = results.chunk_of(flight, number)
    if not chunk.pts:
        return from_rows.still_part(flight.sources, number)
    place = from_rows.numbers_of(flight, chunk).index(number)
    part = from_rows.video_part(flight.sources[chunk.source], chunk.pts)
    return part.between(max(0, place - before), place + 1)
