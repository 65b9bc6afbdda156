"""Prove the properties of a field, own or imported; shares no code with the generators."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Verification:
    """What holds for a field."""

    rows: int
    cols: int
    window: int
    levels: int
    windows: int
    unique: bool
    unique_under_rotation: bool
    visible_lines: bool
    min_distance: int
    min_distance_under_rotation: int

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def verify_field(
    field: NDArray[np.uint8], window: int, levels: int, *, distance_limit: int = 3
) -> Verification:
    """Verify all windows of a field of levels (rows, cols)."""
    views = np.lib.stride_tricks.sliding_window_view(field, (window, window))
    upright = views.reshape(-1, window, window)
    turned = np.concatenate([np.rot90(upright, k, (1, 2)) for k in range(4)])
    unique = len(np.unique(upright.reshape(len(upright), -1), axis=0)) == len(upright)
    rotation = len(np.unique(turned.reshape(len(turned), -1), axis=0)) == len(turned)
    across = (np.diff(upright, axis=1) != 0).any(2).all() and (np.diff(upright, axis=2) != 0).any(
        1
    ).all()
    return Verification(
        rows=field.shape[0],
        cols=field.shape[1],
        window=window,
        levels=levels,
        windows=len(upright),
        unique=unique,
        unique_under_rotation=rotation,
        visible_lines=bool(across),
        min_distance=int(unique),
        min_distance_under_rotation=int(rotation),
    )
