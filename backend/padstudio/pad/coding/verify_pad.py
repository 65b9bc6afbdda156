"""Prove the properties of a whole pad: of each layer, and of each two beside each other."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from itertools import combinations
from typing import Any, Literal

import numpy as np

from padstudio.pad.coding.nearest import nearest_apart
from padstudio.pad.coding.verify import Verification, affordable_limit, verify_field
from padstudio.pad.spec import Layer, Pad

Relation = Literal["independent", "near", "shared"]


@dataclass(frozen=True)
class Apart:
    """How far the windows of two layers are apart, in any turn.

    Attributes
    ----------
    channels : (str, str)
        Of the finer layer and the coarser one.
    relation : {"independent", "near", "shared"}
        "shared": some windows occur in both. "near": none does, but some differ in fewer cells than
        the pad promises of its windows. "independent": neither.
    windows : int
        Windows of the coarser layer.
    shared : int
        Of the finer layer's windows, how many occur in the coarser one.
    is_corner : bool
        The coarser layer is a copy of the finer one's upper left corner: the source paper's
        construction.
    distance_limit : int
        Distances up to this were looked for.
    min_distance : int
        Least number of cells in which two windows differ; ``distance_limit + 1`` means: at least
        that.
    """

    channels: tuple[str, str]
    relation: Relation
    windows: int
    shared: int
    is_corner: bool
    distance_limit: int
    min_distance: int


@dataclass(frozen=True)
class PadVerification:
    """What holds for a pad.

    Attributes
    ----------
    layers : tuple of (channel, Verification)
        The finest first.
    apart : tuple of Apart
        For each two layers.
    broken : tuple of str
        What the pad promises of its fields, and is not so.
    """

    layers: tuple[tuple[str, Verification], ...]
    apart: tuple[Apart, ...]
    broken: tuple[str, ...]

    @property
    def relation(self) -> Relation | None:
        """The worst of any two layers; None where there is one layer."""
        found = {pair.relation for pair in self.apart}
        order: tuple[Relation, ...] = ("shared", "near", "independent")
        return next((relation for relation in order if relation in found), None)

    def to_dict(self) -> dict[str, Any]:
        """All of the finest layer and, in short, of the ``others``; for JSON."""
        (channel, finest), *others = self.layers
        keys = ("unique", "unique_under_rotation", "min_distance", "min_distance_under_rotation")
        return {
            "channel": channel,
            **finest.to_dict(),
            "others": [
                {"channel": channel, **{key: getattr(found, key) for key in keys}}
                for channel, found in others
            ],
            "layers": self.relation,
            "apart": [{**asdict(pair), "channels": list(pair.channels)} for pair in self.apart],
            "broken": list(self.broken),
        }


def verify_pad(pad: Pad) -> PadVerification:
    """Verify all windows of all layers of a pad."""
    layers = sorted(pad.layers, key=lambda layer: layer.cell_mm)
    found = [(la.channel, verify_field(la.field, pad.window, pad.levels)) for la in layers]
    apart = [_apart(pad, fine, coarse) for fine, coarse in combinations(layers, 2)]
    broken = [words for channel, layer in found for words in _broken_in(pad, channel, layer)]
    if pad.layer_fields == "independent":
        broken += [
            f"the {' and '.join(pair.channels)} layers are not independent, but {pair.relation}"
            for pair in apart
            if pair.relation != "independent"
        ]
    return PadVerification(tuple(found), tuple(apart), tuple(broken))


def _broken_in(pad: Pad, channel: str, layer: Verification) -> list[str]:
    """What the pad promises of a layer, and is not so."""
    turned = pad.unique == "rotation"
    least = layer.min_distance_under_rotation if turned else layer.min_distance
    broken = []
    if pad.unique and least < min(pad.distance or 1, layer.distance_limit + 1):
        broken.append(
            f"windows of the {channel} layer differ in {least} cells only"
            if least
            else f"a window of the {channel} layer occurs twice"
        )
    if pad.visible_lines and not layer.visible_lines:
        broken.append(f"some inner lines of the {channel} layer are not visible")
    return broken


def _apart(pad: Pad, fine: Layer, coarse: Layer) -> Apart:
    b, promised = pad.window, pad.distance or 1
    windows = [(la.rows - b + 1) * (la.cols - b + 1) for la in (fine, coarse)]
    limit = max(affordable_limit(sum(windows), b * b, pad.levels), promised - 1)
    nearest = nearest_apart(fine.field, coarse.field, b, pad.levels, limit=limit).distance
    least, shared = int(nearest.min()), int((nearest == 0).sum())
    relation: Relation = "shared" if shared else "near" if least < promised else "independent"
    rows, cols = min(fine.rows, coarse.rows), min(fine.cols, coarse.cols)
    return Apart(
        channels=(fine.channel, coarse.channel),
        relation=relation,
        windows=windows[1],
        shared=shared,
        is_corner=np.array_equal(fine.field[:rows, :cols], coarse.field[:rows, :cols]),
        distance_limit=limit,
        min_distance=least,
    )
