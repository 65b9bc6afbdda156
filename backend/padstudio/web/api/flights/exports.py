"""The poses of a flight in other programs' forms."""

from __future__ import annotations

import io
import time
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from fastapi import APIRouter, Depends, File, Query, UploadFile
from fastapi.responses import StreamingResponse

from padstudio.autopilot.vehicle import Mount, VehicleTrack
from padstudio.errors import BusyError, SpecError
from padstudio.flights.exports import from_flight
from padstudio.flights.exports.forms import FORMS
from padstudio.flights.exports.options import ExportChoices as WantedExport
from padstudio.media import content
from padstudio.media.telemetry.reading import parse
from padstudio.web.schemas.asked import Flag
from padstudio.web.server.services import (
    ERRORS,
    ItemId,
    Services,
    Shared,
    attachment,
    check_size,
    file_answer,
)

router = APIRouter(prefix="/flights", tags=["flights"], responses=ERRORS)

FormName = Literal["csv", "jsonl", "tum", "colmap", "mcap", "ros2", "ardupilot", "px4"]
_FILE = file_answer(
    "The file, as an attachment.", *sorted({form.media_type for form in FORMS.values()})
)
# Until an export asks again for a process that requests left none of.
_BUSY_SECONDS = 0.2
_Metres = Annotated[float, Query(ge=-100, le=100, description="Camera in the body frame, m.")]


@dataclass(frozen=True)
class ExportChoices:
    """What a caller may choose.

    Attributes
    ----------
    start_unix_s : float
    pad_id : str or None
        Of a flight with several pads, the one whose poses are wanted.
    turned_deg, forward_m, right_m, down_m : float
        The mount of a camera that looks straight down.
    """

    start_unix_s: Annotated[
        float, Query(ge=0, le=2**33, description="Unix time of the flight's time 0, s.")
    ] = 0.0
    pad_id: Annotated[
        str | None,
        Query(
            max_length=16,
            description="Of a flight with several pads: poses of this one, as `pad_id` of frames.",
        ),
    ] = None
    turned_deg: Annotated[
        float,
        Query(ge=-360, le=360, description="Of MAVLink: 0 if up in the picture is forward."),
    ] = 0.0
    forward_m: _Metres = 0.0
    right_m: _Metres = 0.0
    down_m: _Metres = 0.0

    @property
    def mount(self) -> Mount:
        """How the camera sits on the vehicle."""
        position_m = np.array([self.forward_m, self.right_m, self.down_m])
        return Mount.downward(self.turned_deg, position_m)


Choices = Annotated[ExportChoices, Depends(ExportChoices)]


@router.get(
    "/{flight_id}/export/{form}",
    operation_id="exportFlight",
    summary="The poses as csv, jsonl, tum, colmap, mcap, ros2, ardupilot or px4",
    response_class=StreamingResponse,
    responses=_FILE,
)
def export_flight(
    flight_id: ItemId,
    form: FormName,
    shared: Shared,
    choices: Choices,
    images: Annotated[Flag, Query(description="Of mcap: the frames, too.")] = False,
) -> StreamingResponse:
    return _stream(shared, flight_id, form, choices, images=images)


@router.post(
    "/{flight_id}/export/{form}",
    operation_id="exportFlightVehicle",
    summary="The same, with the vehicle's own poses, which px4 needs",
    response_class=StreamingResponse,
    responses=_FILE,
)
def export_flight_vehicle(
    flight_id: ItemId,
    form: FormName,
    shared: Shared,
    choices: Choices,
    vehicle: Annotated[
        UploadFile,
        File(
            description="CSV on the flight's clock: time_s,north_m,east_m,down_m,qw,qx,qy,qz; or a "
            "ULog, DataFlash or MAVLink log, whose clock is matched by the motion."
        ),
    ],
) -> StreamingResponse:
    check_size(vehicle.size, shared.settings.max_telemetry_bytes, "track of the vehicle")
    data = vehicle.file.read()
    if content.is_log(data[: content.HEAD_BYTES]):
        timeout_s = shared.settings.detect_seconds
        log = shared.pool.submit(parse, data, timeout_s=timeout_s).result()
        return _stream(shared, flight_id, form, choices, log=log)
    try:
        lines = io.StringIO(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise SpecError(
            "the vehicle's track is neither text nor a log; send CSV, ULog, DataFlash or a tlog",
            code="invalid_vehicle_track",
        ) from error
    return _stream(shared, flight_id, form, choices, vehicle=VehicleTrack.from_csv(lines))


def _stream(
    shared: Services,
    flight_id: str,
    form: FormName,
    choices: ExportChoices,
    *,
    vehicle: VehicleTrack | None = None,
    log: dict[str, Any] | None = None,
    images: bool = False,
) -> StreamingResponse:
    flight = shared.flights.flights.get(flight_id, texts=True)
    max_pixels = shared.flights.limits.max_pixels

    def run(function: Any, *args: Any) -> Any:
        timeout_s = shared.settings.detect_seconds
        while True:
            try:
                return shared.pool.submit(function, *args, timeout_s=timeout_s).result()
            except BusyError:
                # An export is in no hurry, and must not lose pictures to others' requests.
                time.sleep(_BUSY_SECONDS)

    wanted = WantedExport(
        form=form,
        pad_id=choices.pad_id,
        images=images,
        start_unix_s=choices.start_unix_s,
        mount=choices.mount,
        vehicle=vehicle,
        log=log,
    )
    found = FORMS[form]
    return StreamingResponse(
        from_flight.export_flight(flight, shared.flights.results, wanted, run, max_pixels),
        media_type=found.media_type,
        headers=attachment(flight.name, found.suffix),
    )
