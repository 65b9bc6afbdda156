"""One simulated frame, at once."""

from __future__ import annotations

from fastapi import APIRouter
from fastapi.concurrency import run_in_threadpool

from padstudio.simulate.looks import LOOKS
from padstudio.simulate.radiance.scene import GROUND_KINDS
from padstudio.web.api.cameras import camera_text
from padstudio.web.schemas.planning import FrameSpec, LookInfo, LookList, SimulatedFrame
from padstudio.web.server.services import ERRORS, Shared
from padstudio.workers import frames

router = APIRouter(prefix="/simulate", tags=["simulate"], responses=ERRORS)


@router.post("", operation_id="simulateFrame", summary="A picture of a pad, with its truth")
async def simulate_frame(spec: FrameSpec, shared: Shared) -> SimulatedFrame:
    settings, store = shared.settings, shared.store
    pad = None
    if spec.pad is not None:
        pad = (await run_in_threadpool(store.pads.get, spec.pad)).content
    camera = await run_in_threadpool(camera_text, store, spec.camera)
    found = await shared.run(
        frames.simulate_frame,
        *(spec.model_dump(), pad, camera, settings.max_simulated_pixels),
        timeout_s=settings.simulate_seconds,
    )
    return SimulatedFrame(**found)


@router.get("/looks", operation_id="listLooks", summary="Conditions to simulate under")
def list_looks() -> LookList:
    items = [LookInfo(name=name, note=look.note) for name, look in LOOKS.items()]
    return LookList(items=items, grounds=list(GROUND_KINDS))
