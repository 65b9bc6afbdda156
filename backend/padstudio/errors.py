"""Every error that Pad Studio raises on purpose.

An error has a stable ``code`` (for programs), a message that says what is wrong and what to do
(for people), an HTTP ``status`` and a process ``exit_code``. Finding nothing in a picture is not
an error: see `padstudio.vision.stage.trace.StageFailure`.
"""

from __future__ import annotations

import errno
from typing import Any, ClassVar

#: Characters of what was given that a message repeats at the most.
MOST_REPEATED = 80


def shown(value: object) -> str:
    """What was given, as a message repeats it: its beginning, in quotes where it is a text."""
    if isinstance(value, str):
        return f"{value[:MOST_REPEATED]!r}{'…' * (len(value) > MOST_REPEATED)}"
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        # Python writes no whole number of more than 4300 digits.
        return f"too large a {type(value).__name__}"
    return text if len(text) <= MOST_REPEATED else text[:MOST_REPEATED] + "…"


class StudioError(Exception):
    """Root of all errors that are the caller's or the environment's, not a defect.

    Parameters
    ----------
    message : str
        A sentence that names the fault and the way out.
    code : str, optional
        A more precise stable code than the class's own.
    detail : dict, optional
        Figures and places, for programs; must be JSON-serialisable.
    """

    code: ClassVar[str] = "studio_error"
    status: ClassVar[int] = 400
    exit_code: ClassVar[int] = 2

    def __init__(
        self, message: str, *, code: str | None = None, detail: dict[str, Any] | None = None
    ) -> None:
        super().__init__(message)
        self.message = message
        self.error_code = code or self.code
        self.detail = detail or {}


class TaskStoppedError(Exception):
    """The task was told to stop; what it had done is dropped."""


class SpecError(StudioError):
    """A pad is asked for that cannot be, or is beyond a limit."""

    code = "invalid_spec"
    status = 422


class PadFormatError(StudioError):
    """A pad file is ill-formed; the message names the place."""

    code = "invalid_pad_file"
    status = 422


class CameraFormatError(StudioError):
    """A camera file is ill-formed or of an unknown kind."""

    code = "invalid_camera_file"
    status = 422


class CalibrationError(StudioError):
    """Pictures do not tell a camera; the message says what others would."""

    code = "no_calibration"
    status = 422


class CameraMismatchError(StudioError):
    """A frame's size does not fit the camera's calibration."""

    code = "camera_size_mismatch"
    status = 422


class ImageError(StudioError):
    """An upload is no readable image."""

    code = "invalid_image"
    status = 422


class LimitError(StudioError):
    """A request is beyond a limit on sizes or counts."""

    code = "limit_exceeded"
    status = 413


class EmptyExportError(StudioError):
    """An export would hold nothing of what its form is for."""

    code = "empty_export"
    status = 422


class NotFoundError(StudioError):
    """Something was asked for by name that does not exist."""

    code = "not_found"
    status = 404


class ConflictError(StudioError):
    """The request contradicts what is stored."""

    code = "conflict"
    status = 409


class SearchExhaustedError(StudioError):
    """A generator ran out of time or ways before it reached the size asked for."""

    code = "search_exhausted"
    status = 422
    exit_code = 3


class SearchCancelledError(StudioError):
    """A generator was told to stop."""

    code = "search_cancelled"
    status = 409
    exit_code = 3


class AccessError(StudioError):
    """The request comes from where, or without what, it must not."""

    code = "access_denied"
    status = 403


class BusyError(StudioError):
    """All workers are at work and enough requests wait already."""

    code = "busy"
    status = 503


class TimeLimitError(StudioError):
    """Work on a request took longer than its limit and was ended."""

    code = "time_limit"
    status = 422


class WorkerCrashError(StudioError):
    """The process that worked on a request died: out of memory, or a fault in a decoder."""

    code = "worker_crashed"
    status = 422


class StorageError(StudioError):
    """The data folder cannot be used or written."""

    code = "storage"
    status = 507


def full_disk(error: BaseException) -> StorageError | None:
    """A full disk by its name; None where an error is another one."""
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
        return StorageError(
            "the disk that holds the data folder is full; make room and try again",
            code="disk_full",
        )
    return None
