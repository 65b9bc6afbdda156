"""The dense method's last resort: a pad so far away that only the sign as a whole is there.

The four sides of the pad's colour give a pose for each of the four turns; the whole pattern is
then matched to the frame from each of them, and the cells, read with the matched pose, tell which
turn it is and whether it is this pad at all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from padstudio.pad.layout import outline_mm
from padstudio.vision.align import align
from padstudio.vision.measure import LayerRead, Refiner
from padstudio.vision.motion import MovingPose
from padstudio.vision.outline import Outline, find_outline
from padstudio.vision.planar import planar_pose
from padstudio.vision.refine import Fit
from padstudio.vision.regions import Region, sharper
from padstudio.vision.types import Reason, StageFailure

# With the sign's own outline there are four places to choose from instead of thousands, so cells
# that are too small to be read without errors suffice.
_LEAST_SKILL = 0.3


@dataclass(frozen=True, eq=False)
class WholeSign:
    """A pose from the whole sign.

    Attributes
    ----------
    fit : Fit
    read : LayerRead
        The coarse layer's cells, read with the pose.
    outline : Outline
        Where the search began.
    """

    fit: Fit
    read: LayerRead
    outline: Outline


def find_whole_sign(refiner: Refiner, region: Region) -> WholeSign | StageFailure:
    """Match the whole sign within its outline.

    Parameters
    ----------
    refiner : Refiner
    region : Region
        As of `padstudio.vision.regions.find_regions`.
    """
    camera, pad, rolling = refiner.camera, refiner.pad, refiner.params.refine.motion
    shape = sharper(refiner.pyramid, pad, region)
    outline = find_outline(refiner.pyramid, camera, pad, shape)
    if isinstance(outline, StageFailure):
        return outline
    coarse = max(pad.layers, key=lambda layer: layer.cell_mm)
    best: WholeSign | None = None
    for turn in range(4):
        planar = planar_pose(np.roll(outline_mm(pad), turn, axis=0), outline.corners_rays)
        if planar is None:
            continue
        for start in (planar.pose, planar.other):
            if start is None:
                continue
            fit = align(
                refiner.pyramid, camera, pad, MovingPose(start), motion=False, rolling=rolling
            )
            read = None if fit is None else refiner.read(coarse, fit.pose, places=4)
            if fit is None or read is None:
                continue
            found = WholeSign(fit, read, outline)
            if best is None or _surer(found, best):
                best = found
    if best is None:
        return StageFailure("outline", Reason.NO_OUTLINE, "the outline's corners give no pose")
    evidence = best.read.evidence
    if not evidence.suffices(refiner.params.log10_false_alarm, least_skill=_LEAST_SKILL):
        return StageFailure(
            "outline",
            Reason.UNKNOWN_CODE,
            f"four sides are there, but {evidence.wrong} of {evidence.read} "
            f"{coarse.channel} cells within them differ from the pad in its best turn",
        )
    return best


def _surer(a: WholeSign, b: WholeSign) -> bool:
    """Cells that agree decide; of two poses that read alike, the better match."""
    left, right = a.read.evidence, b.read.evidence
    if abs(left.skill - right.skill) > 0.02:
        return left.skill > right.skill
    return a.fit.rms_px < b.fit.rms_px
