"""Stage `pose`: from a first pose to the best one the picture allows, layer by layer.

Coarse layers first, with few borders: they bring the pose near enough to tell the finer layer's
borders apart. Then all borders of the finest one. A layer counts only where its cells, read with
the refined pose, agree with the pad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import KnownMotion, MovingPose
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.layer_read import LayerRead, read_layer
from padstudio.vision.frame.pyramid import Pyramid, Window
from padstudio.vision.pose.edge_points import (
    LEAST_BORDERS,
    EdgePoints,
    find_edge_points,
    measurable_borders,
)
from padstudio.vision.pose.edge_points_kernel import Borders
from padstudio.vision.pose.least_squares import STILL, Fit, MotionModel, better_of, fit_pose
from padstudio.vision.pose.pattern.image_alignment import Match
from padstudio.vision.refine.results import LayerFit, RefinedPose
from padstudio.vision.stage.params import DetectorParams, RefineParams

# What these constants were chosen by: halved or doubled they left 76 of 76 stills of the footage
# good and 12 of 12 negatives silent; named are those that moved the error of stills (median
# 0.0172 % of the height) or of the first 60 frames of both flights (mean 0.0830 %).
# Profiles are taken where a cell is about this wide, pixels of the window. Half: stills 0.0190;
# double: stills 0.0175, flights 0.1092.
_CELL_PX = 9.0
# So many places lie within reach of an expected pose.
_NEAR_BY = 25
# So many borders decide between a still and a moving camera; all of them then fit the pose.
# Double: stills 0.0183.
_DECIDING = 800
# Borders this near to their prediction, in cells, need not be measured again to settle.
_SETTLED = 0.1
# Expectations this near, in cells, need no coarser layer's help, and no first look.
# Double: flights 0.0849 and 0.0841.
_WITHIN, _HERE = 0.2, 0.05
# Residuals this small, in cells, need no motion to be brought nearer.
_QUIET = 0.05


@dataclass(frozen=True)
class Refiner:
    """What refinement needs to know of its frame.

    Attributes
    ----------
    pyramid : Pyramid
    camera : Camera
        At the frame's size.
    pad : Pad
    params : DetectorParams
    attempts : int
        How many lattices were tried all over the pad before the first pose; it weakens the
        evidence. 0 where the pose was expected: then only places near by compete.
    motion : KnownMotion or None
        The change within the frame, where it is known.
    """

    pyramid: Pyramid
    camera: Camera
    pad: Pad
    params: DetectorParams
    attempts: int
    motion: KnownMotion | None = None

    @property
    def _most_borders(self) -> int:
        refine = self.params.refine
        if self.attempts:
            return refine.most_borders
        return min(refine.most_borders, refine.followed_borders)

    @property
    def _rounds(self) -> int:
        """So often few borders are measured, each time nearer to where they are, at the most.

        A pose that motion led to may be off by half a cell of a coarse layer; what a lattice led to
        is nearer.
        """
        return 2 if self.attempts else 6

    @property
    def _rolling(self) -> bool:
        """True where the pose may change while the frame is read."""
        refine = self.params.refine
        return refine.motion and not refine.at_rest and self.camera.readout_ms != 0

    def model(self, *, moving: bool) -> MotionModel:
        """A still or a moving camera; a known motion where there is one."""
        rolling = self._rolling
        known = self.motion if rolling else None
        readout, at_rest = self.camera.readout_ms, self.params.refine.at_rest
        return MotionModel(moving or known is not None, known, rolling, readout, at_rest)

    def coarse_to_fine(self, start: MovingPose, good_mm: float) -> list[LayerFit]:
        """Readable layers, the coarse ones first, each with the pose that it led to.

        Parameters
        ----------
        start : MovingPose
        good_mm : float
            Layers with larger cells have nothing to add to ``start``; their borders only count
            in the end.
        """
        pose = start
        layer_fits: list[LayerFit] = []
        for layer in sorted(self.pad.layers, key=lambda item: -item.cell_mm):
            readable = self.readable(layer, pose)
            if readable is not None:
                rounds = self._rounds if layer.cell_mm <= good_mm else 0
                if layer_fits and not self.attempts and self.is_far(readable):
                    # The pattern is matched as a whole, for which a coarser layer is near enough.
                    rounds = 0
                layer_fits.append(self._prefit(readable, rounds))
                pose = layer_fits[-1].pose
        return layer_fits

    def follow(self, expected: MovingPose, miss_px: float) -> RefinedPose | None:
        """Fit the finest readable layer right where a pose is expected.

        None where its cells are small against ``miss_px``, by which the expectation may be off, or
        disagree with the pad: coarser layers may then lead there.
        """
        for layer in sorted(self.pad.layers, key=lambda item: item.cell_mm):
            readable = self.readable(layer, expected)
            if readable is not None:
                if miss_px > _WITHIN * readable.cell_px:
                    return None
                times = 1 if miss_px > _HERE * readable.cell_px else 0
                return self.refine_finest([self._prefit(readable, times)])
        return None

    def readable(self, layer: Layer, pose: MovingPose) -> LayerFit | None:
        """A layer's borders where a pose puts them, or None where it cannot be read."""
        least_px = self.params.refine.least_cell_px
        borders, cell_px = measurable_borders(
            self.pad, layer, self.camera, pose, self._most_borders, least_px
        )
        if len(borders.step) < LEAST_BORDERS or cell_px < least_px:
            return None
        return LayerFit(layer, borders, cell_px, pose, np.inf)

    def _prefit(self, last: LayerFit, times: int) -> LayerFit:
        """The layer with the pose that a few of its borders lead to."""
        few, cell_px = last.borders.thinned(self.params.refine.few_borders), last.cell_px
        for _ in range(times):
            edge_points = self._edge_points(last.layer, few, last.pose, cell_px, sharper=0)
            fit = self._fit(last.pose, edge_points, iterations=3, quiet_px=_QUIET * cell_px)
            if fit is None:
                break
            away_px = last.pose.apart_px(fit.pose, self.camera.focal_px)
            last = replace(last, pose=fit.pose, rms_px=fit.rms_px)
            if away_px < _SETTLED * cell_px:
                break
        return last

    def refine_finest(self, layer_fits: list[LayerFit]) -> RefinedPose | None:
        """Fit all borders of the finest layer, or of a coarser one where its cells disagree.

        Lenses and sensors shift channels against each other by parts of a pixel, so that borders of
        two layers together would tell a pose that suits neither.
        """
        for last in reversed(layer_fits):
            fit, edge_points = self._finish(last)
            if fit is None:
                continue
            read = self.read(last.layer, fit.pose)
            if read is not None and read.evidence.suffices(0.0):
                borders = last.borders if edge_points is None else edge_points.borders
                camera, cell_px = self.camera, last.cell_px
                return RefinedPose(fit, last.layer, borders, edge_points, camera, cell_px, read)
        return None

    def is_far(self, last: LayerFit) -> bool:
        """True where the finest cells are so small that the pattern is matched as a whole."""
        finest = min(layer.cell_mm for layer in self.pad.layers)
        return last.cell_px * finest / last.layer.cell_mm < self.params.refine.align_below_px

    def prematch(self, layer_fits: list[LayerFit]) -> list[LayerFit]:
        """The layers, the last one's pose matched to some pixels of the whole pattern."""
        last, refine = layer_fits[-1], self.params.refine
        match = Match.of(self.pyramid, self.camera, self.pad, last.pose, refine.most_pixels)
        fit = None if match is None else match.fit(last.pose, STILL, rough=True)
        pose, rms_px = (last.pose, np.inf) if fit is None else (fit.pose, fit.rms_px)
        return [*layer_fits[:-1], replace(last, pose=pose, rms_px=rms_px, match=match)]

    def _finish(self, last: LayerFit) -> tuple[Fit | None, EdgePoints | None]:
        """The best pose by a layer: by the whole pattern from afar, else by all borders."""
        if self.is_far(last):
            fit = self._match(last)
            # Glare bends the shading beyond what the match allows for; borders bear it.
            if fit is not None and fit.rms_px <= most_residual_px(last.cell_px, self.params.refine):
                return fit.settled(), None
        edge_points = self._edge_points(
            last.layer, last.borders, last.pose, last.cell_px, sharper=1
        )
        if self.motion is not None and self._rolling:
            fit = self._fit(last.pose, edge_points, iterations=4)
            return fit and fit.settled(), edge_points
        fit = self._fit(last.pose, edge_points.thinned(_DECIDING), iterations=3)
        if fit is None:
            return None, edge_points
        model = self.model(moving=not fit.pose.still)
        full = fit_pose(fit.pose, edge_points, self.camera, model, iterations=2)
        return (full or replace(fit, doubt=np.zeros(6))).settled(), edge_points

    def _match(self, last: LayerFit) -> Fit | None:
        """The whole pattern matched, with a still camera or a moving one as in `_fit`."""
        start = last.pose
        refine = self.params.refine
        most = refine.most_pixels
        most = most if self.attempts else min(most, refine.followed_pixels)
        match = last.match or Match.of(self.pyramid, self.camera, self.pad, start, most)
        if match is None:
            return None
        found = match.fit(start, self.model(moving=False))
        if found is None or self.motion is not None or not self._rolling:
            return found
        return better_of(found, match.fit(found.pose, self.model(moving=True)))

    def _fit(
        self, start: MovingPose, edge_points: EdgePoints, *, iterations: int, quiet_px: float = 0.0
    ) -> Fit | None:
        """A still fit, or a moving one where its motion is known or the residuals ask for it."""
        fit = fit_pose(start, edge_points, self.camera, self.model(moving=False), iterations)
        known = self.motion is not None
        if fit is None or known or not self._rolling or fit.rms_px < quiet_px:
            return fit
        model = self.model(moving=True)
        return better_of(fit, fit_pose(fit.pose, edge_points, self.camera, model, iterations))

    def read(self, layer: Layer, pose: MovingPose) -> LayerRead | None:
        """`read_layer` where all places that were searched compete, or those near by."""
        everywhere = 4 * layer.rows * layer.cols * self.attempts
        places = everywhere if self.attempts else _NEAR_BY
        return read_layer(self.pyramid, self.camera, self.pad, layer, pose, places)

    def _edge_points(
        self, layer: Layer, borders: Borders, pose: MovingPose, cell_px: float, *, sharper: int
    ) -> EdgePoints:
        window = self.window(layer, cell_px, sharper=sharper)
        return find_edge_points(borders, window, self.camera, pose, self.params.refine.reach_px)

    def window(self, layer: Layer, cell_px: float, *, sharper: int) -> Window:
        """The part of the pyramid in which cells so wide are measured, or ``sharper`` levels up."""
        level = math.floor(math.log2(max(cell_px / _CELL_PX, 1.0)))
        return self.pyramid.window(layer.channel, max(0, level - sharper))


def most_residual_px(cell_px: float, params: RefineParams) -> float:
    """Residuals beyond this mean that the borders are not those of cells of this width."""
    return params.most_residual_cells * cell_px + 1.0
