"""What a live session recorded becomes a flight with the poses that it has."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import PurePosixPath
from typing import Any

from fastapi import APIRouter, Response

from padstudio.errors import NotFoundError, StudioError
from padstudio.flights.jobs import FlightOrder
from padstudio.flights.recorded.files import (
    Files,
    LookedInto,
    RecordedFile,
    files_of_folder,
    files_of_zip,
    look_into,
    parts_of,
)
from padstudio.flights.recorded.session import RecordingFormatError
from padstudio.geometry.camera import Camera
from padstudio.media.content import LIVE_ZIP
from padstudio.media.live_files import SESSION
from padstudio.store.database.flight_tables import FlightRow
from padstudio.store.uploads.rows import Upload
from padstudio.store.uploads.uploads import upload_stream
from padstudio.web.api.cameras import describe_camera, id_of_camera
from padstudio.web.api.flights.flights import DEFAULTS, OrderKey, describe_detail
from padstudio.web.schemas.flights import FlightDetail, RecordedFlight
from padstudio.web.server.services import ERRORS, Services, Shared

router = APIRouter(prefix="/flights", tags=["flights"], responses=ERRORS)


@router.post(
    "/from-recording",
    operation_id="openRecording",
    summary="Open what was recorded live, with its poses",
    status_code=202,
    responses={200: {"description": "It was opened already; this is it."}},
)
def open_recording(
    new: RecordedFlight, shared: Shared, response: Response, key: OrderKey = None
) -> FlightDetail:
    # A recording of this server's own is one flight, however often it is opened.
    key = f"live-{new.recording}" if new.recording else key
    flight = None if key is None else shared.flights.flights.of_key(key)
    if flight is None:
        flight = _open(new, shared, key)
    else:
        response.status_code = 200
    response.headers["Location"] = f"/api/v1/flights/{flight.id}"
    return describe_detail(shared, shared.flights.flights.get(flight.id, texts=True))


def _open(new: RecordedFlight, shared: Services, key: str | None) -> FlightRow:
    uploads = [shared.store.uploads.get(upload) for upload in new.uploads or ()]
    files = _files(new, uploads, shared)
    if SESSION not in files:
        raise RecordingFormatError(
            f"there is no {SESSION} among the files, which says what was recorded; send the whole "
            "folder, or a zip of it",
            code="live_files_missing",
        )
    look = _look(files[SESSION], shared)
    parts = parts_of(look.session, files)
    if new.recording is not None and not look.session.is_ended:
        # There may be more of it the next time.
        key = None
    order = [file for part in parts for file in part if file is not None]
    with _brought_in(order, shared) as ids:
        flight = shared.flights.order(_order(new, look, ids, shared, key))
    for upload in uploads:
        if upload.media_type == LIVE_ZIP.media_type:
            # Its files are uploads of their own now.
            shared.store.uploads.delete(upload.id)
    return flight


def _files(new: RecordedFlight, uploads: Sequence[Upload], shared: Services) -> Files:
    if new.recording is not None:
        folder = shared.store.folder.live / new.recording
        if not folder.is_dir():
            raise NotFoundError("there is no recording of that id; it was removed")
        return files_of_folder(folder)
    paths = [shared.store.uploads.path(upload.id) for upload in uploads]
    zips = [path for upload, path in zip(uploads, paths, strict=True) if _is_zip(upload)]
    if zips and len(uploads) > 1:
        raise RecordingFormatError(
            "a zip holds a recording as a whole; open it by itself", code="live_files_mixed"
        )
    if zips:
        return files_of_zip(zips[0], shared.store.uploads.limits.zip)
    # In a recording the names count: the session's file says by them what belongs together.
    found = {}
    for upload, path in zip(uploads, paths, strict=True):
        name = PurePosixPath(upload.name.replace("\\", "/")).name
        if name in found:
            raise RecordingFormatError(
                f"two of the files are called {name}; send one recording at a time",
                code="live_files_mixed",
            )
        found[name] = RecordedFile(name, path, upload.size_bytes, upload=upload.id)
    return found


def _is_zip(upload: Upload) -> bool:
    return upload.media_type == LIVE_ZIP.media_type


def _look(file: RecordedFile, shared: Services) -> LookedInto:
    settings = shared.settings
    future = shared.pool.submit(
        look_into, file, settings.max_telemetry_bytes, timeout_s=settings.detect_seconds
    )
    return future.result()


@contextlib.contextmanager
def _brought_in(files: Sequence[RecordedFile], shared: Services) -> Iterator[list[str]]:
    """Ids of files as uploads; those that were made go again where there will be no flight."""
    made: list[str] = []
    ids: list[str] = []
    try:
        for file in files:
            if file.upload is None:
                with file.open() as opened:
                    upload = upload_stream(
                        shared.store.uploads, opened, file.size_bytes, file.name
                    ).id
                made.append(upload)
            ids.append(file.upload or upload)
        yield ids
    except BaseException:
        for upload in made:
            with contextlib.suppress(StudioError):
                shared.store.uploads.delete(upload)
        raise


def _order(
    new: RecordedFlight, look: LookedInto, ids: list[str], shared: Services, key: str | None
) -> FlightOrder:
    session, store = look.session, shared.store
    stored = [
        store.pads.add(text, summary) for text, summary in zip(session.pads, look.pads, strict=True)
    ]
    pads = [
        {"id": pad.id, "name": pad.summary.get("name", ""), "pad_id": printed}
        for pad, printed in zip(stored, session.pad_ids, strict=True)
    ]
    camera = Camera.loads(session.camera)
    request: dict[str, Any] = DEFAULTS | {
        "method": session.method,
        "params": session.params,
        "pads": pads,
        "pad_id": pads[0]["id"],
        "pad_name": ", ".join(pad["name"] for pad in pads),
        "camera_id": id_of_camera(store, camera),
        "camera_name": describe_camera(camera, "")["name"],
        "live": {
            "program": session.program,
            "source": session.source,
            "unix_s": session.unix_s,
            "is_whole": session.is_whole,
        },
    }
    began = datetime.fromtimestamp(session.unix_s, UTC)
    name = new.name or f"live {began:%Y-%m-%d %H:%M:%S} UTC"
    return FlightOrder(
        name, ids, session.pads[0], session.camera, request, other_pads=session.pads[1:], key=key
    )
