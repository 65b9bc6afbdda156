"""Prints: files to print, sheets, the size that a print came out at, the test strip."""

from __future__ import annotations

from typing import Annotated, Literal, cast

from fastapi import APIRouter, File, Form, Query, Response, UploadFile
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask

from padstudio.pad.print_scale import with_measured_size
from padstudio.pad.sheets.tiling import plan_sheets
from padstudio.pad.spec import Pad
from padstudio.render import documents
from padstudio.store.database.data_folder import remove
from padstudio.web.api.pads import pad_summary
from padstudio.web.schemas.asked import Flag
from padstudio.web.schemas.base import PadSummary
from padstudio.web.schemas.printing import (
    CrosstalkInfo,
    MeasuredSize,
    PrintQuery,
    SheetPlanInfo,
    SheetQuery,
    SheetsRequest,
)
from padstudio.web.server.services import (
    ERRORS,
    PARTS,
    ItemId,
    Services,
    Shared,
    attachment,
    check_size,
    file_answer,
)
from padstudio.workers import pads as design
from padstudio.workers import prints

router = APIRouter(tags=["printing"], responses=ERRORS)

Kind = Literal["json", "pdf", "svg", "png", "dxf", "csv", "npy", "strip.pdf"]
_FILE = (
    file_answer("The file, as an attachment.", "application/json", *documents.MEDIA_TYPES.values())
    | PARTS
)


@router.get(
    "/pads/{pad_id}/files/pad.{kind}",
    operation_id="getPadFile",
    summary="A pad as a file: for programs, for print, to look at",
    response_class=FileResponse,
    responses=_FILE,
)
async def get_pad_file(
    pad_id: ItemId, kind: Kind, options: Annotated[PrintQuery, Query()], shared: Shared
) -> Response:
    stored = await run_in_threadpool(shared.store.pads.get, pad_id)
    name, content = stored.summary["name"], stored.content or ""
    if kind == "json":
        headers = attachment(name, ".json")
        return Response(content, media_type="application/json", headers=headers)
    return await _painted(name, content, kind, options, shared)


@router.get(
    "/pads/{pad_id}/sheets", operation_id="getPadSheets", summary="A stored pad over sheets"
)
def get_pad_sheets(
    pad_id: ItemId, options: Annotated[SheetQuery, Query()], shared: Shared
) -> SheetPlanInfo:
    pad = Pad.loads(shared.store.pads.get(pad_id).content or "")
    return SheetPlanInfo(**plan_sheets(pad, options.sheet_options()).to_dict())


@router.post("/sheets", operation_id="planSheets", summary="Sizes of a pad over sheets")
def plan_a_shape(request: SheetsRequest) -> SheetPlanInfo:
    plan = plan_sheets(request.pad.blank_pad(), request.options.sheet_options())
    return SheetPlanInfo(**plan.to_dict())


@router.put(
    "/pads/{pad_id}/scale",
    operation_id="setPadScale",
    summary="Enter the size that a pad's print came out at",
)
def set_pad_scale(pad_id: ItemId, size: MeasuredSize, shared: Shared) -> PadSummary:
    pad = Pad.loads(shared.store.pads.get(pad_id).content or "")
    measured = with_measured_size(pad, ruler_mm=size.ruler_mm, x_mm=size.x_mm, y_mm=size.y_mm)
    return _replace(pad_id, measured, shared)


@router.post(
    "/pads/{pad_id}/crosstalk",
    operation_id="measureCrosstalk",
    summary="Read a photo of the test strip, and un-mix the pad's frames by it",
)
async def measure_crosstalk(
    pad_id: ItemId,
    image: Annotated[UploadFile, File(description="A photo of the printed test strip.")],
    shared: Shared,
    keep: Annotated[Flag, Form(description="Keep it with the pad, where it is usable.")] = True,
) -> CrosstalkInfo:
    settings = shared.settings
    check_size(image.size, settings.max_upload_bytes, "photo")
    await run_in_threadpool(shared.store.pads.get, pad_id)
    found = await shared.run(
        prints.read_strip,
        *(await image.read(), settings.max_image_pixels),
        timeout_s=settings.detect_seconds,
    )
    kept = keep and found["usable"]
    if kept:
        await run_in_threadpool(_keep_crosstalk, pad_id, found["matrix"], shared)
    return CrosstalkInfo(**found, kept=kept)


@router.delete(
    "/pads/{pad_id}/crosstalk",
    operation_id="forgetCrosstalk",
    summary="Un-mix the pad's frames no longer",
)
def forget_crosstalk(pad_id: ItemId, shared: Shared) -> PadSummary:
    return _keep_crosstalk(pad_id, None, shared)


def _keep_crosstalk(pad_id: str, matrix: list[list[float]] | None, shared: Services) -> PadSummary:
    pad = Pad.loads(shared.store.pads.get(pad_id).content or "")
    return _replace(pad_id, pad.with_crosstalk(matrix), shared)


def _replace(pad_id: str, pad: Pad, shared: Services) -> PadSummary:
    stored = shared.store.pads.replace(pad_id, pad.dumps(), design.summarize(pad))
    return pad_summary(stored)


async def _painted(
    name: str, content: str, kind: str, options: PrintQuery, shared: Services
) -> Response:
    """A form of the pad, painted by a worker into a file that goes once it is sent."""
    form = cast("documents.Form", "strip" if kind == "strip.pdf" else kind)
    chosen = options.print_options()
    settings = shared.settings
    folder = await run_in_threadpool(shared.store.folder.work_folder)
    target = folder / "pad"
    try:
        media_type = await shared.run(
            prints.paint,
            *(content, form, chosen, options.channel, settings.max_paint_pixels, target),
            timeout_s=settings.paint_seconds,
        )
    except BaseException:
        remove(folder)
        raise
    suffix = "zip" if media_type == documents.MEDIA_TYPES["zip"] else kind.rpartition(".")[2]
    stem = f"{name}-strip" if form == "strip" else name
    return FileResponse(
        target,
        media_type=media_type,
        headers=attachment(stem, f".{suffix}"),
        background=BackgroundTask(remove, folder),
    )
