"""How long a camera's shutter rolls, from a clip in which the camera shakes.

Where the camera moves, each row of a frame is seen from another pose: that at the row's own time.
The poses of the frames before and after tell the path; what share of a second a frame's rows spread
over it is the one unknown that all frames have in common. Each frame's rows give a readout time of
their own, with a variance, whatever its own pose; the likeliest common one is found together with
a noise that the residuals of single frames do not show.

References
----------
Meingast, M., Geyer, C. and Sastry, S. (2005). Geometric models of rolling-shutter cameras.
arXiv:cs/0503076. Oth, L., Furgale, P., Kneip, L. and Siegwart, R. (2013). Rolling shutter camera
calibration. doi:10.1109/CVPR.2013.179.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from padstudio.arrays import Array, Image, YuvFrame
from padstudio.errors import StudioError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Pad
from padstudio.vision.detector import Detector
from padstudio.vision.pose.least_squares_kernel import linearize
from padstudio.vision.refine.results import RefinedPose
from padstudio.vision.stage.detection import Detection

#: More frames than these change little.
MOST_FRAMES = 300
# Borders of a frame that tell enough.
_MOST_BORDERS = 1500
# A path needs two frames on either side, evenly apart to this share.
_REACH, _EVEN = 2, 0.1
# Fewer frames, or a surer one than this share of the time between two frames, tell nothing.
_LEAST_FRAMES, _UNSURE = 12, 0.04
# Where differences over three frames and over five differ by more, the path between is not known.
_FASTEST = 0.3
# Residuals beyond so many scatters count less (Huber).
_HUBER = 2.0
# Neighbouring frames share poses, so that what is wrong with them is alike.
_BLOCK = 5
_ROUNDS = 4


@dataclass(frozen=True)
class Readout:
    """How long a shutter rolls, and how sure that is.

    Attributes
    ----------
    readout_ms, sigma_ms : float
        First row to last, and one standard deviation.
    frames : int
        Those it rests on.
    """

    readout_ms: float
    sigma_ms: float
    frames: int


@dataclass(frozen=True, eq=False)
class FrameRows:
    """Borders of a frame by rows.

    Attributes
    ----------
    time_s : float
    pose : Pose
        At the middle row.
    residuals : (N, 7) float64
        Residuals about that pose, on the plane z = 1, and their change with centre and attitude.
    row_time : (N,) float64
        −0.5 … 0.5 of the frame.
    weight : (N,) float64
    """

    time_s: float
    pose: Pose
    residuals: Array
    row_time: Array
    weight: Array


def estimate_readout(
    pad: Pad,
    camera: Camera,
    frames: Iterable[Image | YuvFrame],
    times_s: Iterable[float],
) -> Readout:
    """Estimate how long a camera's shutter rolls.

    Parameters
    ----------
    pad : Pad
    camera : Camera
        Its own readout time does not count.
    frames : iterable of (H, W, 3) uint8, BGR, or YuvFrame
        Of a clip in which the camera shakes, by some degrees a few times a second.
    times_s : iterable of float
        When each was taken.

    Raises
    ------
    StudioError
        If the clip does not show it: the pad is lost, the camera is still, or shakes too fast.
    """
    detector = Detector(pad, replace(camera, readout_ms=None))
    found = detector.track(frames, fuse=False, trace=True)
    rows: list[FrameRows] = []
    poses = 0
    for detection, time_s in zip(found, times_s, strict=False):
        poses += detection.ok
        frame = _rows_of(detection, time_s)
        rows += [] if frame is None else [frame]
    if 2 * len(rows) < poses:
        raise _refused(
            "cells of the pad are too narrow in this clip for their borders to be measured one by "
            "one; go nearer"
        )
    return fit_readout(rows)


def _rows_of(detection: Detection, time_s: float) -> FrameRows | None:
    """What a frame's borders say; None where the pose does not rest on borders."""
    posed = None if detection.trace is None else detection.trace.get("pose")
    if not detection.ok or posed is None or not isinstance(posed.output, RefinedPose):
        return None
    found = posed.output
    if found.edge_points is None:
        return None
    pose = found.fit.pose.pose
    seen = found.edge_points.thinned(_MOST_BORDERS).seen_by(found.camera)
    residuals = linearize(seen, MovingPose(pose).state)
    return FrameRows(time_s, pose, residuals, seen.row_time, seen.weight)


def fit_readout(frames: Sequence[FrameRows]) -> Readout:
    """The readout time for which the rows of all frames agree; raises as `estimate_readout`.

    Parameters
    ----------
    frames : sequence of FrameRows
        In the order of time; those that were lost are left out.
    """
    paths = [(frame, _Path.of(around)) for frame, around in _with_neighbours(frames)]
    known = [(frame, path) for frame, path in paths if path is not None]
    if len(known) < _LEAST_FRAMES:
        raise _refused(
            f"only {len(known)} frames of the clip stand among {2 * _REACH} others that show the "
            f"pad in steady steps, and {_LEAST_FRAMES} are needed; keep the pad in view"
        )
    step_s = float(np.median([path.step_s for _, path in known]))
    readout_s = coarse_s = 0.0
    sigma_s = np.inf
    for _ in range(_ROUNDS):
        fine = np.array([_alone(frame, path, path.rate, readout_s) for frame, path in known])
        coarse = np.array(
            [_alone(frame, path, path.coarse_rate, readout_s) for frame, path in known]
        )
        readout_s, sigma_s = _common(fine)
        coarse_s, _ = _common(coarse)
    if not sigma_s < _UNSURE * step_s:
        raise _refused(
            "the camera hardly moves in this clip, so that its rows do not tell when they were "
            f"read (one standard deviation is {1e3 * sigma_s:.1f} ms); shake it by some degrees, "
            "two or three times a second"
        )
    between = abs(coarse_s - readout_s) / max(readout_s, sigma_s)
    if between > _FASTEST and abs(coarse_s - readout_s) > 3 * sigma_s:
        raise _refused(
            "the camera shakes faster than the clip's frames follow it; shake it more slowly, or "
            "film more frames a second"
        )
    # Of a wave, differences over five frames err by 1.2 times the square of what three do.
    sigma_s = float(np.hypot(sigma_s, 2 * between**2 * readout_s))
    if readout_s < -4 * sigma_s or readout_s > step_s + 4 * sigma_s:
        raise _refused(
            f"the rows speak of {1e3 * readout_s:.1f} ms, which no shutter takes at a frame every "
            f"{1e3 * step_s:.1f} ms; film without stabilisation, and give the camera's own file"
        )
    return Readout(1e3 * max(readout_s, 0.0), 1e3 * sigma_s, len(known))


def _refused(why: str) -> StudioError:
    return StudioError(why, code="readout_unknown")


def _with_neighbours(
    frames: Sequence[FrameRows],
) -> Iterator[tuple[FrameRows, Sequence[FrameRows]]]:
    for place in range(_REACH, len(frames) - _REACH):
        yield frames[place], frames[place - _REACH : place + _REACH + 1]


@dataclass(frozen=True, eq=False)
class _Path:
    """The camera's path about a frame: steps of the pose (6,) a second, and a second squared."""

    step_s: float
    rate: Array
    coarse_rate: Array
    change: Array

    @classmethod
    def of(cls, around: Sequence[FrameRows]) -> _Path | None:
        """By central differences over five frames; None where their times are uneven."""
        gaps = np.diff([frame.time_s for frame in around])
        step_s = float(gaps.mean())
        if not step_s > 0 or np.abs(gaps - step_s).max() > _EVEN * step_s:
            return None
        middle = around[_REACH].pose
        before2, before, _, after, after2 = (middle.step_to(frame.pose) for frame in around)
        rate = (8 * (after - before) - (after2 - before2)) / (12 * step_s)
        change = (16 * (after + before) - (after2 + before2)) / (12 * step_s**2)
        return cls(step_s, rate, (after - before) / (2 * step_s), change)


def _alone(frame: FrameRows, path: _Path, rate: Array, readout_s: float) -> tuple[float, ...]:
    """A frame's own readout time, s, its information without noise, and its noise's variance.

    Borders are where the path puts their rows, but for a pose of the frame's own.
    """
    change, time = frame.residuals[:, 1:], frame.row_time
    slope = change @ rate * time + change @ path.change * (readout_s * time**2)
    bend = change @ path.change * (0.5 * readout_s**2 * time**2)
    left = frame.residuals[:, 0] - slope * readout_s + bend
    weight = frame.weight.copy()
    design = np.column_stack([change / np.abs(change).max(axis=0), slope])
    solved = np.zeros(design.shape[1])
    for _ in range(3):
        root = np.sqrt(weight)
        solved = np.linalg.lstsq(design * root[:, None], left * root, rcond=None)[0]
        off = np.abs(left - design @ solved)
        scatter = 1.4826 * float(np.median(off)) + 1e-12
        weight = frame.weight * np.minimum(1.0, _HUBER * scatter / np.maximum(off, 1e-12))
    root = np.sqrt(weight)
    pose, slope = design[:, :-1] * root[:, None], slope * root
    slope = slope - pose @ np.linalg.lstsq(pose, slope, rcond=None)[0]
    return readout_s + float(solved[-1]), float(slope @ slope), scatter**2


def _common(alone: Array) -> tuple[float, float]:
    """The likeliest common value of frames' own (F, 3), and one standard deviation.

    Frames have a noise besides that of their residuals, alike for all: the likeliest one.
    """
    own, information, noise = alone.T
    best = (-np.inf, 0.0, np.inf)
    median = np.median(noise)
    for extra in median * np.concatenate([[0.0], np.geomspace(1, 1e6, 25)]):
        variance = (noise + extra) / np.maximum(information, 1e-30)
        weight = 1 / variance
        common = float(weight @ own / weight.sum())
        # Few frames that are far off must not decide.
        for _ in range(5):
            off = np.abs(own - common) / np.sqrt(variance)
            weight = np.minimum(1.0, _HUBER / np.maximum(off, 1e-12)) / variance
            common = float(weight @ own / weight.sum())
        off = (own - common) / np.sqrt(variance)
        loss = np.where(np.abs(off) < _HUBER, off**2 / 2, _HUBER * np.abs(off) - _HUBER**2 / 2)
        likelihood = float(-np.log(variance).sum() / 2 - loss.sum())
        if likelihood > best[0]:
            score = weight * (own - common)
            blocks = np.add.reduceat(score, np.arange(0, len(own), _BLOCK))
            sigma = np.sqrt(max(float(blocks @ blocks), weight.sum())) / weight.sum()
            best = (likelihood, common, float(sigma))
    return best[1], best[2]
