"""Simulated frames, at once; simulated flights, as jobs: kept as uploads, and analysed."""

from __future__ import annotations

from fastapi import APIRouter, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse

from padstudio.errors import ConflictError, LimitError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.simulate.disturbances import WORDS
from padstudio.simulate.looks import LOOKS
from padstudio.simulate.radiance.scene import GROUND_KINDS
from padstudio.simulate.trajectories import VIDEO_KINDS
from padstudio.store.database.data_folder import remove
from padstudio.store.uploads.uploads import upload_file
from padstudio.web.api.cameras import camera_text
from padstudio.web.api.flights.flights import order_flight
from padstudio.web.schemas.flights import NewFlight
from padstudio.web.schemas.planning import (
    DisturbanceInfo,
    FrameSpec,
    LookInfo,
    LookList,
    SimulatedFrame,
)
from padstudio.web.schemas.simulations import Simulation, SimulationSpec
from padstudio.web.server.services import (
    ERRORS,
    PARTS,
    ItemId,
    Services,
    Shared,
    accepted,
    attachment,
    file_answer,
)
from padstudio.web.server.simulation_service import SimulationJob
from padstudio.workers import frames, simulated_flights

router = APIRouter(tags=["simulate"], responses=ERRORS)

_ZIP = file_answer("Pictures or video, truth, pad and camera.", "application/zip") | PARTS


@router.post(
    "/simulate", operation_id="simulateFrame", summary="A picture of a pad, with its truth"
)
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


@router.get("/simulate/looks", operation_id="listLooks", summary="Conditions to simulate under")
def list_looks() -> LookList:
    items = [LookInfo(name=name, note=look.note) for name, look in LOOKS.items()]
    words = [
        DisturbanceInfo(name=name, form=word.form, note=word.note) for name, word in WORDS.items()
    ]
    return LookList(items=items, grounds=list(GROUND_KINDS), disturbances=words)


@router.post(
    "/simulations",
    operation_id="simulateFlight",
    summary="Simulate a flight over a pad",
    status_code=202,
)
async def simulate_flight(spec: SimulationSpec, shared: Shared, response: Response) -> Simulation:
    settings, store = shared.settings, shared.store
    pad, camera = await run_in_threadpool(_checked, spec, shared)
    job = SimulationJob(
        name=spec.name or f"simulated {spec.flight}, {spec.look}",
        frames_total=spec.frames,
        video=_is_video(spec, Camera.loads(camera)),
        folder=await run_in_threadpool(store.folder.work_folder),
    )

    async def work(job: SimulationJob) -> None:
        await shared.work(
            simulated_flights.simulate_flight,
            *(spec.model_dump(), pad, camera, job.video, job.folder),
            timeout_s=settings.simulate_flight_seconds,
        )
        await run_in_threadpool(_hand_over, job, spec, shared)

    try:
        shared.simulations.start(job, work)
    except LimitError:
        remove(job.folder)
        raise
    return accepted(response, "simulations", job, Simulation)


@router.get(
    "/simulations/{simulation_id}", operation_id="getSimulation", summary="How far a flight is"
)
async def get_simulation(simulation_id: ItemId, shared: Shared) -> Simulation:
    return Simulation.model_validate(shared.simulations.get(simulation_id))


@router.get(
    "/simulations/{simulation_id}/files/flight.zip",
    operation_id="getSimulationFile",
    summary="Pictures or video with truth, pad and camera",
    response_class=FileResponse,
    responses=_ZIP,
)
async def get_simulation_file(simulation_id: ItemId, shared: Shared) -> FileResponse:
    job = shared.simulations.get(simulation_id)
    if job.state != "done":
        raise ConflictError(
            f"the flight is {job.state}; only one that is done has files", code="not_done"
        )
    return FileResponse(
        job.folder / simulated_flights.ARCHIVE,
        media_type="application/zip",
        headers=attachment(job.name, ".zip"),
    )


@router.delete(
    "/simulations/{simulation_id}",
    operation_id="deleteSimulation",
    summary="Stop a flight that is not done; else forget its archive",
    status_code=204,
)
async def delete_simulation(simulation_id: ItemId, shared: Shared) -> None:
    shared.simulations.remove(simulation_id)


def _checked(spec: SimulationSpec, shared: Services) -> tuple[str | None, str]:
    """The content of the pad and of the camera file, where the flight can be simulated."""
    store, settings = shared.store, shared.settings
    if spec.analyze is not None and spec.pad is None:
        raise SpecError("an analysis needs a pad; choose one, or leave `analyze` out")
    if spec.frames > settings.max_flight_frames:
        raise LimitError(
            f"{spec.frames} frames are asked for at once; this server simulates at most "
            f"{settings.max_flight_frames}: take fewer, or `padstudio simulate`",
            code="too_many_frames",
            detail={"frames": spec.frames, "limit": settings.max_flight_frames},
        )
    pad = None if spec.pad is None else store.pads.get(spec.pad).content
    camera = camera_text(store, spec.camera)
    simulated_flights.check_flight(spec.model_dump(), pad, camera, settings.max_simulated_pixels)
    return pad, camera


def _is_video(spec: SimulationSpec, camera: Camera) -> bool:
    odd = camera.width % 2 or camera.height % 2
    stills = bool(odd) if spec.stills is None else spec.stills
    return spec.flight in VIDEO_KINDS and not stills


def _hand_over(job: SimulationJob, spec: SimulationSpec, shared: Services) -> None:
    """Make the footage an upload, and a flight of it where one is wanted."""
    if job.state == "cancelled":
        return
    footage = job.folder / simulated_flights.FOOTAGE
    name = f"{job.name}.{'mp4' if job.video else 'zip'}"
    job.upload = upload_file(shared.store.uploads, footage, name).id
    footage.unlink()
    if spec.analyze is not None and spec.pad is not None:
        new = NewFlight.model_validate(
            {
                "uploads": [job.upload],
                "pad": spec.pad,
                "camera": spec.camera,
                "method": spec.analyze,
                "name": job.name,
            }
        )
        job.flight = order_flight(new, shared).id
