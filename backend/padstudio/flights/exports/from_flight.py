"""The export of a server's flight."""

from __future__ import annotations

from collections.abc import Iterator

from padstudio.flights.exports.forms import export
from padstudio.flights.exports.frames.pads import check_pad, of_pad
from padstudio.flights.exports.frames.pictures import FlightPictures, Run, flight_frame_px
from padstudio.flights.exports.frames.records import relative_names
from padstudio.flights.exports.from_log import has_track, track_of
from padstudio.flights.exports.options import ExportChoices, ExportOptions, Record
from padstudio.flights.results.frames import Results
from padstudio.geometry.camera import Camera
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Pad
from padstudio.store.database.flight_tables import FlightRow


def export_flight(
    flight: FlightRow, results: Results, choices: ExportChoices, run: Run, max_pixels: int
) -> Iterator[bytes]:
    """Write a flight in a form; as `padstudio.flights.exports.forms.export`.

    Parameters
    ----------
    flight : FlightRow
        With its pads and camera.
    results : Results
    choices : ExportChoices
        For px4, the flight's own telemetry says where the vehicle was, if nothing else does.
    run : callable
        Frames are decoded in worker processes.
    max_pixels : int
    """
    loaded = [Pad.loads(text) for text in (flight.pad, *(flight.other_pads or ()))]
    pads = {pad_id(pad): pad for pad in loaded}
    check_pad(choices.form, pads, choices.pad_id)

    def records() -> Iterator[Record]:
        return of_pad(results.every(flight), choices.pad_id)

    log, vehicle = choices.log, choices.vehicle
    if log is None and choices.form == "px4" and has_track(flight.telemetry):
        log = flight.telemetry
    if vehicle is None and log is not None:
        vehicle = run(track_of, log, list(records()))
    options = ExportOptions(
        camera=Camera.loads(flight.camera),
        frame_px=flight_frame_px(flight, run, max_pixels),
        names=relative_names([source["name"] for source in flight.sources or ()]),
        pad_size_mm=pads.get(choices.pad_id or "", loaded[0]).size_mm,
        picture=FlightPictures(flight, results, run, max_pixels) if choices.images else None,
        start_unix_s=choices.start_unix_s,
        mount=choices.mount,
        vehicle=vehicle,
    )
    return export(choices.form, records(), options)
