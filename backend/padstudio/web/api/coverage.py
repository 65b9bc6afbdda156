"""Coverage: heights and tilts at which a pad reads, from geometry and from simulation; advice."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.concurrency import run_in_threadpool

from padstudio.errors import LimitError
from padstudio.geometry.camera import Camera
from padstudio.pad.coverage import advice
from padstudio.pad.coverage import spans as coverage
from padstudio.pad.coverage.dead_bands import DeadBand, dead_bands
from padstudio.pad.coverage.pinhole import View
from padstudio.pad.coverage.spans import METHOD_LIMITS, Span
from padstudio.pad.spec import Pad
from padstudio.simulate.success_map import view_of
from padstudio.store.store import Store
from padstudio.web.api.cameras import camera_text
from padstudio.web.schemas.asked import Tilt
from padstudio.web.schemas.planning import (
    AdviceInfo,
    AdviceQuery,
    CoverageChart,
    CoverageRequest,
    DeadBandInfo,
    MapRequest,
    MethodCoverage,
    SpanInfo,
    SuccessMapInfo,
    ViewInfo,
)
from padstudio.web.server.services import ERRORS, ItemId, Shared
from padstudio.workers import frames as simulating

router = APIRouter(tags=["coverage"], responses=ERRORS)


@router.get(
    "/pads/{pad_id}/coverage",
    operation_id="getPadCoverage",
    summary="Where a stored pad reads, from geometry",
)
def get_pad_coverage(
    pad_id: ItemId,
    camera: Annotated[str, Query(max_length=200, examples=["preset-dji-mini-27k"])],
    shared: Shared,
    tilt_deg: Annotated[
        list[Tilt], Query(min_length=1, max_length=200, description="May be given repeatedly.")
    ] = [0.0],  # noqa: B006 - FastAPI copies it
) -> CoverageChart:
    pad = Pad.loads(shared.store.pads.get(pad_id).content or "")
    return _chart(pad, camera, tilt_deg, shared.store)


@router.post(
    "/coverage",
    operation_id="planCoverage",
    summary="Where a pad of some sizes reads, from geometry",
)
def plan_coverage(request: CoverageRequest, shared: Shared) -> CoverageChart:
    return _chart(request.pad.blank_pad(), request.camera, request.tilts_deg, shared.store)


@router.post(
    "/pads/{pad_id}/coverage",
    operation_id="simulateCoverage",
    summary="Where a stored pad reads, from simulated frames",
)
async def simulate_coverage(pad_id: ItemId, request: MapRequest, shared: Shared) -> SuccessMapInfo:
    settings, store = shared.settings, shared.store
    frames = len(request.heights_mm) * len(request.values) * request.trials
    if frames > settings.max_simulated_frames:
        raise LimitError(
            f"the map asks for {frames} frames; this server simulates at most "
            f"{settings.max_simulated_frames} at once: ask for parts of it, one after the other",
            code="too_many_frames",
            detail={"frames": frames, "limit": settings.max_simulated_frames},
        )
    pad = (await run_in_threadpool(store.pads.get, pad_id)).content or ""
    camera = await run_in_threadpool(camera_text, store, request.camera)
    found = await shared.run(
        simulating.simulate_map,
        *(request.model_dump(), pad, camera, settings.max_simulated_pixels),
        timeout_s=settings.simulate_seconds,
    )
    return SuccessMapInfo(**found)


@router.get("/advice", operation_id="getAdvice", summary="Sizes of a pad for a range of heights")
def get_advice(query: Annotated[AdviceQuery, Query()], shared: Shared) -> AdviceInfo:
    found = advice.advise(
        _view(query.camera, shared.store),
        advice.Envelope(query.low_mm, query.high_mm, query.tilt_deg, query.reach_mm),
        window=query.window,
        levels=query.levels,
        limits=METHOD_LIMITS[query.method],
    )
    return AdviceInfo(
        window=query.window,
        levels=query.levels,
        cell_mm=found.cell_mm,
        ratio=found.ratio,
        cells=found.cells,
        size_mm=found.size_mm,
        low_mm=found.low_mm,
        high_mm=found.high_mm,
        notes=list(found.notes),
    )


def _view(camera: str, store: Store) -> View:
    return view_of(Camera.loads(camera_text(store, camera)))


def _chart(pad: Pad, camera: str, tilts_deg: list[float], store: Store) -> CoverageChart:
    view = _view(camera, store)
    methods = [
        MethodCoverage(
            method=method,
            cell_px=limits.cell_px,
            sign_cell_px=limits.sign_cell_px,
            spans=[_span(span) for span in coverage.coverage(pad, view, limits, tilts_deg)],
            dead_bands=[
                _band(tilt, band)
                for tilt in tilts_deg
                for band in dead_bands(pad, view, limits, tilt)
            ],
        )
        for method, limits in METHOD_LIMITS.items()
    ]
    return CoverageChart(camera=camera, view=ViewInfo(**asdict(view)), methods=methods)


def _span(span: Span) -> SpanInfo:
    low, high = (span.low_mm, span.high_mm) if span.reads else (None, None)
    return SpanInfo(layer=span.layer, tilt_deg=span.tilt_deg, low_mm=low, high_mm=high)


def _band(tilt_deg: float, band: DeadBand) -> DeadBandInfo:
    return DeadBandInfo(
        tilt_deg=tilt_deg, low_mm=band.low_mm, high_mm=band.high_mm, message=band.message
    )
