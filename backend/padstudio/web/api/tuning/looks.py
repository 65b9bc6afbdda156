"""A frame read under other parameters, at once: its pose, its stages, its cells."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from fastapi import APIRouter, Response
from fastapi.concurrency import run_in_threadpool

from padstudio.flights.tasks.detectors import Recipe, params_from
from padstudio.flights.tuning import looks
from padstudio.flights.tuning.bench import Subject
from padstudio.vision.stage.parameter import Parameter, parameters_of
from padstudio.vision.stage.params import DetectorParams
from padstudio.web.api.cameras import camera_text
from padstudio.web.schemas.tuning import (
    CellsAnswer,
    CellsRequest,
    FrameReading,
    Look,
    LookRequest,
    ParameterInfo,
    ParameterList,
)
from padstudio.web.server.services import ERRORS, Services, Shared
from padstudio.workers.detection import FRAME_FILE

router = APIRouter(tags=["tune"], responses=ERRORS)


@router.get(
    "/parameters", operation_id="listParameters", summary="What of the detector can be tuned"
)
def list_parameters() -> ParameterList:
    return ParameterList(items=[_info(item) for item in parameters_of(DetectorParams())])


def _info(item: Parameter) -> ParameterInfo:
    return ParameterInfo.model_validate({**vars(item), **vars(item.scope)})


@router.post(
    "/looks",
    operation_id="lookAtFrame",
    summary="A frame under other parameters",
    response_model=Look,
)
async def look_at_frame(asked: LookRequest, shared: Shared) -> Response:
    bench = await run_in_threadpool(on_the_bench, asked, shared)
    views = [looks.View(**view.model_dump()) for view in asked.views]
    found = await shared.run_at(
        bench.subject.name,
        looks.look_json,
        *(bench.subject, bench.recipe, views, bench.source),
        timeout_s=shared.settings.detect_seconds,
    )
    return Response(found, media_type="application/json")


@router.post("/cells", operation_id="compareCells", summary="Expected against read, cell by cell")
async def compare_cells(asked: CellsRequest, shared: Shared) -> CellsAnswer:
    bench = await run_in_threadpool(on_the_bench, asked, shared)
    pose = asked.pose.model_dump() if asked.pose else None
    found = await shared.run_at(
        bench.subject.name,
        looks.compare,
        *(bench.subject, bench.recipe, pose, asked.corners),
        timeout_s=shared.settings.detect_seconds,
    )
    return CellsAnswer.model_validate(found)


@dataclass(frozen=True)
class OnTheBench:
    """A frame that a request names, how it is read, and its name."""

    subject: Subject
    recipe: Recipe
    source: str


def on_the_bench(asked: FrameReading, shared: Services) -> OnTheBench:
    """The frame and the recipe that a request names; a wrong parameter costs no worker."""
    params_from(asked.params)
    store, most = shared.store, shared.settings.max_image_pixels
    pad = store.pads.get(asked.pad).content if asked.pad else None
    camera = camera_text(store, asked.camera) if asked.camera else None
    others = tuple(store.pads.get(other).content or "" for other in asked.others)
    params = json.dumps(asked.params, sort_keys=True)
    if asked.trace is not None:
        source = store.traces.body(asked.trace)["result"]["source"]
        place = store.traces.picture(asked.trace, FRAME_FILE)
        recipe = Recipe(pad or "", camera or "", asked.method, params, others)
        return OnTheBench(Subject(asked.trace, place, most), recipe, source)
    assert asked.flight is not None
    assert asked.frame is not None
    job = shared.flights.picture_job(asked.flight, asked.frame, Path())
    own = job.recipe
    known = (pad, others) if pad else (own.pad, own.others)
    recipe = Recipe(known[0], camera or own.camera, asked.method, params, known[1])
    subject = Subject(f"{asked.flight}-{asked.frame}", job.part, job.max_pixels)
    return OnTheBench(subject, recipe, job.part.name)
