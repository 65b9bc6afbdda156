"""Verdicts of frames, and what they add up to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from padstudio.geometry.pose import Pose, rotation_angle_deg

Verdict = Literal["read", "false", "missed"]
#: A pose counts as read within these of the truth: of the distance to the ground, and degrees.
READ_PERCENT, READ_DEG = 3.0, 3.0


@dataclass(frozen=True)
class Outcome:
    """What became of a frame.

    Attributes
    ----------
    height_mm, tilt_deg : float
        Of the camera.
    verdict : {"read", "false", "missed"}
    error_percent : float or None
        Of the position, percent of the distance; None where there is no pose.
    attitude_deg : float or None
    cpu_ms, wall_ms : float or None
        None where the reader was lost.
    """

    height_mm: float
    tilt_deg: float
    verdict: Verdict
    error_percent: float | None = None
    attitude_deg: float | None = None
    cpu_ms: float | None = None
    wall_ms: float | None = None


def judge(
    found: Pose | None, truths: Sequence[Pose], distance_mm: float
) -> tuple[Verdict, float | None, float | None]:
    """The verdict, with the errors in percent of the distance and in degrees.

    Parameters
    ----------
    found : Pose or None
    truths : sequence of Pose
        All that are as true as the first; the nearest counts. None: there is no board to be read.
    distance_mm : float
        From the camera to the ground along the optical axis.
    """
    if found is None:
        return "missed", None, None
    if not truths:
        return "false", None, None

    def error_mm(truth: Pose) -> float:
        return float(np.linalg.norm(found.position_mm - truth.position_mm))

    nearest = min(truths, key=error_mm)
    percent = 100 * error_mm(nearest) / distance_mm
    angle_deg = rotation_angle_deg(found.rotation, nearest.rotation)
    good = percent <= READ_PERCENT and angle_deg <= READ_DEG
    return "read" if good else "false", percent, angle_deg


@dataclass(frozen=True)
class Summary:
    """What the outcomes of one reader add up to.

    Attributes
    ----------
    read, false, missed : int
        Frames.
    median_percent, p95_percent, median_deg : float or None
        Errors of the frames that were read.
    lowest, highest : float or None
        Where frames were read: heights in mm, or of a flight of tilts degrees.
    ratio : float or None
        Highest over lowest height.
    """

    read: int
    false: int
    missed: int
    median_percent: float | None
    p95_percent: float | None
    median_deg: float | None
    lowest: float | None
    highest: float | None
    ratio: float | None


def summarise(outcomes: Sequence[Outcome], *, by_tilt: bool) -> Summary:
    """Add up the outcomes of one reader."""
    counts = [outcome.verdict for outcome in outcomes]
    good = [outcome for outcome in outcomes if outcome.verdict == "read"]
    errors = [outcome.error_percent for outcome in good]
    places = [outcome.tilt_deg if by_tilt else outcome.height_mm for outcome in good]
    lowest, highest = (min(places), max(places)) if places else (None, None)
    return Summary(
        counts.count("read"),
        counts.count("false"),
        counts.count("missed"),
        percentile(errors, 50),
        percentile(errors, 95),
        percentile([outcome.attitude_deg for outcome in good], 50),
        lowest,
        highest,
        highest / lowest if highest and lowest and not by_tilt else None,
    )


def percentile(values: Iterable[float | None], share: float) -> float | None:
    """A percentile of those values that are there."""
    known = [value for value in values if value is not None]
    return float(np.percentile(known, share)) if known else None
