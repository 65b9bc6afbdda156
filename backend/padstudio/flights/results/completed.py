"""Range, bearing and quality of poses that an older program wrote down without them."""

from __future__ import annotations

from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.pose import Pose
from padstudio.geometry.range_bearing import Quality, quality_of
from padstudio.vision.stage.detection import Uncertainty

Record = dict[str, Any]

_FIELDS = ("range_mm", "bearing", "range_sigma_mm", "bearing_sigma_deg", "quality")


def completed(record: Record) -> Record:
    """A record with all that is known of its range and bearing.

    What it lacks follows from its pose and its ``covariance`` (upper triangle by rows), the quality
    also from its standard deviations; what does not follow is None. A quality is never assumed.

    Parameters
    ----------
    record : dict
        A line of a poses file; one with a pose holds ``position_mm`` and ``rotation``.
    """
    if record["status"] != "ok" or all(name in record for name in _FIELDS):
        return record
    pose = Pose(np.array(record["position_mm"], float), np.array(record["rotation"], float))
    covariance = covariance_of(record)
    follows: Record = {"range_mm": pose.range_mm, "bearing": pose.bearing.tolist()}
    follows |= {"range_sigma_mm": None, "bearing_sigma_deg": None}
    if covariance is not None:
        sigma = Uncertainty.of(pose, covariance)
        follows["range_sigma_mm"] = sigma.range_sigma_mm
        follows["bearing_sigma_deg"] = sigma.bearing_sigma_deg
    follows["quality"] = _quality(record, pose.range_mm, covariance)
    return follows | record


def covariance_of(record: Record) -> Array | None:
    """A record's covariance (6, 6), mm and radians; None where it holds none."""
    upper = record.get("covariance")
    if not upper:
        return None
    matrix = np.zeros((6, 6))
    matrix[np.triu_indices(6)] = upper
    return np.asarray(matrix + np.triu(matrix, 1).T)


def _quality(record: Record, range_mm: float, covariance: Array | None) -> Quality | None:
    shift, turn = record.get("position_sigma_mm"), record.get("attitude_sigma_deg")
    if shift and turn:
        return quality_of(range_mm, shift, turn)
    if covariance is None:
        return None
    sigma = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return quality_of(range_mm, sigma[:3], np.degrees(sigma[3:]))
