"""Experiments of all kinds, as jobs whose results are kept."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path as FilePath
from typing import Annotated, Any

from fastapi import APIRouter, Path, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse

from padstudio.errors import LimitError, NotFoundError
from padstudio.experiments.writers import HTML_POLICY, MEDIA_TYPES
from padstudio.store.database.data_folder import remove
from padstudio.store.experiments import KeptExperiment
from padstudio.web.api.experiments.kinds import KINDS, NewExperiment
from padstudio.web.schemas.experiments.base import (
    ExperimentDetail,
    ExperimentFile,
    ExperimentInfo,
    ExperimentList,
)
from padstudio.web.server.experiment_service import ExperimentJob
from padstudio.web.server.services import (
    A_WHILE,
    ERRORS,
    PARTS,
    ItemId,
    Shared,
    accepted,
    attachment,
    file_answer,
)
from padstudio.workers.experiments import make_experiment
from padstudio.workers.frames import check_pixels

router = APIRouter(prefix="/experiments", tags=["experiments"], responses=ERRORS)

FileName = Annotated[
    str, Path(pattern=r"^[a-z0-9][a-z0-9-]{0,80}\.[a-z]{2,5}$", examples=["report.html"])
]
_FILE = file_answer("The file.", *MEDIA_TYPES.values()) | PARTS
# Everything else of a report is saved; these are looked at.
_SHOWN = (".html", ".svg", ".webp")
# An SVG that is opened by itself is a page.
_PICTURE_POLICY = "default-src 'none'; frame-ancestors 'none'; sandbox"


@router.post(
    "",
    operation_id="startExperiment",
    summary="Make an experiment on the simulator",
    status_code=202,
)
async def start_experiment(
    new: NewExperiment, shared: Shared, response: Response
) -> ExperimentInfo:
    kind = KINDS[new.kind]
    prepared = await run_in_threadpool(kind.prepare, new, shared.store)
    check_pixels(kind.camera(prepared), shared.settings.max_simulated_pixels)
    job = ExperimentJob(
        name=new.name or kind.name,
        kind=new.kind,
        order=new.model_dump(mode="json"),
        folder=await run_in_threadpool(shared.store.folder.work_folder),
    )

    async def work(job: ExperimentJob) -> None:
        await shared.work(
            make_experiment,
            *(kind.make, prepared, job.folder),
            timeout_s=shared.settings.experiment_seconds,
        )
        if job.state == "cancelled":
            return
        await run_in_threadpool(shared.store.experiments.add, job.kept, job.folder)
        # It may have been stopped meanwhile.
        if job.state == "cancelled":
            await run_in_threadpool(shared.store.experiments.delete, job.id)

    try:
        shared.experiments.start(job, work)
    except LimitError:
        remove(job.folder)
        raise
    return accepted(response, "experiments", job, ExperimentInfo)


@router.get("", operation_id="listExperiments", summary="The experiments, newest first")
def list_experiments(shared: Shared) -> ExperimentList:
    kept = shared.store.experiments.newest()
    known = {each.id for each in kept}
    waiting = [job for job in shared.experiments.all if job.id not in known and job.state != "done"]
    items = [ExperimentInfo.model_validate(job) for job in waiting]
    items += [ExperimentInfo(**_info(each)) for each in kept]
    return ExperimentList(items=sorted(items, key=lambda each: each.created_at, reverse=True))


@router.get(
    "/{experiment_id}", operation_id="getExperiment", summary="How far it is, and what came of it"
)
def get_experiment(experiment_id: ItemId, shared: Shared) -> ExperimentDetail:
    store = shared.store.experiments
    try:
        kept = store.get(experiment_id)
    except NotFoundError:
        info = ExperimentInfo.model_validate(shared.experiments.get(experiment_id))
        return ExperimentDetail(**info.model_dump(), files=[], result=None)
    files, result = _files(store.files(experiment_id)), store.result(experiment_id)
    return ExperimentDetail(**_info(kept), files=files, result=result)


@router.get(
    "/{experiment_id}/files/{name}",
    operation_id="getExperimentFile",
    summary="A file of an experiment's report",
    response_class=FileResponse,
    responses=_FILE,
)
def get_experiment_file(experiment_id: ItemId, name: FileName, shared: Shared) -> FileResponse:
    file = shared.store.experiments.file(experiment_id, name)
    headers = dict(A_WHILE)
    if file.suffix in _SHOWN:
        policy = HTML_POLICY if file.suffix == ".html" else _PICTURE_POLICY
        headers["Content-Security-Policy"] = policy
    else:
        headers |= attachment(file.stem, file.suffix)
    return FileResponse(file, media_type=MEDIA_TYPES[file.suffix], headers=headers)


@router.delete(
    "/{experiment_id}",
    operation_id="deleteExperiment",
    summary="Stop an experiment that is not done; else forget it",
    status_code=204,
)
async def delete_experiment(experiment_id: ItemId, shared: Shared) -> None:
    try:
        await run_in_threadpool(shared.store.experiments.delete, experiment_id)
    except NotFoundError:
        shared.experiments.remove(experiment_id)
    else:
        with suppress(NotFoundError):
            # Its job, which is over.
            shared.experiments.remove(experiment_id)


def _info(kept: KeptExperiment) -> dict[str, Any]:
    return {
        "id": kept.id,
        "kind": kept.kind,
        "name": kept.name,
        "state": "done",
        "created_at": kept.created_at,
        "order": kept.order,
        "steps_done": kept.steps,
        "steps_total": kept.steps,
        "error": None,
    }


def _files(paths: Sequence[FilePath]) -> list[ExperimentFile]:
    return [
        ExperimentFile(
            name=path.name, media_type=MEDIA_TYPES[path.suffix], size_bytes=path.stat().st_size
        )
        for path in paths
    ]
