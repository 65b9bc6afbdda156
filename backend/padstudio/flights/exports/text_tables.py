"""Forms of text: CSV for spreadsheets and pandas, JSON lines, TUM trajectories for `evo`."""

from __future__ import annotations

import csv
import io
import json
import re
import unicodedata
from collections.abc import Iterable, Iterator

from padstudio.flights.exports.options import ExportOptions, Record, full_poses, time_ns_of

#: The header says the convention: the camera in the pad frame, millimetres, degrees.
COLUMNS = (
    "source",
    "frame",
    "time_s",
    "status",
    "camera_in_pad_x_mm",
    "camera_in_pad_y_mm",
    "camera_in_pad_z_mm",
    "pad_from_camera_qx",
    "pad_from_camera_qy",
    "pad_from_camera_qz",
    "pad_from_camera_qw",
    "heading_deg",
    "tilt_deg",
    "layer",
    "cells_read",
    "cells_wrong",
    "log10_false_alarm",
    "reprojection_px",
    "sigma_x_mm",
    "sigma_y_mm",
    "sigma_z_mm",
    "sigma_about_camera_x_deg",
    "sigma_about_camera_y_deg",
    "sigma_about_camera_z_deg",
    "quality",
    "range_mm",
    "range_sigma_mm",
    "bearing_x",
    "bearing_y",
    "bearing_z",
    "bearing_sigma_deg",
    "stage",
    "reason",
    "detail",
    "elapsed_ms",
    "estimate",
    "pad_id",
)
_PLAIN = (
    "heading_deg",
    "tilt_deg",
    "layer",
    "cells_read",
    "cells_wrong",
    "log10_false_alarm",
    "reprojection_px",
)
# A spreadsheet would take such a text for a formula, behind blanks and what nobody sees as well.
_FORMULA = re.compile(
    r"[\t\r\n]|[\s\x00-\x1f\x7f-\x9f\u00ad\u200b-\u200f\u2060\ufeff]*[=+\-\u2212@]"
)


def write_csv(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """CSV (RFC 4180), UTF-8; numbers read back as the same doubles, what is unknown is empty."""
    line = io.StringIO(newline="")
    writer = csv.writer(line)
    writer.writerow(COLUMNS)
    for record in records:
        writer.writerow(map(_text, _row(record, options.name_of(record))))
        yield line.getvalue().encode()
        line.seek(0)
        line.truncate()
    yield line.getvalue().encode()


def _row(record: Record, source: str) -> list[object]:
    return [
        source,
        record["frame"],
        record.get("time_s"),
        record["status"],
        *_numbers(record, "position_mm", 3),
        *_numbers(record, "quaternion_xyzw", 4),
        *(record.get(name) for name in _PLAIN),
        *_numbers(record, "position_sigma_mm", 3),
        *_numbers(record, "attitude_sigma_deg", 3),
        *(record.get(name) for name in ("quality", "range_mm", "range_sigma_mm")),
        *_numbers(record, "bearing", 3),
        record.get("bearing_sigma_deg"),
        record.get("stage"),
        record.get("reason"),
        record.get("detail"),
        (record.get("elapsed_ms") or {}).get("total"),
        record.get("estimate"),
        record.get("pad_id"),
    ]


def _numbers(record: Record, key: str, count: int) -> list[float | None]:
    return list(record.get(key) or [None] * count)


def _text(value: object) -> object:
    # Full-width and small signs are signs, too (NFKC).
    is_text = isinstance(value, str)
    is_formula = is_text and _FORMULA.match(unicodedata.normalize("NFKC", str(value)))
    return f"'{value}" if is_formula else value


def write_jsonl(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """The poses file itself: one object a line, UTF-8; numbers read back as the same doubles.

    docs/conventions.md, "Poses file", names its fields.
    """
    for record in records:
        yield json.dumps(record, ensure_ascii=False).encode() + b"\n"


_TUM_HEADER = """\
# timestamp tx ty tz qx qy qz qw
# position of the camera in the pad frame, metres: X right and Y up the page, Z toward the camera
# quaternion: takes camera vectors (x right, y down, z forward) to pad vectors, scalar last
# timestamp: seconds{since}; frames without a pose of quality full are left out
"""


_ESTIMATES = {
    "frame": "# poses: of each frame alone\n",
    "filtered": "# poses: filtered, with the frames before each\n",
    "smoothed": "# poses: smoothed, with the frames before and after each\n",
}


def write_tum(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """``timestamp tx ty tz qx qy qz qw``, a line a pose of quality ``full``.

    References
    ----------
    https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
    """
    header = _TUM_HEADER
    for record, _, time_s in full_poses(records, "a TUM trajectory"):
        if header:
            is_unix = options.start_unix_s or "stamp_ns" in record
            header = header.format(since=" of Unix time" if is_unix else "")
            yield (header + _ESTIMATES.get(record.get("estimate", "frame"), "")).encode()
            header = ""
        position = (f"{value / 1000:.9f}" for value in record["position_mm"])
        quaternion = (f"{value:.12f}" for value in record["quaternion_xyzw"])
        stamp = f"{time_ns_of(record, time_s, options) / 1e9:.6f}"
        yield " ".join([stamp, *position, *quaternion]).encode() + b"\n"
