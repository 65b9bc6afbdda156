"""What Schemathesis has to know of this interface, beside `tests/web/schemathesis.toml`."""

from __future__ import annotations

import os
import zlib
from collections import Counter
from typing import Any

import schemathesis

#: Of an operation's cases of the coverage phase one in so many is sent; 1 sends all 6,000.
SHARE = int(os.environ.get("SCHEMATHESIS_SHARE", "10"))
_cases: Counter[str] = Counter()


def _phase(case: Any) -> str | None:
    return None if case.meta is None else str(case.meta.phase.name.value)


@schemathesis.hook
def filter_case(_: Any, case: Any) -> bool:
    """A sample of the coverage phase, the same every time: each nth case of each operation.

    Where it begins goes by the operation's name, so that together they have every kind of case.
    """
    if _phase(case) != "coverage":
        return True
    label = case.operation.label
    _cases[label] += 1
    return (_cases[label] + zlib.crc32(label.encode())) % SHARE == 0


@schemathesis.hook
def filter_failure(_: Any, failure: Any, case: Any, response: Any) -> bool:
    """Valid data may be refused for what JSON Schema has no word for.

    That is what holds of all texts, and, in scenarios, what earlier steps have left: a flight
    without frames, no more room for a job. Other phases ask whether valid data are taken.
    """
    if type(failure).__name__ == "RejectedPositiveData" and _phase(case) == "stateful":
        return False
    return not (response is not None and response.status_code == 422 and _is_no_text(response))


def _is_no_text(response: Any) -> bool:
    """Whether a refusal is for control characters, or halves of surrogate pairs, alone."""
    error = response.json()["error"]
    faults = error["detail"].get("fields", ())
    return error["code"] == "invalid_text" or (
        bool(faults) and all(" is no text; " in fault["message"] for fault in faults)
    )


@schemathesis.serializer("application/offset+octet-stream")
def bytes_of_uploads(_: Any, value: Any) -> bytes:
    """The body of tus, which are bytes."""
    return value if isinstance(value, bytes) else str(value).encode("utf-8", "replace")


@schemathesis.check
def one_error_shape(_: Any, response: Any, case: Any) -> None:
    """Every refusal is an `ErrorBody`, and short."""
    if response.status_code < 400 or case.method.upper() == "HEAD":
        return
    error = response.json()["error"]
    assert set(error) == {"code", "message", "detail"}, error
    assert len(error["message"]) <= 1001, error


@schemathesis.check
def schema_keeps_its_word(_: Any, response: Any, case: Any) -> None:
    """What the document allows of a field is not refused for its kind or range.

    Rules between fields are told of the whole body, or of a pose, whose quaternion has length 1,
    and are no part of a JSON Schema. Nor is what holds of all texts: no control characters, no
    halves of surrogate pairs.
    """
    phase = getattr(case.meta, "generation", None)
    if response.status_code != 422 or phase is None or not phase.mode.is_positive:
        return
    error = response.json()["error"]
    if error["code"] == "invalid_request":
        for fault in error["detail"]["fields"]:
            is_of_all = (
                fault["place"] in ("the request's body", "pose")
                or " is no text; " in fault["message"]
            )
            assert is_of_all, error["message"]
