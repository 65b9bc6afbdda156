"""What refining a pose hands on: a layer under way, and the refined pose."""

from __future__ import annotations

from dataclasses import dataclass

from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Layer
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.pose.edge_points import EdgePoints
from padstudio.vision.pose.edge_points_kernel import Borders
from padstudio.vision.pose.least_squares import Fit
from padstudio.vision.pose.pattern.image_alignment import Match


@dataclass(frozen=True, eq=False)
class RefinedPose:
    """A refined pose and what it rests on.

    Attributes
    ----------
    fit : Fit
    layer : Layer
        The finest layer whose borders were fitted.
    borders : Borders
        Its borders in view.
    edge_points : EdgePoints or None
        Those that were found; None where the pattern was matched as a whole.
    camera : Camera
        At the frame's size.
    cell_px : float
        Median width of a cell of the layer, frame pixels.
    read : LayerRead
        The layer's cells.
    flatness_mm : float or None
        Peak to valley of a bent sheet's heights in view; None where it lies flat.
    """

    fit: Fit
    layer: Layer
    borders: Borders
    edge_points: EdgePoints | None
    camera: Camera
    cell_px: float
    read: LayerRead
    flatness_mm: float | None = None


@dataclass(frozen=True, eq=False)
class LayerFit:
    """A readable layer with its borders in view, and what its few borders gave.

    From afar ``match`` compares the whole pattern near its pose.
    """

    layer: Layer
    borders: Borders
    cell_px: float
    pose: MovingPose
    rms_px: float
    match: Match | None = None
