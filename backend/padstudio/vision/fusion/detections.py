"""Detections of a video, with poses that are fused over time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import chain, repeat

from padstudio.vision.fusion.by_pad import by_pad
from padstudio.vision.fusion.measurement import Fused, Measurement
from padstudio.vision.fusion.pose_filter import PoseFilter
from padstudio.vision.fusion.smoother import fuse
from padstudio.vision.stage.detection import Detection, Estimate, SinglePose, Uncertainty

#: From frame to frame, where nothing says when they were taken.
UNKNOWN_STEP_S = 1 / 30


def fused_detections(
    detections: Iterable[Detection],
    times_s: Iterable[float | None] | None = None,
    *,
    smooth: bool = False,
) -> Iterator[Detection]:
    """Detections in the order of time with fused poses, each pad's by themselves.

    Parameters
    ----------
    detections : iterable of Detection
    times_s : iterable of float or None, optional
        As of `padstudio.vision.detector.Detector.track`.
    smooth : bool
    """
    given = chain(() if times_s is None else times_s, repeat(None))
    timed = zip(detections, filled_times(given), strict=False)
    estimate: Estimate = "smoothed" if smooth else "filtered"
    runs = by_pad(timed, lambda item: item[0].pad_id)
    fused_runs = (
        fuse(run, lambda item: measured(*item), PoseFilter(), smooth=smooth) for run in runs
    )
    for (detection, _), fused in chain.from_iterable(fused_runs):
        yield with_fused(detection, fused, estimate)


def with_fused(detection: Detection, fused: Fused | None, estimate: Estimate) -> Detection:
    """A detection with its fused pose, where it has one; its own stays beside it."""
    single, sigma = detection.pose, detection.uncertainty
    if fused is None or single is None or sigma is None:
        return detection
    return replace(
        detection,
        pose=fused.pose,
        uncertainty=Uncertainty.of(fused.pose, fused.covariance),
        estimate=estimate,
        single=SinglePose(single, sigma, fused.is_outlier),
    )


def filled_times(times_s: Iterable[float | None]) -> Iterator[float]:
    """Times in which those that are not known follow the one before at `UNKNOWN_STEP_S`."""
    last = -UNKNOWN_STEP_S
    for time_s in times_s:
        last = last + UNKNOWN_STEP_S if time_s is None else time_s
        yield last


def measured(detection: Detection, time_s: float) -> Measurement | None:
    """What a filter takes of a frame's own pose; None where there is none."""
    if detection.pose is None or detection.uncertainty is None:
        return None
    return Measurement(time_s, detection.pose, detection.uncertainty.covariance)
