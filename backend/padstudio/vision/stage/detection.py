"""What the caller gets: a pose with its evidence and uncertainty, or why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.curvature import without_curvature
from padstudio.geometry.pose import Pose, rotation_from_quaternion
from padstudio.geometry.range_bearing import (
    Quality,
    bearing_sigma_deg,
    quality_of,
    range_sigma_mm,
)
from padstudio.pad.spec import Channel
from padstudio.vision.stage.trace import Finding, StageFailure, Trace

Method = Literal["dense", "paper"]
#: What a pose rests on: one frame; it and those before it; those after it, too.
Estimate = Literal["frame", "filtered", "smoothed"]


@dataclass(frozen=True)
class Uncertainty:
    """One standard deviation of a pose, from the residuals' covariance.

    Attributes
    ----------
    pose : Pose
    position_sigma_mm : (3,) float64
        Along the pad's X, Y, Z.
    attitude_sigma_deg : (3,) float64
        About the camera's x, y, z.
    covariance : (6, 6) float64
        Position (mm, pad frame) then attitude (radians, about the camera's axes), with curvature
        (`padstudio.geometry.curvature`).
    """

    pose: Pose
    position_sigma_mm: Array
    attitude_sigma_deg: Array
    covariance: Array

    @classmethod
    def of(cls, pose: Pose, covariance: Array) -> Uncertainty:
        """Standard deviations of a pose from its covariance."""
        sigma = np.sqrt(np.maximum(covariance.diagonal(), 0.0))
        return cls(pose, sigma[:3], np.degrees(sigma[3:]), covariance)

    @cached_property
    def _linear(self) -> Array:
        """The covariance's part of the first order, from which range and bearing follow.

        That poses which fit lie on an arc about the pad makes a position less sure along the arc's
        radius, but not the range.
        """
        return without_curvature(self.covariance, self.pose)

    @cached_property
    def range_sigma_mm(self) -> float:
        """Of the distance from the camera to the pad's centre."""
        return range_sigma_mm(self.pose, self._linear)

    @cached_property
    def bearing_sigma_deg(self) -> float:
        """Of the direction to the pad's centre in the camera frame, where it is least sure."""
        return bearing_sigma_deg(self.pose, self._linear)

    def quality_at(self, range_mm: float) -> Quality:
        """As of `padstudio.geometry.range_bearing.quality_of`, of a pose at that range."""
        return quality_of(range_mm, self.position_sigma_mm, self.attitude_sigma_deg)


@dataclass(frozen=True)
class SinglePose:
    """What a frame alone says, beside a pose that others were fused into.

    Attributes
    ----------
    pose : Pose
    uncertainty : Uncertainty
    is_outlier : bool
        It contradicts the frames about it and was not believed.
    """

    pose: Pose
    uncertainty: Uncertainty
    is_outlier: bool = False


@dataclass(frozen=True)
class Detection:
    """What the detector says of one frame.

    Attributes
    ----------
    pose : Pose or None
        None where `failure` says why.
    failure : StageFailure or None
    pad_id : str or None
        Which pad it is, as of `padstudio.pad.identity.pad_id`; None without a pose.
    layer : {"red", "green", "blue", "outline"} or None
        What the pose rests on.
    cells_read, cells_wrong : int
        Cells compared with the pad, and those that differ from it.
    log10_false_alarm : float
        The base-10 logarithm of the bound on the chance that a picture without this pad gives
        as good a match.
    reprojection_px : float
        Root mean square of the residuals, pixels of the frame.
    uncertainty : Uncertainty or None
    estimate : {"frame", "filtered", "smoothed"}
        What `pose` and `uncertainty` rest on.
    single : SinglePose or None
        What the frame alone says, where they rest on more.
    ambiguity : float
        How well the mirrored planar pose explains the picture too, 0 (not at all) … 1 (alike).
    shift_mm, turn_rad : (3,) float64 or None
        Change of the camera's centre (pad frame) and attitude (rotation vector, camera frame)
        while a rolling shutter read the frame, from its first row to its last.
    shaking : float
        Natural logarithm of the odds that the camera shook meanwhile; 0 where nothing says so.
    flatness_mm : float or None
        Peak to valley of a bent sheet's heights in view, over the plane that fits it best, to which
        the pose is relative; None where no bend shows.
    failed_at : mapping
        Without a pose, the stage at which each channel failed that was looked at.
    warnings : tuple of Finding
        What a second look finds to doubt of a pose, where it was asked for.
    frame_px : (width, height) or None
        Size of the frame.
    elapsed_ms : mapping
        Milliseconds per stage (summed over channels) and ``total``.
    trace : Trace or None
    """

    pose: Pose | None
    failure: StageFailure | None = None
    pad_id: str | None = None
    layer: Literal["red", "green", "blue", "outline"] | None = None
    cells_read: int = 0
    cells_wrong: int = 0
    log10_false_alarm: float = 0.0
    reprojection_px: float = 0.0
    uncertainty: Uncertainty | None = None
    estimate: Estimate = "frame"
    single: SinglePose | None = None
    ambiguity: float = 0.0
    shift_mm: Array | None = None
    turn_rad: Array | None = None
    shaking: float = 0.0
    flatness_mm: float | None = None
    failed_at: Mapping[Channel, str] = field(default_factory=dict)
    warnings: tuple[Finding, ...] = ()
    frame_px: tuple[int, int] | None = None
    elapsed_ms: Mapping[str, float] = field(default_factory=dict)
    trace: Trace | None = None

    @property
    def ok(self) -> bool:
        """True where there is a pose."""
        return self.pose is not None

    @property
    def range_mm(self) -> float | None:
        """Distance from the camera to the pad's centre; None without a pose."""
        return None if self.pose is None else self.pose.range_mm

    @property
    def range_sigma_mm(self) -> float | None:
        """One standard deviation of the range; None where unknown."""
        return None if self.uncertainty is None else self.uncertainty.range_sigma_mm

    @property
    def bearing(self) -> Array | None:
        """(3,) float64, unit vector to the pad's centre in the camera frame; None without a
        pose."""
        return None if self.pose is None else self.pose.bearing

    @property
    def bearing_sigma_deg(self) -> float | None:
        """One standard deviation of the bearing; None where unknown."""
        return None if self.uncertainty is None else self.uncertainty.bearing_sigma_deg

    @property
    def quality(self) -> Quality | None:
        """``full``, or ``bearing`` where range and bearing alone can be used; None where
        unknown."""
        sigma = self.uncertainty
        if self.pose is None or sigma is None:
            return None
        return sigma.quality_at(self.pose.range_mm)

    def to_record(
        self, source: str, *, frame: int = 0, time_s: float | None = None
    ) -> dict[str, Any]:
        """One line of a poses file (docs/conventions.md, "Poses file"), JSON-serialisable."""
        record: dict[str, Any] = {"source": source, "frame": frame, "time_s": time_s}
        if self.pose is None:
            failure = self.failure
            assert failure is not None
            record |= {
                "status": "failed",
                "stage": failure.stage,
                "reason": str(failure.reason),
                "detail": failure.detail,
                "advice": failure.advice,
            }
            if self.failed_at:
                record["failed_at"] = dict(self.failed_at)
            found = failure.also
        else:
            record |= {"status": "ok", **pose_fields(self.pose), **self._evidence()}
            record |= {"estimate": self.estimate}
            if self.pad_id is not None:
                record["pad_id"] = self.pad_id
            if self.single is not None:
                record["single"] = single_fields(self.single)
            found = self.warnings
        if found:
            record["findings"] = [
                {"reason": str(item.reason), "detail": item.detail, "advice": item.advice}
                for item in found
            ]
        if self.frame_px is not None:
            record["frame_px"] = list(self.frame_px)
        record["elapsed_ms"] = {name: round(ms, 3) for name, ms in self.elapsed_ms.items()}
        return record

    def _evidence(self) -> dict[str, Any]:
        sigma = self.uncertainty
        return {
            "layer": self.layer,
            "cells_read": self.cells_read,
            "cells_wrong": self.cells_wrong,
            "log10_false_alarm": round(self.log10_false_alarm, 2),
            "reprojection_px": self.reprojection_px,
            "ambiguity": self.ambiguity,
            "flatness_mm": self.flatness_mm,
            **uncertainty_fields(sigma),
            "quality": self.quality,
        }


def pose_fields(pose: Pose) -> dict[str, Any]:
    """A pose as the JSON fields of a poses file."""
    quaternion = pose.quaternion_xyzw.tolist()
    # To the last digit what the quaternion says, which is all that a database keeps of it.
    pose = Pose(pose.position_mm, rotation_from_quaternion(quaternion))
    return {
        "position_mm": pose.position_mm.tolist(),
        "rotation": pose.rotation.tolist(),
        "quaternion_xyzw": quaternion,
        "heading_deg": pose.heading_deg,
        "tilt_deg": pose.tilt_deg,
        "euler_deg": list(pose.euler_deg),
        "range_mm": pose.range_mm,
        "bearing": pose.bearing.tolist(),
    }


def uncertainty_fields(sigma: Uncertainty | None) -> dict[str, Any]:
    """Standard deviations as the JSON fields of a poses file."""
    return {
        "position_sigma_mm": None if sigma is None else sigma.position_sigma_mm.tolist(),
        "attitude_sigma_deg": None if sigma is None else sigma.attitude_sigma_deg.tolist(),
        "range_sigma_mm": None if sigma is None else sigma.range_sigma_mm,
        "bearing_sigma_deg": None if sigma is None else sigma.bearing_sigma_deg,
    }


def single_fields(single: SinglePose) -> dict[str, Any]:
    """A frame's own pose as JSON fields."""
    return {
        "position_mm": single.pose.position_mm.tolist(),
        "quaternion_xyzw": single.pose.quaternion_xyzw.tolist(),
        "position_sigma_mm": single.uncertainty.position_sigma_mm.tolist(),
        "attitude_sigma_deg": single.uncertainty.attitude_sigma_deg.tolist(),
        "quality": single.uncertainty.quality_at(single.pose.range_mm),
        "is_outlier": single.is_outlier,
    }
