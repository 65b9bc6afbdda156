"""TUM trajectories, which `evo` and others read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from padstudio.flights.exports.options import ExportOptions, Record, timed

_HEADER = """\
# timestamp tx ty tz qx qy qz qw
# position of the camera in the pad frame, metres: X right and Y up the page, Z toward the camera
# quaternion: takes camera vectors (x right, y down, z forward) to pad vectors, scalar last
# timestamp: seconds{since}; frames without a pose are left out
"""


def write_tum(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """``timestamp tx ty tz qx qy qz qw``, a line a pose.

    References
    ----------
    https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
    """
    since = " of Unix time" if options.start_unix_s else ""
    yield _HEADER.format(since=since).encode()
    for record, time_s in timed(records):
        if record["status"] == "ok":
            position = (f"{value / 1000:.9f}" for value in record["position_mm"])
            quaternion = (f"{value:.12f}" for value in record["quaternion_xyzw"])
            stamp = f"{options.start_unix_s + time_s:.6f}"
            yield " ".join([stamp, *position, *quaternion]).encode() + b"\n"
