"""Bundles: a frame with all that its result rests on, in one zip; made, and opened again."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import IO, Annotated, Any

from fastapi import APIRouter, File, UploadFile
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse

from padstudio.flights.bundles import making, opening
from padstudio.flights.bundles.runs import frame_of_run
from padstudio.geometry.camera import Camera
from padstudio.store.database.data_folder import remove
from padstudio.store.store import Store, new_id
from padstudio.web.api.cameras import id_of_camera
from padstudio.web.api.tuning.looks import OnTheBench, on_the_bench
from padstudio.web.schemas.bundles import BundleRequest, KeptAnswer
from padstudio.web.server.services import (
    ERRORS,
    Services,
    Shared,
    attachment,
    check_size,
    file_answer,
)

router = APIRouter(prefix="/bundles", tags=["tune"], responses=ERRORS)

_ZIP = file_answer("The bundle, as an attachment.", "application/zip")
# Frames that are followed in the time that one is looked at in full, with room to spare.
_FRAMES_A_LOOK = 30
_PART_BYTES = 1 << 20


@router.post(
    "",
    operation_id="makeBundle",
    summary="A frame with all that its result rests on, as a zip",
    response_class=StreamingResponse,
    responses=_ZIP,
)
async def make_bundle(asked: BundleRequest, shared: Shared) -> StreamingResponse:
    bench = await run_in_threadpool(on_the_bench, asked, shared)
    subject = await run_in_threadpool(_subject, asked, bench, shared)
    folder = await run_in_threadpool(shared.store.folder.work_folder)
    try:
        target = folder / "bundle.zip"
        most = bench.subject.max_pixels
        job = making.Job(subject, bench.recipe, bench.source, asked.view, most, target)
        await shared.work(making.make, job, timeout_s=_time_for(subject, shared))
        # The file is there until it is closed, whatever becomes of the connection.
        size, file = target.stat().st_size, target.open("rb")
    finally:
        remove(folder)
    name = PurePosixPath(bench.source).stem
    name = name if asked.frame is None else f"{name} frame {asked.frame}"
    headers = {**attachment(name, ".bundle.zip"), "Content-Length": str(size)}
    return StreamingResponse(_parts_of(file), media_type="application/zip", headers=headers)


def _subject(asked: BundleRequest, bench: OnTheBench, shared: Services) -> Path | making.RunFrame:
    if asked.flight is None or asked.frame is None:
        assert isinstance(bench.subject.source, Path)
        return bench.subject.source
    flight = shared.flights.flights.get(asked.flight, texts=True)
    return frame_of_run(flight, shared.flights.results, asked.frame)


def _time_for(subject: Path | making.RunFrame, shared: Services) -> float:
    """Time to read a frame, and to follow the pad through those before it."""
    frames = 0 if isinstance(subject, Path) else subject.frames
    return shared.settings.detect_seconds * (2 + frames / _FRAMES_A_LOOK)


def _parts_of(file: IO[bytes]) -> Iterator[bytes]:
    with file:
        while part := file.read(_PART_BYTES):
            yield part


@router.post(
    "/open",
    operation_id="openBundle",
    summary="Store what a bundle holds, and read its frame again",
    status_code=201,
)
async def open_bundle(
    file: Annotated[UploadFile, File(description="A bundle, *.zip.")], shared: Shared
) -> KeptAnswer:
    settings = shared.settings
    check_size(file.size, settings.max_bundle_bytes, "bundle")
    work = await run_in_threadpool(shared.store.folder.work_folder)
    folder = await run_in_threadpool(shared.store.folder.work_folder)
    try:
        path = work / "bundle.zip"
        await run_in_threadpool(_write, file.file, path)
        found = await shared.run(
            opening.open_bundle,
            *(path, folder, settings.max_image_pixels),
            timeout_s=2 * settings.detect_seconds,
        )
        return await run_in_threadpool(_keep, shared.store, found, folder)
    finally:
        remove(work)
        remove(folder)


def _write(source: IO[bytes], path: Path) -> None:
    with path.open("wb") as target:
        shutil.copyfileobj(source, target)


def _keep(store: Store, found: dict[str, Any], folder: Path) -> KeptAnswer:
    """Store pads and camera, or find them stored; keep the frame as a trace."""
    trace_id = new_id()
    base = f"/api/v1/detect/{trace_id}/pictures/"
    stored = [store.pads.add(made.content, made.summary) for made, _ in found["pads"]]
    pads = [
        {"id": pad.id, "name": pad.summary.get("name", ""), "pad_id": printed}
        for pad, (_, printed) in zip(stored, found["pads"], strict=True)
    ]
    told = found["bundle"]
    now = told.pop("now")
    for each in told["neighbours"]:
        each["picture"] = each["picture"] and base + each["picture"]
    report = {
        **told,
        "pad": pads[0]["id"],
        "others": [pad["id"] for pad in pads[1:]],
        "camera": id_of_camera(store, Camera.loads(found["camera"])),
        "result_now": now.pop("result"),
        "recorded_now": now.pop("recorded"),
        "alone_now": now.pop("alone"),
        **now,
    }
    answer = KeptAnswer.model_validate(
        {
            "result": found["result"],
            "results": [found["result"]],
            "pads": pads,
            "image": found["image"],
            "camera_scale": found["camera_scale"],
            "trace": {"id": trace_id, "result_picture": None, "stages": []},
            "bundle": report,
        }
    )
    store.traces.add(trace_id, folder, answer.model_dump(mode="json"))
    return answer
