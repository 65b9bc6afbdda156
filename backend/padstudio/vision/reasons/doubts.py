"""What is to be doubted of a pose: the camera file, the print's proportions, flat paper, colours.

Borders that lie off by a pattern tell what is wrong. Each explanation is one number more
(`distortions`). They are asked of the largest cells that suffice: borders of small ones may be off
by more than half a cell, and then be taken for their neighbours.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose.edge_points import EdgePoints, find_edge_points
from padstudio.vision.reasons.clues import Clues
from padstudio.vision.reasons.distortions import CHANGES, Explanation, explanations
from padstudio.vision.reasons.failed import GREY, MOST_ALIKE, crosstalk, monochrome
from padstudio.vision.reasons.other_cameras import wrong_camera
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Finding, Reason

# Fewer borders tell nothing of a camera.
_LEAST_BORDERS = 60
# Variances by which an explanation must lower the sum of squares; sharing so much of the best
# one's gain, another one fits, too.
_GAIN, _SHARED = 80.0, 0.9
# Amounts below which nobody need care: shares of a length, and pixels at the frame's corner.
_LEAST_SHARE, _LEAST_CORNER_PX = 0.005, 0.5
# What borders of a good frame leave at most, pixels.
_GOOD_PX = 0.5
# What a camera that moves while its shutter rolls may do as well; a smaller share is not said then.
_AFFINE, _LEAST_DRIFT = ("aspect", "stretch"), 0.01
_DRIFT = "; a camera that moved while its shutter rolled explains it, too"
_FLATTEN = "lay the pad flat, its sheets edge to edge, or glue it to a board"
# Half length of the profiles across borders, pixels where cells are about 9 px wide.
_REACH_PX = 8.0


@dataclass(frozen=True, eq=False)
class Seen:
    """A pose with the borders that tell of its camera.

    Attributes
    ----------
    detection : Detection
    camera : Camera
        At the frame's size.
    edge_points : EdgePoints or None
        None where cells are too small, or too few.
    """

    detection: Detection
    camera: Camera
    edge_points: EdgePoints | None

    @property
    def pose(self) -> MovingPose:
        """The pose, with what moved in the frame."""
        detection = self.detection
        assert detection.pose is not None
        if detection.shift_mm is None or detection.turn_rad is None:
            return MovingPose(detection.pose)
        return MovingPose(detection.pose, detection.shift_mm, detection.turn_rad)


def seen_with(refiner: Refiner, detection: Detection) -> Seen:
    """The borders of the largest cells of which enough are in view, where the pose puts them."""
    seen = Seen(detection, refiner.camera, None)
    for layer in sorted(refiner.pad.layers, key=lambda item: -item.cell_mm):
        readable = refiner.readable(layer, seen.pose)
        if readable is None or readable.cell_px < refiner.params.refine.align_below_px:
            continue
        window = refiner.window(layer, readable.cell_px, sharper=0)
        found = find_edge_points(readable.borders, window, refiner.camera, seen.pose, _REACH_PX)
        if len(found.xy) >= _LEAST_BORDERS:
            return replace(seen, edge_points=found)
    return seen


def doubts_of(seen: Seen, clues: Clues) -> list[Finding]:
    """Findings on a pose, the likeliest first; none where nothing is wrong.

    Parameters
    ----------
    seen : Seen
    clues : Clues
        Of the frame.
    """
    fits, told, flatness = {}, [], seen.detection.flatness_mm
    if seen.edge_points is not None:
        fits = explanations(seen.edge_points, seen.camera, seen.pose)
        told = list(_told(fits, seen.camera))
    if flatness is not None:
        # One number that explains as much is likelier than a bent sheet of a hundred.
        fits_well = any(fits[name].rms_px < _GOOD_PX for name in CHANGES if name in fits)
        told.insert(len(told) if told and fits_well else 0, _warped(flatness))
    if clues.color < GREY:
        told.append(monochrome(clues.color))
    elif clues.likeness > MOST_ALIKE:
        told.append(crosstalk(clues.likeness))
    return told


def _told(fits: dict[str, Explanation], camera: Camera) -> Iterator[Finding]:
    """What single changes explain, the best of them first."""
    names = [name for name in CHANGES if name in fits]
    names.sort(key=lambda name: -fits[name].gain)
    best = max((fits[name].gain for name in [*names, "motion"] if name in fits), default=0.0)
    for name in names:
        fit = fits[name]
        if fit.gain < max(_GAIN, _SHARED * best) or not _matters(name, fit.amount, camera):
            continue
        # Together with the pose a drift from row to row is any affine change of the picture.
        may_drift = camera.readout_ms != 0 and name in _AFFINE
        if may_drift and abs(fit.amount) < _LEAST_DRIFT:
            continue
        drift = may_drift and fits["motion"].gain >= _SHARED * fit.gain
        yield _worded(name, fit, fits["pose"], drift=drift)


def _matters(name: str, amount: float, camera: Camera) -> bool:
    if name != "lens":
        return abs(amount) >= _LEAST_SHARE
    corner = math.hypot(camera.width, camera.height) / 2 / camera.focal_px
    return abs(amount) * corner**3 * camera.focal_px >= _LEAST_CORNER_PX


def _worded(name: str, fit: Explanation, alone: Explanation, *, drift: bool) -> Finding:
    off = f"borders lie {alone.rms_px:.2f} px off, and {fit.rms_px:.2f} px"
    ratio = math.exp(fit.amount)
    wide = "wide" if ratio > 1 else "narrow"
    if name == "stretch":
        return Finding(
            Reason.PRINT_SCALE,
            f"the print is {100 * abs(ratio - 1):.1f} % too {wide} for "
            f"its height: {off} with that{_DRIFT if drift else ''}",
            "measure the print, write its scale into the pad file, or print at 100 % once more",
        )
    words = {
        "focal": f"with {ratio:.3f} times the focal length",
        "lens": f"with a lens whose first coefficient differs by {fit.amount:+.3f}",
        "aspect": f"with pixels {ratio:.3f} times as wide as high",
    }
    return wrong_camera(f"{off} {words[name]}{_DRIFT if drift else ''}")


def _warped(flatness_mm: float) -> Finding:
    return Finding(
        Reason.WARPED,
        f"the paper is bent: its heights differ by {flatness_mm:.0f} mm in view, and the pose is "
        "relative to the plane that fits them best",
        _FLATTEN,
    )
