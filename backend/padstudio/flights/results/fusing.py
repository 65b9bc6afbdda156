"""Fuses the poses of a poses file's records over time; a pure function for files and database.

Chunks of a video are analysed apart and hold frames' own poses. They are fused afterwards, in the
order of time, so that nobody sees where chunks begin, or who worked on them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import Any, Literal

import numpy as np

from padstudio.arrays import Array
from padstudio.flights.results.completed import completed
from padstudio.geometry.pose import Pose, rotation_from_quaternion
from padstudio.vision.fusion.by_pad import by_pad
from padstudio.vision.fusion.measurement import Fused, Measurement
from padstudio.vision.fusion.pose_filter import PoseFilter
from padstudio.vision.fusion.smoother import fuse
from padstudio.vision.stage.detection import Uncertainty, pose_fields, uncertainty_fields

Record = dict[str, Any]
#: Not at all; with the frames before each; with those after it, too.
Fusion = Literal["none", "filter", "smooth"]

_UPPER = np.triu_indices(6)
# Of a frame's own pose; the covariance beside them is for who fuses again.
_SINGLE = (
    "position_mm",
    "quaternion_xyzw",
    "position_sigma_mm",
    "attitude_sigma_deg",
    "quality",
    "covariance",
)


def fused_records(records: Iterable[Record], fusion: Fusion) -> Iterator[Record]:
    """Records with fused poses, in their order.

    Stills have no times and stay as they are, as do poses without ``covariance``. Each source is
    fused by itself, and in it each pad. What was fused before is fused anew from the frames' own
    poses.

    Parameters
    ----------
    records : iterable of dict
        As `padstudio.flights.tasks.frames.FramesTask.run` gives, in the order of time.
    fusion : {"none", "filter", "smooth"}
    """
    if fusion == "none":
        yield from map(single_record, records)
        return
    for _, some in groupby(records, key=lambda record: record["source"]):
        for run in by_pad(map(single_record, some), lambda record: record.get("pad_id")):
            for record, fused in fuse(run, _measure, PoseFilter(), smooth=fusion == "smooth"):
                yield record if fused is None else _with_pose(record, fused, fusion)


def single_record(record: Record) -> Record:
    """A record with the frame's own pose."""
    single = record.get("single")
    if single is None:
        return record
    pose = Pose(
        np.array(single["position_mm"], float), rotation_from_quaternion(single["quaternion_xyzw"])
    )
    own = {name: single[name] for name in _SINGLE if name in single}
    fused = ("single", "range_sigma_mm", "bearing_sigma_deg")
    rest = {key: value for key, value in record.items() if key not in fused}
    return completed(rest | pose_fields(pose) | own | {"estimate": "frame"})


def _measure(record: Record) -> Measurement | None:
    covariance, time_s = record.get("covariance"), record.get("time_s")
    if record["status"] != "ok" or covariance is None or time_s is None:
        return None
    pose = Pose(
        np.array(record["position_mm"], float), rotation_from_quaternion(record["quaternion_xyzw"])
    )
    return Measurement(float(time_s), pose, _full_matrix(covariance))


def _with_pose(record: Record, fused: Fused, fusion: Fusion) -> Record:
    sigma = Uncertainty.of(fused.pose, fused.covariance)
    single = {name: record.get(name) for name in _SINGLE}
    return record | {
        **pose_fields(fused.pose),
        **uncertainty_fields(sigma),
        "quality": sigma.quality_at(fused.pose.range_mm),
        "covariance": fused.covariance[_UPPER].tolist(),
        "estimate": "smoothed" if fusion == "smooth" else "filtered",
        "single": single | {"is_outlier": fused.is_outlier},
    }


def _full_matrix(upper: Sequence[float]) -> Array:
    matrix = np.zeros((6, 6))
    matrix[_UPPER] = upper
    return np.asarray(matrix + np.triu(matrix, 1).T)
