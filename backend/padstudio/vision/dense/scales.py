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
from padstudio.vision.cells.evidence import judge
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.cells.mixture import Mixture, find_mixture
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.refine.results import RefinedPose
from padstudio.vision.stage.trace import Reason, StageFailure

# A layer is told from another one by cells that only it has, where chance is below this.
_LOG10_ITS_OWN = -6.0
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
    pose, scales = refined.fit.pose, other_scales(refiner.pad, refined.read)
    mixture = _mixture(refiner, pose)
    fault = _fault(mixture, scales)
    if fault is not None and fault.reason is Reason.CHANNELS_SWAPPED:
        return fault
    for scale in scales if fault or not _tells_all(mixture, refiner.pad) else ():
        start = rescaled(refiner.pad, pose, scale)
        other = _mixture(refiner, start)
        against = _fault(other, scales)
        if fault and against and against.reason is Reason.CHANNELS_SWAPPED:
            return against
        if other is None or against is not None or not (fault or _tells_more(other, mixture)):
            continue
        again = refiner.follow(start, 0.0)
        if again is not None and contradiction(refiner, again.fit.pose, again.read) is None:
            return again
        fault = fault or _rejected("the channels show more of the pad at another scale")
    return fault or refined


def contradiction(refiner: Refiner, pose: MovingPose, read: LayerRead) -> StageFailure | None:
    """What the channels show against a pose; None where they bear it out, or show too little.

    Parameters
    ----------
    refiner : Refiner
    pose : MovingPose
    read : LayerRead
        The cells that the pose rests on.
    """
    return _fault(_mixture(refiner, pose), other_scales(refiner.pad, read))


def doubt(refiner: Refiner, pose: MovingPose, read: LayerRead) -> StageFailure | None:
    """As `contradiction`; also where the same cells at another scale explain the frame better.

    For methods that give one pose and do not refine another.
    """
    scales = other_scales(refiner.pad, read)
    mixture = _mixture(refiner, pose)
    fault = _fault(mixture, scales)
    for scale in scales if fault or not _tells_all(mixture, refiner.pad) else ():
        other = _mixture(refiner, rescaled(refiner.pad, pose, scale))
        against = _fault(other, scales)
        if against is not None and against.reason is Reason.CHANNELS_SWAPPED:
            return against
        if other is not None and against is None and _tells_more(other, mixture):
            detail = f"the same cells {scale:g} times as large explain every channel better"
            fault = fault or StageFailure("pose", Reason.POSE_REJECTED, detail)
    return fault


def other_scales(pad: Pad, read: LayerRead) -> tuple[float, ...]:
    """At which other scales the same cells could be read: in layers that begin with their code.

    Cells beyond the part that two layers share tell which one it is, where they alone suffice.
    """
    layer, levels = read.layer, read.cells.levels(pad.levels)
    found = []
    for other in pad.layers:
        if other is layer or not _begin_alike(layer, other):
            continue
        rows = max(0, min(other.rows, layer.rows) - read.cells.row0)
        cols = max(0, min(other.cols, layer.cols) - read.cells.column0)
        own = levels.copy()
        own[:rows, :cols] = -1
        evidence = judge(own, read.expected, pad.levels, 4 * layer.field.size)
        if not evidence.suffices(_LOG10_ITS_OWN):
            found.append(other.cell_mm / layer.cell_mm)
    return tuple(found)


def _mixture(refiner: Refiner, pose: MovingPose) -> Mixture | None:
    return find_mixture(refiner.pyramid, refiner.camera, refiner.pad, pose)


def _fault(mixture: Mixture | None, scales: tuple[float, ...]) -> StageFailure | None:
    """What a mixture says against its pose.

    Dirt in a channel, or an ink that does not show, is no fault where no other scale could be
    meant: the cells that the pose rests on have borne it out.
    """
    if mixture is None:
        return None
    if mixture.exchanged:
        return swapped("pose")
    if not scales:
        return None
    if mixture.unexplained is not None:
        detail = f"the {mixture.unexplained} channel shows what this pose does not explain"
    elif mixture.hidden is not None:
        detail = f"the {mixture.hidden} cells should be seen with this pose, and are not"
    else:
        return None
    return _rejected(detail)


def _rejected(detail: str) -> StageFailure:
    return StageFailure("pose", Reason.POSE_REJECTED, detail)


def _tells_all(mixture: Mixture | None, pad: Pad) -> bool:
    return mixture is None or mixture.telling >= {layer.channel for layer in pad.layers}


def _tells_more(other: Mixture, than: Mixture | None) -> bool:
    """True where another scale puts more layers in view that must be seen, and are."""
    return than is not None and other.telling > than.telling


def swapped(stage: str) -> StageFailure:
    """Red and blue are exchanged, as a stage found."""
    detail = "each layer is seen in the other one's channel: red and blue are exchanged"
    return StageFailure(stage, Reason.CHANNELS_SWAPPED, detail, SWAPPED_ADVICE)


def rescaled(pad: Pad, pose: MovingPose, ratio: float) -> MovingPose:
    """The pose that sees, where ``pose`` sees a cell, that of the same row and column of a layer
    with cells so many times as wide: all layers begin at the pad's top left corner."""
    width, height = pad.size_mm
    corner = np.array([-width / 2, height / 2, 0.0])
    position = corner + ratio * (pose.pose.position_mm - corner)
    return MovingPose(Pose(position, pose.pose.rotation), ratio * pose.shift_mm, pose.rotvec)


@lru_cache(maxsize=16)
def _begin_alike(a: Layer, b: Layer) -> bool:
    rows, cols = min(a.rows, b.rows), min(a.cols, b.cols)
    return bool((a.field[:rows, :cols] == b.field[:rows, :cols]).all())
