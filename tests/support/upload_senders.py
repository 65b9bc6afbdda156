"""Sends uploads to a store, as the server does, for tests."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from padstudio.store.uploads.files import Checksum
from padstudio.store.uploads.limits import UploadLimits
from padstudio.store.uploads.uploads import Uploads

MP4 = b"\0\0\0\x20ftypisom" + bytes(range(256)) * 40
LIMITS = UploadLimits(
    file_bytes=100_000, total_bytes=200_000, unfinished=3, still_pixels=10_000, telemetry_bytes=500
)


def add(uploads: Uploads, upload_id: str, offset: int, data: bytes) -> None:
    append = uploads.append(upload_id, offset)
    append.write(data)
    append.commit()
    append.close()


def write_and_die(
    uploads: Uploads, upload_id: str, offset: int, data: bytes, checksum: Checksum | None = None
) -> None:
    """What a killed process does: neither committed nor closed, but by the system."""
    append = uploads.append(upload_id, offset, checksum)
    append.write(data)
    append._file.close()


def send(uploads: Uploads, data: bytes, name: str = "a") -> str:
    upload_id = uploads.create(name, len(data)).id
    add(uploads, upload_id, 0, data)
    uploads.finish(upload_id)
    return upload_id


def files(tmp_path: Path) -> list[str]:
    root = tmp_path / "data" / "uploads"
    return sorted(path.relative_to(root).parts[0] for path in root.rglob("*") if path.is_file())


def picture(width: int, height: int) -> bytes:
    return cv2.imencode(".png", np.zeros((height, width, 3), np.uint8))[1].tobytes()
