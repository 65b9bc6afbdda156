"""Which scale a pose stands at, where the pad's layers share a code.

In the source paper's construction the coarse layer is a copy of the fine one's corner. Cells read
in one channel may then be those of either layer, and the pose be wrong by the ratio of their
cells: in grey pictures, where each channel shows both layers, and where red and blue are exchanged.
The right scale is the one whose pose explains what *every* channel shows (`cells.mixture`).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.mixture import Mixture, find_mixture
from padstudio.vision.dense.starts import refine_best
from padstudio.vision.pose.refiner import Refiner
from padstudio.vision.pose.results import RefinedPose
from padstudio.vision.stage.trace import Reason, StageFailure

SWAPPED_ADVICE = "exchange red and blue where the picture is read (RGB taken for BGR?)"


def borne_out(refiner: Refiner, refined: RefinedPose) -> RefinedPose | StageFailure:
    """The pose, or the same one at another layer's scale, that explains every channel.

    Parameters
    ----------
    refiner : Refiner
    refined : RefinedPose
        Borne out by its own layer's cells.

    Returns
    -------
    RefinedPose or StageFailure
        The pose itself where too little of the pad is in view to tell.
    """
    mixture = _mixture(refiner, refined.fit.pose)
    ratios = shared_scales(refiner.pad)
    if mixture is None or not (mixture.exchanged or _fault(mixture, ratios)):
        return refined
    if mixture.exchanged:
        return swapped()
    for ratio in ratios:
        start = rescaled(refiner.pad, refined.fit.pose, ratio)
        other = _mixture(refiner, start)
        if other is None or other.unexplained is not None:
            continue
        if other.exchanged:
            return swapped()
        again = None if other.hidden else refine_best(refiner, [start], np.inf)
        if again is not None:
            settled = _mixture(refiner, again.fit.pose)
            if settled is not None and not _fault(settled, ratios):
                return again
    return StageFailure("choose", Reason.POSE_REJECTED, _fault(mixture, ratios) or "")


def swapped() -> StageFailure:
    """Red and blue are exchanged."""
    detail = "each layer is seen in the other one's channel: red and blue are exchanged"
    return StageFailure("choose", Reason.CHANNELS_SWAPPED, detail, SWAPPED_ADVICE)


def rescaled(pad: Pad, pose: MovingPose, ratio: float) -> MovingPose:
    """The pose that sees, where ``pose`` sees a cell, that of the same row and column of a layer
    with cells so many times as wide: all layers begin at the pad's top left corner."""
    width, height = pad.size_mm
    corner = np.array([-width / 2, height / 2, 0.0])
    position = corner + ratio * (pose.pose.position_mm - corner)
    return MovingPose(Pose(position, pose.pose.rotation), ratio * pose.shift_mm, pose.rotvec)


@lru_cache(maxsize=8)
def shared_scales(pad: Pad) -> tuple[float, ...]:
    """Ratios of the cells of layers that begin with the same code, in either direction."""
    return tuple(
        other.cell_mm / layer.cell_mm
        for layer in pad.layers
        for other in pad.layers
        if other is not layer and _begin_alike(layer, other)
    )


def _begin_alike(a: Layer, b: Layer) -> bool:
    rows, cols = min(a.rows, b.rows), min(a.cols, b.cols)
    return bool((a.field[:rows, :cols] == b.field[:rows, :cols]).all())


def _mixture(refiner: Refiner, pose: MovingPose) -> Mixture | None:
    return find_mixture(refiner.pyramid, refiner.camera, refiner.pad, pose)


def _fault(mixture: Mixture, ratios: tuple[float, ...]) -> str | None:
    """Why a pose is not borne out, a sentence; None where it is.

    A layer whose ink does not show is no fault where no other scale could be meant.
    """
    if mixture.unexplained is not None:
        return f"the {mixture.unexplained} channel shows structure that the pose does not explain"
    if ratios and mixture.hidden is not None:
        return f"the {mixture.hidden} layer's cells should be seen with this pose, and are not"
    return None
