"""The dense method's last resort: a pad so far away that only the sign as a whole is there.

The four sides of the pad's colour give a pose for each of the four quarter turns; the whole pattern
is then matched to the frame from each of them, and the cells, read with the matched pose, tell
which one it is, and whether it is this pad at all.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from padstudio.geometry.planar_pnp import planar_pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import outline_mm
from padstudio.pad.spec import Pad
from padstudio.vision.cells.layer_read import LayerRead, read_layer
from padstudio.vision.frame.regions import Region, sharper
from padstudio.vision.outline.quadrilateral import Outline, another_sign, find_outline
from padstudio.vision.pose.least_squares import Fit
from padstudio.vision.pose.pattern.image_alignment import Match
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.stage.trace import Reason, StageFailure

# With the sign's own outline there are four places to choose from instead of thousands, so cells
# that are too small to be read without errors suffice.
_LEAST_KAPPA = 0.3
# So many quarter turns are matched. Not measured: even cells of two pixels should tell the right
# one from most others.
_TURNS = 2


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
        As of `padstudio.vision.frame.regions.find_regions`.
    """
    outline = outline_in(refiner, region)
    if isinstance(outline, StageFailure):
        return outline
    best: WholeSign | None = None
    for start in itertools.chain(*_likeliest(refiner, poses_of(outline, refiner.pad))):
        found = _matched(refiner, outline, start, rough=True)
        if found is not None and (best is None or _surer(found, best)):
            best = found
    if best is not None:
        best = _matched(refiner, outline, best.fit.pose, rough=False)
    if best is None:
        return StageFailure("outline", Reason.NO_OUTLINE, "the outline's corners give no pose")
    best = replace(best, fit=best.fit.settled())
    bound = refiner.params.log10_false_alarm
    if not best.read.evidence.suffices(bound, least_kappa=_LEAST_KAPPA):
        return another_sign(best.read)
    return best


def _likeliest(refiner: Refiner, turns: list[list[MovingPose]]) -> list[list[MovingPose]]:
    """The quarter turns whose coarse cells agree with the pad best, as far as they can be read."""

    def agreement(poses: list[MovingPose]) -> float:
        read = _read_coarse(refiner, poses[0])
        return -1.0 if read is None else read.evidence.kappa

    return sorted(turns, key=agreement, reverse=True)[:_TURNS]


def outline_in(refiner: Refiner, region: Region, finest: int = 0) -> Outline | StageFailure:
    """The sign's four sides in a region, to a part of a pixel of the pyramid's level."""
    shape = sharper(refiner.pyramid, refiner.pad, region)
    params = refiner.params.outline
    return find_outline(refiner.pyramid, refiner.camera, refiner.pad, shape, params, finest)


def poses_of(outline: Outline, pad: Pad) -> list[list[MovingPose]]:
    """For each quarter turn the pose that shows the pad's corners where the outline's are, with its
    mirrored answer where there is one."""
    found = []
    for quarter_turns in range(4):
        corners_mm = np.roll(outline_mm(pad), quarter_turns, axis=0)
        planar = planar_pose(corners_mm, outline.corners_rays)
        if planar is not None:
            poses = [planar.pose, planar.other]
            found.append([MovingPose(pose) for pose in poses if pose is not None])
    return found


def readable_poses(outline: Outline, refiner: Refiner) -> list[MovingPose]:
    """Of `poses_of` those whose coarse cells agree with the pad best, if any do."""
    best: tuple[float, list[MovingPose]] = (-np.inf, [])
    for poses in poses_of(outline, refiner.pad):
        read = _read_coarse(refiner, poses[0])
        if read is not None and read.evidence.suffices(0.0) and read.evidence.kappa > best[0]:
            best = (read.evidence.kappa, poses)
    return best[1]


def _matched(
    refiner: Refiner, outline: Outline, start: MovingPose, *, rough: bool
) -> WholeSign | None:
    refine = refiner.params.refine
    match = Match.of(refiner.pyramid, refiner.camera, refiner.pad, start, refine.most_pixels)
    fit = match and match.fit(start, refiner.model(moving=False), rough=rough)
    read = fit and _read_coarse(refiner, fit.pose)
    return WholeSign(fit, read, outline) if fit and read else None


def _read_coarse(refiner: Refiner, pose: MovingPose) -> LayerRead | None:
    """The coarse layer's cells; the outline leaves four turns of each pad to choose from."""
    pad = refiner.pad
    coarse = max(pad.layers, key=lambda layer: layer.cell_mm)
    ways = 4 * max(refiner.attempts, 1)
    return read_layer(refiner.pyramid, refiner.camera, pad, coarse, pose, ways)


def _surer(a: WholeSign, b: WholeSign) -> bool:
    """Cells that agree decide; of two poses that read alike, the better match."""
    left, right = a.read.evidence, b.read.evidence
    if abs(left.kappa - right.kappa) > 0.02:
        return left.kappa > right.kappa
    return a.fit.rms_px < b.fit.rms_px
