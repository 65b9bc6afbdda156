"""Sweeps of one parameter over a flight's failing frames, and over some that have a pose."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from fastapi import APIRouter, Response
from fastapi.concurrency import run_in_threadpool

from padstudio.errors import SpecError
from padstudio.flights.tasks.detectors import Recipe, params_from
from padstudio.flights.tuning.bench import Subject
from padstudio.flights.tuning.sweep import sweep_frame, with_value
from padstudio.web.schemas.tuning import SweepInfo, SweepSpec
from padstudio.web.server.services import ERRORS, ItemId, Services, Shared, accepted
from padstudio.web.server.sweep_service import Sweep, SweptFrame

router = APIRouter(tags=["tune"], responses=ERRORS)


@router.post(
    "/flights/{flight_id}/sweeps",
    operation_id="sweepParameter",
    summary="One parameter over its failing frames",
    status_code=202,
)
async def sweep_parameter(
    flight_id: ItemId, spec: SweepSpec, shared: Shared, response: Response
) -> SweepInfo:
    recipe, sweep = await run_in_threadpool(_planned, flight_id, spec, shared)

    async def read(number: int) -> list[bool]:
        job = await run_in_threadpool(shared.flights.picture_job, flight_id, number, Path())
        subject = Subject(f"{flight_id}-{number}", job.part, job.max_pixels)
        return await shared.work(
            sweep_frame,
            *(subject, recipe, spec.parameter, sweep.values),
            timeout_s=shared.settings.detect_seconds * len(sweep.values),
        )

    shared.sweeps.start(sweep, read)
    return accepted(response, "sweeps", sweep, SweepInfo)


@router.get("/sweeps/{sweep_id}", operation_id="getSweep", summary="How far a sweep is")
async def get_sweep(sweep_id: ItemId, shared: Shared) -> SweepInfo:
    return SweepInfo.model_validate(shared.sweeps.get(sweep_id))


@router.delete(
    "/sweeps/{sweep_id}",
    operation_id="stopSweep",
    summary="Stop a sweep; what was read stays",
    status_code=204,
)
async def stop_sweep(sweep_id: ItemId, shared: Shared) -> None:
    shared.sweeps.stop(sweep_id)


def _planned(flight_id: str, spec: SweepSpec, shared: Services) -> tuple[Recipe, Sweep]:
    """With what frames are read, and which; wrong values cost no frame."""
    flight = shared.flights.flights.get(flight_id, texts=True)
    params: dict[str, Any] = flight.request["params"] if spec.params is None else spec.params
    for value in spec.values:
        params_from(with_value(params, spec.parameter, value))
    frames = [
        SweptFrame(number, status == "ok")
        for status, most in (("failed", spec.failed), ("ok", spec.read))
        for number in shared.flights.results.sample(flight, status, most)
    ]
    if not frames:
        raise SpecError(
            "there is no frame to sweep over: ask for more, or wait for the flight's first results",
            code="no_frames",
        )
    job = shared.flights.picture_job(flight_id, frames[0].frame, Path())
    method, texts = spec.method or flight.request["method"], json.dumps(params, sort_keys=True)
    recipe = Recipe(job.recipe.pad, job.recipe.camera, method, texts, job.recipe.others)
    frames.sort(key=lambda item: item.frame)
    return recipe, Sweep(flight_id, spec.parameter, list(spec.values), frames)
