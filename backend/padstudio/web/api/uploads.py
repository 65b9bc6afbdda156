"""Uploads by the tus 1.0 protocol; list, get and remove them as JSON too."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from fastapi.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect

from padstudio import text
from padstudio.errors import ConflictError
from padstudio.media.content import ContentError
from padstudio.store.uploads.files import Append
from padstudio.store.uploads.rows import Upload
from padstudio.store.uploads.uploads import Uploads
from padstudio.web.http import tus
from padstudio.web.http import tus_document as words
from padstudio.web.schemas.base import ErrorBody
from padstudio.web.schemas.uploads import UploadList, UploadSummary
from padstudio.web.server.services import ERRORS, ItemId, Services, Shared

_ERRORS: dict[int | str, dict[str, Any]] = ERRORS | {
    status: {"model": ErrorBody, "description": description}
    for status, description in {
        412: "Another version of tus.",
        415: "Another media type than the protocol's.",
        460: "The bytes do not match their checksum.",
    }.items()
}
router = APIRouter(prefix="/uploads", tags=["uploads"], responses=_ERRORS)

# Large enough that the disk and the change of thread cost little, small enough to lose.
_BLOCK_BYTES = 256 * 1024


@router.options(
    "",
    operation_id="getUploadOptions",
    summary="What of tus the server can do",
    status_code=204,
    responses={204: {"headers": words.ABLE}},
)
def get_upload_options(shared: Shared) -> Response:
    return Response(status_code=204, headers=tus.options(shared.settings.max_flight_bytes))


@router.post(
    "",
    operation_id="createUpload",
    summary="Announce an upload, and send its first bytes or none",
    status_code=201,
    responses={201: {"headers": words.CREATED}},
    openapi_extra=words.CREATE,
)
async def create_upload(request: Request, response: Response, shared: Shared) -> UploadSummary:
    headers = request.headers
    tus.check_version(headers)
    size_bytes, metadata = tus.length(headers), tus.metadata(headers)
    has_bytes = tus.carries_bytes(headers)
    checksum = tus.checksum(headers) if has_bytes else None
    upload = await run_in_threadpool(
        shared.store.uploads.create,
        _plain(metadata.get("filename") or metadata.get("name") or ""),
        size_bytes,
        metadata=headers.get("upload-metadata", ""),
    )
    if has_bytes:
        async with shared.turns.take(upload.id) as stop:
            append = await run_in_threadpool(shared.store.uploads.append, upload.id, 0, checksum)
            upload = await _receive(request, shared, upload.id, append, stop)
    response.headers.update(tus.describe(upload))
    response.headers["Location"] = f"{request.url.path.rstrip('/')}/{upload.id}"
    return UploadSummary.model_validate(upload)


@router.get("", operation_id="listUploads", summary="The uploads, newest first")
def list_uploads(
    shared: Shared,
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
    offset: Annotated[int, Query(ge=0, le=2**31)] = 0,
    sha256: Annotated[
        str | None,
        Query(pattern=r"^[0-9a-f]{64}$", description="Only complete ones of this content."),
    ] = None,
    announced_sha256: Annotated[
        str | None,
        Query(
            pattern=r"^[0-9a-f]{64}$",
            description="Only unfinished ones whose sender said this hash in `Upload-Metadata`, "
            "as `sha256`.",
        ),
    ] = None,
) -> UploadList:
    if announced_sha256 is None:
        found, total = shared.store.uploads.list(limit, offset, sha256)
    else:
        unfinished = shared.store.uploads.unfinished()
        announced = [upload for upload in unfinished if _said(upload) == announced_sha256]
        found, total = announced[offset : offset + limit], len(announced)
    items = [UploadSummary.model_validate(upload) for upload in found]
    return UploadList(items=items, total=total)


@router.get("/{upload_id}", operation_id="getUpload", summary="An upload")
def get_upload(upload_id: ItemId, shared: Shared) -> UploadSummary:
    return UploadSummary.model_validate(shared.store.uploads.get(upload_id))


@router.head(
    "/{upload_id}",
    operation_id="getUploadOffset",
    summary="How many bytes of an upload are there",
    response_class=Response,
    responses={200: {"headers": words.STANDING}},
    openapi_extra=words.ASK,
)
async def get_upload_offset(upload_id: ItemId, request: Request, shared: Shared) -> Response:
    tus.check_version(request.headers)
    # Whoever asks how far it is wants to go on from there.
    async with shared.turns.take(upload_id):
        upload = await run_in_threadpool(shared.store.uploads.finish, upload_id)
    return Response(headers=tus.describe(upload))


@router.patch(
    "/{upload_id}",
    operation_id="appendUpload",
    summary="Send bytes of an upload",
    status_code=204,
    responses={204: {"headers": words.STANDING}},
    openapi_extra=words.APPEND,
)
async def append_upload(upload_id: ItemId, request: Request, shared: Shared) -> Response:
    tus.check_version(request.headers)
    tus.check_media_type(request.headers)
    offset = tus.number(request.headers, "Upload-Offset")
    checksum = tus.checksum(request.headers)
    async with shared.turns.take(upload_id) as stop:
        append = await run_in_threadpool(shared.store.uploads.append, upload_id, offset, checksum)
        upload = await _receive(request, shared, upload_id, append, stop)
    return Response(status_code=204, headers=tus.describe(upload))


@router.delete(
    "/{upload_id}", operation_id="deleteUpload", summary="Remove an upload", status_code=204
)
async def delete_upload(upload_id: ItemId, shared: Shared) -> Response:
    async with shared.turns.take(upload_id):
        await run_in_threadpool(shared.store.uploads.delete, upload_id)
    return Response(status_code=204)


@router.post(
    "/{upload_id}",
    operation_id="overrideUploadMethod",
    summary="PATCH or DELETE, for clients whose network lets only GET and POST through",
    status_code=204,
    responses={204: {"headers": words.STANDING}},
    openapi_extra=words.OVERRIDE,
)
async def override_method(upload_id: ItemId, request: Request, shared: Shared) -> Response:
    method = request.headers.get("x-http-method-override", "").upper()
    if method == "PATCH":
        return await append_upload(upload_id, request, shared)
    if method == "DELETE":
        return await delete_upload(upload_id, shared)
    raise tus.TusHeaderError("bytes of an upload are sent with PATCH")


async def expire_uploads(uploads: Uploads) -> None:
    """Remove unfinished uploads when their time is over, until cancelled."""
    while True:
        await asyncio.sleep(min(600.0, uploads.limits.expires_s / 2))
        await run_in_threadpool(uploads.expire)


async def _receive(
    request: Request, shared: Services, upload_id: str, append: Append, stop: asyncio.Event
) -> Upload:
    """Take a request's bytes, and finish the upload where they were its last."""
    uploads = shared.store.uploads
    try:
        try:
            async for block in _blocks(request, stop):
                await run_in_threadpool(append.write, block)
            await run_in_threadpool(append.commit)
        finally:
            await run_in_threadpool(append.close)
    except ContentError:
        await run_in_threadpool(uploads.delete, upload_id)
        raise
    except ClientDisconnect as error:
        # Nobody reads this answer; the bytes that came are kept.
        raise tus.TusHeaderError("the connection broke", code="disconnected") from error
    return await run_in_threadpool(uploads.finish, upload_id)


async def _blocks(request: Request, stop: asyncio.Event) -> AsyncIterator[bytes]:
    """The body in larger pieces, to its end, or to where the connection breaks.

    Raises
    ------
    ClientDisconnect
        After all that came was given.
    ConflictError
        Likewise, if another request for the same upload asks this one to stop.
    """
    stream, stopped = request.stream(), asyncio.ensure_future(stop.wait())
    block = bytearray()
    try:
        while True:
            coming = asyncio.ensure_future(anext(stream, None))
            await asyncio.wait({coming, stopped}, return_when=asyncio.FIRST_COMPLETED)
            fault = _fault(coming)
            data = coming.result() if fault is None else None
            block += data or b""
            if data is None or len(block) >= _BLOCK_BYTES:
                yield bytes(block)
                block.clear()
            if fault is not None:
                raise fault
            if data is None:
                return
    finally:
        stopped.cancel()


def _fault(coming: asyncio.Future[bytes | None]) -> BaseException | None:
    if not coming.done():
        coming.cancel()
        return ConflictError("another request goes on with this upload", code="upload_taken_over")
    return coming.exception()


def _said(upload: Upload) -> str | None:
    """The hash that a sender announced."""
    return tus.metadata({"upload-metadata": upload.metadata}).get("sha256")


def _plain(name: str) -> str:
    """A name for people: no folders, nothing unprintable; empty where nothing is left."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    return text.plain("".join(c for c in last if c.isprintable()))[:200].strip()
