"""A calibration as JSON: for REST, and for a report beside a camera file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.calibration.advice import PictureVerdict, coverage, findings, verdicts
from padstudio.calibration.results import Calibration, CalibrationView

_MATRIX = ((0, 0), (1, 1), (0, 2), (1, 2))


def record(calibration: Calibration, names: Sequence[str]) -> dict[str, Any]:
    """All that a calibration says; lengths are pixels and degrees.

    Parameters
    ----------
    calibration : Calibration
    names : sequence of str
        Of the pictures.
    """
    camera, sigma = calibration.camera, calibration.sigma
    values = [float(camera.matrix[place]) for place in _MATRIX]
    views = zip(names, calibration.views, verdicts(calibration), strict=True)
    return {
        "width": camera.width,
        "height": camera.height,
        "model": camera.model,
        "intrinsics": _told(("fx", "fy", "cx", "cy"), values, sigma.matrix),
        "distortion": _told(_coefficients(camera.model), camera.distortion, sigma.distortion),
        "rms_px": calibration.rms_px,
        "sigma_px": [[_number(x) for x in row] for row in sigma.picture_px],
        "coverage": coverage(calibration).tolist(),
        "pictures": [_picture(*view) for view in views],
        "findings": [
            {"code": each.code, "message": each.message} for each in findings(calibration)
        ],
    }


def _told(names: Sequence[str], values: Sequence[float] | Array, sigma: Array) -> list[Any]:
    return [
        {"name": name, "value": float(value), "sigma": float(about)}
        for name, value, about in zip(names, values, sigma, strict=True)
    ]


def _coefficients(model: str) -> tuple[str, ...]:
    return ("k1", "k2", "k3", "k4") if model == "fisheye" else ("k1", "k2", "p1", "p2", "k3")


def _picture(name: str, view: CalibrationView, verdict: PictureVerdict) -> dict[str, Any]:
    pose = view.pose
    return {
        "name": name,
        "used": view.is_used,
        "state": verdict.state,
        "message": verdict.message,
        "patches": len(view.residuals_px),
        "rms_px": view.rms_px,
        "range_mm": None if pose is None else pose.range_mm,
        "tilt_deg": None if pose is None else pose.tilt_deg,
    }


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
