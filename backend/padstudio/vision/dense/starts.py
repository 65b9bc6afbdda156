"""First poses of a sighted lattice, and which of several is refined to the end.

A plane seen from afar has two poses that fit its points alike (IPPE): both are kept while nothing
sets them apart, as refining one takes longer than finding it.
"""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.planar_pnp import planar_pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import lattice_mm
from padstudio.pad.spec import Pad
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.refine.results import LayerFit, RefinedPose
from padstudio.vision.search.lattice import Lattice
from padstudio.vision.search.search import Sighting

# Below this ratio of the two planar poses' errors the first one is beyond doubt.
_CLEAR = 0.15
# A start whose few borders fit this much better than the other's needs no comparison to the end.
_BETTER = 0.85
# So, too, where the whole pattern is compared.
_BETTER_MATCH = 0.97
# The lattice's part in view is told by so many crossings a side.
_CROSSINGS = 5
# None of them lies farther from the axis than this on the plane z = 1, 72 degrees: there a wide
# lens's lattice is drawn by few edges.
_WIDEST = 3.0
# The part is halved about the lattice's origin until that holds, so far at the most.
_LEAST_PART = 0.1


def first_poses(pad: Pad, sighting: Sighting) -> list[MovingPose]:
    """The pose of the sighted lattice; both planar answers where they are near each other."""
    lattice, placement = sighting.lattice, sighting.placement
    here = _crossings(lattice)
    there = np.column_stack([here, np.ones(len(here))]) @ placement.pad_from_lattice.T
    planar = planar_pose(lattice_mm(pad, placement.layer, there), lattice.to_rays(here))
    if planar is None:
        return []
    if planar.other is None or planar.ambiguity < _CLEAR:
        return [MovingPose(planar.pose)]
    return [MovingPose(planar.pose), MovingPose(planar.other)]


def _crossings(lattice: Lattice) -> Array:
    """Lattice coordinates (N, 2) all over the part in view that lies well before the camera."""
    size = 1.0
    while True:
        columns, rows = (
            np.linspace(size * first, size * last, _CROSSINGS)
            for first, last in (lattice.columns, lattice.rows)
        )
        here = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
        # The lattice was grown from its coordinates (0, 0), which the camera sees.
        middle, depth = (lattice.depth(at) for at in (np.zeros((1, 2)), here))
        ahead = (depth * middle > 0).all()
        if size < _LEAST_PART or (ahead and np.abs(lattice.to_rays(here)).max() < _WIDEST):
            return here
        size /= 2


def refine_best(refiner: Refiner, starts: list[MovingPose], good_mm: float) -> RefinedPose | None:
    """Refine the start whose few borders fit best; of several that do, the better in the end.

    Parameters
    ----------
    refiner : Refiner
    starts : list of MovingPose
    good_mm : float
        As of `Refiner.coarse_to_fine`.
    """
    tried = [found for start in starts if (found := refiner.coarse_to_fine(start, good_mm))]
    tried.sort(key=lambda found: (found[-1].layer.cell_mm, found[-1].rms_px))
    if len(tried) > 1:
        tried = _likely(refiner, tried)
    refined = [item for item in map(refiner.refine_finest, tried) if item is not None]
    return min(refined, key=lambda item: (item.layer.cell_mm, item.fit.rms_px), default=None)


def _likely(refiner: Refiner, tried: list[list[LayerFit]]) -> list[list[LayerFit]]:
    """The starts that may be right: the best one, and others that a look does not set apart."""
    margin = _BETTER
    if any(refiner.is_far(found[-1]) for found in tried):
        tried, margin = [refiner.prematch(found) for found in tried], _BETTER_MATCH
    tried = sorted(tried, key=lambda found: found[-1].rms_px)
    kept = tried[:1]
    for found in tried[1:]:
        doubtful = found[-1].rms_px * margin <= kept[0][-1].rms_px
        if doubtful and not any(found[-1].pose.near(other[-1].pose) for other in kept):
            kept.append(found)
    return kept
