"""Pads: preview, create, import, list, get, rename, verify, delete."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import PurePosixPath
from typing import Annotated, Any

from fastapi import APIRouter, Depends, File, Query, Response, UploadFile
from fastapi.concurrency import run_in_threadpool

from padstudio.errors import LimitError
from padstudio.pad.coding import pad_spec
from padstudio.pad.coding.search import bounds
from padstudio.pad.spec import MAX_CELLS
from padstudio.store.store import Stored
from padstudio.web.api.cameras import file_name
from padstudio.web.schemas.base import (
    NewName,
    PadDetail,
    PadList,
    PadPreview,
    PadSpec,
    PadSummary,
    PadVerification,
)
from padstudio.web.schemas.pads import PadBounds, table_sizes
from padstudio.web.server.services import (
    A_WHILE,
    ERRORS,
    KNOWN,
    ItemId,
    Services,
    Shared,
    check_size,
    file_answer,
    tell_known,
)
from padstudio.workers import pads as design
from padstudio.workers import thumbnails

router = APIRouter(prefix="/pads", tags=["pads"], responses=ERRORS)

# Ends a search that does not look at its own budget.
_GRACE_S = 15.0


@router.post(
    "/preview",
    operation_id="previewPad",
    summary="Generate a pad without storing it",
    response_model=PadPreview,
)
async def preview_pad(spec: PadSpec, shared: Shared) -> Response:
    made = await _generate(spec, shared)
    return _with_content({"verification": made.verification}, made.content)


@router.post(
    "",
    operation_id="createPad",
    summary="Generate and store a pad",
    status_code=201,
    responses=KNOWN,
)
async def create_pad(spec: PadSpec, shared: Shared, response: Response) -> PadSummary:
    made = await _generate(spec, shared)
    return await _store(made, shared, response)


@router.post(
    "/bounds", operation_id="getPadBounds", summary="What can be known of a pad beforehand"
)
def get_pad_bounds(spec: PadSpec) -> PadBounds:
    return PadBounds(**_bounds_record(bounds.bounds(_with_seed(spec))))


@router.post(
    "/import",
    operation_id="importPad",
    summary="Store a pad file, or a table or picture of a field",
    status_code=201,
    responses=KNOWN,
)
async def import_pad(
    file: Annotated[
        UploadFile,
        File(description="A pad file (.json), .csv, .npy, .field, or one pixel a cell."),
    ],
    shared: Shared,
    sizes: Annotated[design.TableSizes, Depends(table_sizes)],
    response: Response,
) -> PadSummary:
    check_size(file.size, shared.settings.max_upload_bytes, "file")
    path = PurePosixPath(file_name(file, "pad"))
    budget_s = shared.settings.generate_seconds
    made = await shared.run(
        design.read,
        *(await file.read(), path.suffix.lower(), replace(sizes, name=sizes.name or path.stem)),
        budget_s,
        timeout_s=budget_s + _GRACE_S,
    )
    return await _store(made, shared, response)


@router.get("", operation_id="listPads", summary="The stored pads, newest first")
def list_pads(
    shared: Shared,
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
    offset: Annotated[int, Query(ge=0, le=2**31)] = 0,
) -> PadList:
    stored, total = shared.store.pads.list(limit, offset)
    return PadList(items=[pad_summary(item) for item in stored], total=total)


@router.get(
    "/{pad_id}", operation_id="getPad", summary="A pad with its codes", response_model=PadDetail
)
def get_pad(pad_id: ItemId, shared: Shared) -> Response:
    stored = shared.store.pads.get(pad_id)
    return _with_content(pad_summary(stored).model_dump(mode="json"), stored.content or "")


@router.get(
    "/{pad_id}/verification",
    operation_id="verifyPad",
    summary="Prove the properties of a stored pad",
)
async def verify_pad(pad_id: ItemId, shared: Shared) -> PadVerification:
    stored = await run_in_threadpool(shared.store.pads.get, pad_id)
    found = await shared.run(
        design.verify_content,
        stored.content or "",
        timeout_s=shared.settings.generate_seconds,
    )
    return PadVerification(verification=found)


@router.patch("/{pad_id}", operation_id="renamePad", summary="Call a pad otherwise")
async def rename_pad(pad_id: ItemId, new: NewName, shared: Shared) -> PadSummary:
    stored = await run_in_threadpool(shared.store.pads.get, pad_id)
    made = await shared.run(
        design.rename,
        *(stored.content or "", new.name.strip()),
        timeout_s=shared.settings.generate_seconds,
    )
    replace_pad = shared.store.pads.replace
    return pad_summary(await run_in_threadpool(replace_pad, pad_id, made.content, made.summary))


@router.get(
    "/{pad_id}/thumbnail.png",
    operation_id="getPadThumbnail",
    summary="A small picture of a pad, as it is printed",
    response_class=Response,
    responses=file_answer("The picture.", "image/png"),
)
async def get_pad_thumbnail(pad_id: ItemId, shared: Shared) -> Response:
    stored = await run_in_threadpool(shared.store.pads.get, pad_id)
    data = await shared.run(
        thumbnails.of_pad, stored.content or "", timeout_s=shared.settings.generate_seconds
    )
    return Response(data, media_type="image/png", headers=A_WHILE)


@router.delete("/{pad_id}", operation_id="deletePad", summary="Remove a pad", status_code=204)
def delete_pad(pad_id: ItemId, shared: Shared) -> None:
    shared.store.pads.delete(pad_id)


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
    # What no search can find is refused here, at once.
    bounds.check_possible(_with_seed(spec))
    budget_s, asked = settings.generate_seconds, spec.model_dump()
    made = shared.grown.find(asked)
    if made is None:
        made = await shared.run(design.generate, asked, budget_s, timeout_s=budget_s + _GRACE_S)
    elif not shared.grown.holds(asked):
        made = await shared.run(
            design.resize, made, spec.name, spec.cell_mm, spec.quiet_mm, timeout_s=budget_s
        )
    shared.grown.keep(asked, made)
    return made


def _with_seed(spec: PadSpec) -> pad_spec.PadSpec:
    """The spec, with any seed where none is given: what can be does not depend on it."""
    return pad_spec.PadSpec(**{**spec.model_dump(), "seed": spec.seed or 0})


def _bounds_record(found: bounds.Bounds) -> dict[str, Any]:
    """Counts as logarithms: many are beyond what JSON readers hold."""
    counts = {
        "log10_possible": found.windows_possible,
        "log10_allowed": found.windows_allowed,
        "log10_at_most": found.windows_at_most,
    }
    return {
        **{name: math.log10(count) if count > 0 else None for name, count in counts.items()},
        "windows_needed": found.windows_needed,
        "share": found.share if math.isfinite(found.share) else None,
        "largest_square": min(found.largest_square, MAX_CELLS),
        "outlook": found.outlook,
    }


async def _store(made: design.Design, shared: Services, response: Response) -> PadSummary:
    stored = await run_in_threadpool(shared.store.pads.add, made.content, made.summary)
    tell_known(stored, response)
    return pad_summary(stored)


def pad_summary(stored: Stored) -> PadSummary:
    """What lists show of a stored pad."""
    return PadSummary(id=stored.id, created_at=stored.created_at, **stored.summary)


def _with_content(values: dict[str, Any], content: str) -> Response:
    """An object whose ``pad`` is a pad file, which is JSON already and may be megabytes of it."""
    head = json.dumps(values, ensure_ascii=False).removesuffix("}")
    return Response(f'{head}, "pad": {content}}}', media_type="application/json")
