"""What recordings among a flight's uploads say for its order: their topics and their camera."""

from __future__ import annotations

from dataclasses import replace

from padstudio.errors import SpecError, StudioError
from padstudio.flights.jobs import FlightOrder
from padstudio.media.recordings.topics import Look, camera_of, look
from padstudio.store.uploads.rows import Upload
from padstudio.web.schemas.flights import FlightSettings
from padstudio.web.server.services import Services


def with_recordings(order: FlightOrder, given: FlightSettings, shared: Services) -> FlightOrder:
    """An order whose recordings were looked into, with the camera in them where none is given.

    Parameters
    ----------
    order : FlightOrder
        An empty camera is none.
    given : FlightSettings
        What the request says.
    shared : Services

    Raises
    ------
    RecordingError
        If a topic has to be chosen, or is not there; the message lists what there is.
    SpecError
        If there is no camera, or a topic without a recording.
    """
    uploads = [shared.store.uploads.get(upload) for upload in order.uploads]
    recordings = [upload for upload in uploads if upload.kind == "recording"]
    if order.request.get("topic") and not recordings:
        raise SpecError(
            "`topic` is of recordings, and none of the uploads is one; leave it out",
            code="no_recording",
        )
    looks = [_look(upload, order.request.get("topic"), shared) for upload in recordings]
    # A calibration that was recorded has no id.
    is_recorded = not order.camera or not order.request.get("camera_id")
    if given.camera is not None or not is_recorded:
        return order
    if recordings and any(u.kind not in ("recording", "telemetry") for u in uploads):
        raise SpecError(
            "not all uploads are recordings, which alone bring a calibration: give the camera",
            code="camera_required",
        )
    if not recordings and order.camera:
        return order
    camera, topic = camera_of(looks), looks[0].topic
    named = {"camera_id": None, "camera_name": f"recorded with {topic}"}
    return replace(order, camera=camera, request=dict(order.request) | named)


def _look(upload: Upload, topic: str | None, shared: Services) -> Look:
    path = shared.store.uploads.path(upload.id)
    future = shared.pool.submit(look, str(path), topic, timeout_s=shared.settings.detect_seconds)
    try:
        found: Look = future.result()
    except StudioError as error:
        error.message = f"{upload.name}: {error.message}"
        raise
    return found
