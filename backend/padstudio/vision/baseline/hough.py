"""Stage `lines`, paper, first half: Hough segments, near-collinear ones merged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.vision.baseline import hough_kernel, lines_kernel
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
    good to a fraction of a pixel. Pixels vote only for lines across their gradient.

    References
    ----------
    O'Gorman, F. and Clowes, M. B. (1976). Finding picture edges through collinearity of feature
    points. doi:10.1109/TC.1976.1674627

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
    group = lines_kernel.merge(segments, _best_first(_lengths(segments)), _NEAR)
    ends, support = lines_kernel.join(segments, group)
    most = _best_first(support)[:_MOST_LINES]
    # Short pieces point a little astray; once lines are long, what is left over finds its line.
    sharp = lines_kernel.sharpen(ends[most], points, _NEAR)
    again = np.full(len(ends), -1)
    again[most] = lines_kernel.merge(sharp, _best_first(support[most]), _NEAR)
    group = again[group]
    kept = group >= 0
    ends, support = lines_kernel.join(segments[kept], group[kept])
    order = _best_first(support)
    ends, support = ends[order], support[order]
    return Lines(lines_kernel.sharpen(ends, points, _NEAR), support, segments, edges)


def _best_first(support: Array) -> NDArray[np.intp]:
    return np.argsort(-support, kind="stable")


def homogeneous(ends: Array) -> Array:
    """Lines (N, 3) through pairs of points (N, 2, 2), with unit normals."""
    return lines_kernel.lines_through(ends)


def _hough(edges: EdgeMap, params: PaperParams) -> Array:
    # The order is random, and the same each time.
    order = np.random.default_rng(0).permutation(len(edges.xy))
    side = max(edges.mask.shape)
    segments = hough_kernel.find_segments(
        edges.mask.shape,
        np.take(edges.xy, order, axis=0),
        np.take(edges.normals, order),
        params.hough_votes,
        max(params.hough_length * side, _LEAST_LENGTH_PX),
        int(max(params.hough_gap * side, _LEAST_GAP_PX)),
    )
    return segments[_best_first(_lengths(segments))[:_MOST_SEGMENTS]]


def _lengths(ends: Array) -> Array:
    along = ends[:, 1] - ends[:, 0]
    return np.hypot(along[:, 0], along[:, 1])
