"""Pads that a search looks for, and where in the picture those lie that it found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.errors import SpecError
from padstudio.geometry.camera import Camera
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Pad
from padstudio.vision.cells.correlation import LayerIndex
from padstudio.vision.frame.regions import Region, parts_of
from padstudio.vision.stage.detection import Detection

# Beyond its rim and quiet margin so much of a pad's longer side counts as the pad, too: bent paper
# and steps at the paper's edge lie there.
_MARGIN = 0.02


@dataclass(frozen=True, eq=False)
class KnownPad:
    """A pad that is looked for.

    Attributes
    ----------
    pad : Pad
    id : str
        As of `padstudio.pad.identity.pad_id`.
    indices : tuple of LayerIndex
        Its layers prepared for look-up, the coarse one first.
    """

    pad: Pad
    id: str
    indices: tuple[LayerIndex, ...]

    @classmethod
    def of(cls, pad: Pad) -> KnownPad:
        """Prepare a pad."""
        layers = sorted(pad.layers, key=lambda layer: -layer.cell_mm)
        return cls(pad, pad_id(pad), tuple(LayerIndex(pad, layer) for layer in layers))


@dataclass(frozen=True, eq=False)
class FoundPad:
    """A pad that was found, and what the rest of a search leaves out for it.

    Attributes
    ----------
    known : KnownPad
    detection : Detection
        With a pose.
    camera : Camera
        The frame's.
    """

    known: KnownPad
    detection: Detection
    camera: Camera

    def shows(self, xy: Array) -> NDArray[np.bool_]:
        """Which frame pixels (N, 2) show the pad or its quiet margin."""
        pose, pad = self.detection.pose, self.known.pad
        assert pose is not None
        normalized = self.camera.normalize(xy)
        seen = self.camera.has_ray(xy, normalized)
        rays = np.column_stack([normalized, np.ones(len(normalized))]) @ pose.rotation.T
        half = np.array(pad.size_mm) / 2 + pad.quiet_mm + _MARGIN * max(pad.size_mm)
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = -pose.position_mm[2] / rays[:, 2]
            there = pose.position_mm[:2] + depth[:, None] * rays[:, :2]
            inside = (depth > 0) & (np.abs(there) < half).all(axis=1)
        return np.asarray(seen & inside)

    def left_of(self, region: Region) -> list[Region]:
        """Parts of a region that do not show the pad; the region itself where none does."""
        if region.mask is None:
            return [region]
        shown = self.shows(region.points())
        if not shown.any():
            return [region]
        mask = region.mask.copy()
        rows, columns = np.nonzero(mask)
        mask[rows[shown], columns[shown]] = False
        return parts_of(mask, region.level, (self.camera.width, self.camera.height))


def together(pads: Sequence[KnownPad], *, unmix: bool) -> list[list[KnownPad]]:
    """Pads by the planes that they are read in: of the same channels and mixture of colours.

    Parameters
    ----------
    pads : sequence of KnownPad
    unmix : bool
        Mixtures count.
    """
    groups: dict[object, list[KnownPad]] = {}
    for known in pads:
        channels = frozenset(layer.channel for layer in known.pad.layers)
        mixture = known.pad.crosstalk if unmix else None
        key = channels, None if mixture is None else np.asarray(mixture).tobytes()
        groups.setdefault(key, []).append(known)
    return list(groups.values())


def check_apart(pads: Sequence[Pad]) -> None:
    """Refuse pads that a picture cannot tell apart.

    Raises
    ------
    SpecError
        If there is none, or two have the same cells in one channel, in any turn.
    """
    if not pads:
        raise SpecError("give a detector one pad at least", code="no_pads")
    for number, first in enumerate(pads):
        for second in pads[number + 1 :]:
            channel = _alike(first, second)
            if channel is not None:
                ids = [pad_id(first), pad_id(second)]
                raise SpecError(
                    f"pads {first.name!r} ({ids[0]}) and {second.name!r} ({ids[1]}) "
                    f"have the same {channel} cells, so that no picture of these tells which it "
                    "is; leave one out",
                    code="pads_alike",
                    detail={"pads": ids},
                )


def _alike(a: Pad, b: Pad) -> str | None:
    """A channel in which two pads have the same cells, in any turn; or None."""
    for layer in a.layers:
        for other in b.layers:
            if layer.channel == other.channel and any(
                np.array_equal(layer.field, np.rot90(other.field, turn)) for turn in range(4)
            ):
                return layer.channel
    return None
