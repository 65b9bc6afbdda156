"""Lines of poses files of a wandering camera, as chunks give them."""

from __future__ import annotations

from typing import Any

import numpy as np
from wandering import Wandering

from padstudio.vision.stage.detection import Uncertainty, pose_fields, uncertainty_fields

Record = dict[str, Any]
FAILED = {"status": "failed", "stage": "grid", "reason": "no_lattice", "detail": "", "advice": ""}


def records(count: int, *, seed: int = 1, source: str = "a.mp4", fps: float = 10.0) -> list[Record]:
    """Frames' own poses; every eleventh frame failed."""
    frames, _ = Wandering(fps=fps).frames(count, seed)
    out = []
    for number, frame in enumerate(frames):
        record: Record = {"source": source, "frame": number, "time_s": frame.time_s}
        if number % 11 == 5:
            record |= FAILED
        else:
            sigma = Uncertainty.of(frame.pose, frame.covariance)
            record |= {"status": "ok", "layer": "red", "estimate": "frame"}
            record |= pose_fields(frame.pose)
            record |= {
                **uncertainty_fields(sigma),
                "quality": sigma.quality_at(frame.pose.range_mm),
                "covariance": frame.covariance[np.triu_indices(6)].tolist(),
            }
        out.append(record | {"elapsed_ms": {"total": 1.0}})
    return out
