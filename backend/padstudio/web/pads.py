"""Pads: preview, create, import, list, get, delete, files."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from fastapi import APIRouter, File, Query, Response, UploadFile
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask

from padstudio.errors import LimitError
from padstudio.flights import design
from padstudio.flights.store import Stored
from padstudio.flights.store_files import remove
from padstudio.web import painting
from padstudio.web.schemas import PadDetail, PadList, PadPreview, PadSpec, PadSummary
from padstudio.web.services import ERRORS, ItemId, Services, Shared, attachment, check_size

router = APIRouter(prefix="/pads", tags=["pads"], responses=ERRORS)

# Ends a search that does not look at its own budget.
_GRACE_S = 15.0
_FILE_EXAMPLES: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The file, as an attachment.",
        "content": {
            "application/json": {"schema": {"type": "object"}, "example": {"format": "..."}},
            **{
                media_type: {"schema": {"type": "string", "format": "binary"}}
                for media_type in painting.MEDIA_TYPES.values()
            },
        },
    }
}


@router.post(
    "/preview",
    operation_id="previewPad",
    summary="Generate a pad without storing it",
    response_model=PadPreview,
)
async def preview_pad(spec: PadSpec, shared: Shared) -> Response:
    made = await _generate(spec, shared)
    return _with_content({"verification": made.verification}, made.content)


@router.post("", operation_id="createPad", summary="Generate and store a pad", status_code=201)
async def create_pad(spec: PadSpec, shared: Shared) -> PadSummary:
    made = await _generate(spec, shared)
    return await _store(made, shared)


@router.post("/import", operation_id="importPad", summary="Store a pad file", status_code=201)
async def import_pad(
    file: Annotated[UploadFile, File(description="A pad file (JSON).")], shared: Shared
) -> PadSummary:
    check_size(file.size, shared.settings.max_upload_bytes, "pad file")
    content = await file.read()
    made = await shared.run(design.read, content, timeout_s=shared.settings.generate_seconds)
    return await _store(made, shared)


@router.get("", operation_id="listPads", summary="The stored pads, newest first")
def list_pads(
    shared: Shared,
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
    offset: Annotated[int, Query(ge=0, le=2**31)] = 0,
) -> PadList:
    stored, total = shared.store.pads.list(limit, offset)
    return PadList(items=[_summary(item) for item in stored], total=total)


@router.get(
    "/{pad_id}", operation_id="getPad", summary="A pad with its codes", response_model=PadDetail
)
def get_pad(pad_id: ItemId, shared: Shared) -> Response:
    stored = shared.store.pads.get(pad_id)
    return _with_content(_summary(stored).model_dump(mode="json"), stored.content or "")


@router.delete("/{pad_id}", operation_id="deletePad", summary="Remove a pad", status_code=204)
def delete_pad(pad_id: ItemId, shared: Shared) -> None:
    shared.store.pads.delete(pad_id)


@router.get(
    "/{pad_id}/files/pad.{kind}",
    operation_id="getPadFile",
    summary="A pad as a file: for programs, for print, to look at",
    response_class=FileResponse,
    responses=_FILE_EXAMPLES,
)
async def get_pad_file(
    pad_id: ItemId,
    kind: Literal["json", "pdf", "svg", "png"],
    shared: Shared,
    dpi: Annotated[float, Query(ge=1, le=2400, description="Of the PNG.")] = painting.DEFAULT_DPI,
) -> Response:
    stored = await run_in_threadpool(shared.store.pads.get, pad_id)
    content = stored.content or ""
    headers = attachment(stored.summary["name"], f".{kind}")
    if kind == "json":
        return Response(content, media_type="application/json", headers=headers)
    folder = await run_in_threadpool(shared.store.folder.work_folder)
    target = folder / f"pad.{kind}"
    settings = shared.settings
    try:
        await shared.run(
            painting.paint,
            *(content, kind, dpi, settings.max_paint_pixels, target),
            timeout_s=settings.paint_seconds,
        )
    except BaseException:
        remove(folder)
        raise
    return FileResponse(
        target,
        media_type=painting.MEDIA_TYPES[kind],
        headers=headers,
        background=BackgroundTask(remove, folder),
    )


async def _generate(spec: PadSpec, shared: Services) -> design.Design:
    settings = shared.settings
    for name, value, limit in (
        ("window", spec.window, settings.max_window),
        ("levels", spec.levels, settings.max_levels),
        ("rows", spec.rows, settings.max_cells),
        ("cols", spec.cols, settings.max_cells),
    ):
        if value > limit:
            raise LimitError(f"{name} is {value}; this server makes pads of at most {limit}")
    budget_s = settings.generate_seconds
    return await shared.run(
        design.generate, spec.model_dump(), budget_s, timeout_s=budget_s + _GRACE_S
    )


async def _store(made: design.Design, shared: Services) -> PadSummary:
    stored = await run_in_threadpool(shared.store.pads.add, made.content, made.summary)
    return _summary(stored)


def _summary(stored: Stored) -> PadSummary:
    return PadSummary(id=stored.id, created_at=stored.created_at, **stored.summary)


def _with_content(values: dict[str, Any], content: str) -> Response:
    """An object whose ``pad`` is a pad file, which is JSON already and may be megabytes of it."""
    head = json.dumps(values, ensure_ascii=False).removesuffix("}")
    return Response(f'{head}, "pad": {content}}}', media_type="application/json")
