"""Stage `lines`, paper, first half: Hough segments, near-collinear ones merged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.vision.baseline.edges import EdgeMap
from padstudio.vision.stage.params import PaperParams
from padstudio.vision.stage.trace import Reason, StageFailure

# Segments are at least this long, and may have gaps of this length, however small the plane.
_LEAST_LENGTH_PX, _LEAST_GAP_PX = 12.0, 4.0
# The longest segments tell the lines; a picture full of grass has thousands of short ones.
_MOST_SEGMENTS, _MOST_LINES = 1000, 160
# Segments whose ends lie this near to a line belong to it, pixels of the plane. Of 19 stills of the
# footage 17 are read; with half 13, with double 16.
_NEAR = 2.5
_LEAST_LINES = 4


@dataclass(frozen=True, eq=False)
class Lines:
    """Straight lines of a plane, each with the part of it that edges support.

    Attributes
    ----------
    ends : (M, 2, 2) float64
        First and last supported point, plane pixels without the lens's distortion; the longest
        supported line first.
    support : (M,) float64
        Length covered by segments, plane pixels.
    segments : (N, 2, 2) float64
        The Hough segments that they were merged from, likewise.
    edges : EdgeMap
    """

    ends: Array
    support: Array
    segments: Array
    edges: EdgeMap

    @property
    def homogeneous(self) -> Array:
        """(M, 3) float64: unit normal and offset, so that (x, y, 1) · line is a distance."""
        return homogeneous(self.ends)


def find_merged_lines(edges: EdgeMap, params: PaperParams) -> Lines | StageFailure:
    """Probabilistic Hough transform; near-collinear segments become one line each.

    A merged line is fitted to the undilated edge points along it: that is what makes its position
    good to a fraction of a pixel.

    References
    ----------
    Matas, J., Galambos, C. and Kittler, J. (2000). Robust detection of lines using the
    progressive probabilistic Hough transform. doi:10.1006/cviu.1999.0831
    """
    segments = _hough(edges, params)
    if len(segments) < _LEAST_LINES:
        return StageFailure(
            "lines",
            Reason.TOO_FEW_LINES,
            f"{len(segments)} straight segments in {edges.plane.channel}, {_LEAST_LINES} are "
            "needed at the least",
        )
    # A distorted line is straight over a segment's length, but not over a family's.
    segments = edges.straighten(segments.reshape(-1, 2)).reshape(-1, 2, 2)
    points = edges.straighten(edges.points)
    groups = _merge(segments, _lengths(segments))
    ends, support = _joined(segments, groups)
    most = np.argsort(-support, kind="stable")[:_MOST_LINES]
    # Short pieces point a little astray; once lines are long, what is left over finds its line.
    again = _merge(_sharpen(ends[most], points), support[most])
    groups = [np.concatenate([groups[most[k]] for k in group]) for group in again]
    ends, support = _joined(segments, groups)
    order = np.argsort(-support, kind="stable")
    ends, support = ends[order], support[order]
    return Lines(_sharpen(ends, points), support, segments, edges)


def homogeneous(ends: Array) -> Array:
    """Lines (N, 3) through pairs of points (N, 2, 2), with unit normals."""
    along = ends[:, 1] - ends[:, 0]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    return np.column_stack([normal, -(normal * ends[:, 0]).sum(axis=1)])


def _hough(edges: EdgeMap, params: PaperParams) -> Array:
    side = max(edges.mask.shape)
    found = cv2.HoughLinesP(
        edges.mask,
        1,
        math.pi / 360,
        params.hough_votes,
        minLineLength=max(params.hough_length * side, _LEAST_LENGTH_PX),
        maxLineGap=max(params.hough_gap * side, _LEAST_GAP_PX),
    )
    if found is None:
        return np.zeros((0, 2, 2))
    # OpenCV 4 gives (N, 1, 4), OpenCV 5 (N, 4).
    segments = np.asarray(found, float).reshape(-1, 2, 2)
    order = np.argsort(-_lengths(segments), kind="stable")
    return segments[order[:_MOST_SEGMENTS]]


def _lengths(ends: Array) -> Array:
    return np.asarray(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), float)


def _merge(pieces: Array, support: Array) -> list[NDArray[np.intp]]:
    """Groups of pieces that lie on one line, the best supported piece first."""
    free = np.ones(len(pieces), bool)
    groups = []
    for k in np.argsort(-support, kind="stable"):
        if not free[k]:
            continue
        members = free & _on(homogeneous(pieces[k : k + 1])[0], pieces)
        members[k] = True
        members |= free & _on(_through(pieces[members].reshape(-1, 2)), pieces)
        free &= ~members
        groups.append(np.flatnonzero(members))
    return groups


def _joined(pieces: Array, groups: Sequence[NDArray[np.intp]]) -> tuple[Array, Array]:
    """Ends (M, 2, 2) of the lines through groups of pieces, and the length that they cover."""
    ends, support = [], []
    for group in groups:
        line = _through(pieces[group].reshape(-1, 2))
        first, last, length = _cover(line, pieces[group])
        ends.append([first, last])
        support.append(length)
    return np.array(ends), np.array(support)


def _on(line: Array, pieces: Array) -> NDArray[np.bool_]:
    distance = np.abs(pieces @ line[:2] + line[2])
    return np.asarray((distance < _NEAR).all(axis=1))


def _sharpen(ends: Array, points: Array) -> Array:
    """Fit each line to the edge pixels beside it."""
    sharp = ends.copy()
    for k, line in enumerate(homogeneous(ends)):
        along = np.array([-line[1], line[0]])
        span = ends[k] @ along
        for _ in range(2):
            near = np.abs(points @ line[:2] + line[2]) < _NEAR
            chosen = points[near]
            place = chosen @ along
            chosen = chosen[(place >= span.min() - 1) & (place <= span.max() + 1)]
            if len(chosen) < 8:
                break
            line = _through(chosen)
        foot = ends[k] @ line[:2] + line[2]
        sharp[k] = ends[k] - foot[:, None] * line[:2]
    return sharp


def _through(points: Array) -> Array:
    """The line through points by total least squares."""
    middle = points.mean(axis=0)
    off = points - middle
    xx, yy, xy = (float(v) for v in ((off**2).sum(0)[0], (off**2).sum(0)[1], off.prod(1).sum()))
    angle = 0.5 * math.atan2(2 * xy, xx - yy)
    normal = np.array([-math.sin(angle), math.cos(angle)])
    return np.array([normal[0], normal[1], -float(normal @ middle)])


def _cover(line: Array, pieces: Array) -> tuple[Array, Array, float]:
    """First and last point of pieces on their line, and the length that they cover together."""
    along = np.array([-line[1], line[0]])
    spans = np.sort(pieces @ along, axis=1)
    foot = -line[2] * line[:2]
    length, reach = 0.0, -np.inf
    for low, high in spans[np.argsort(spans[:, 0])]:
        length += max(0.0, high - max(low, reach))
        reach = max(reach, high)
    return foot + spans.min() * along, foot + spans.max() * along, float(length)
