"""What a calibration lacks, and which pictures to take again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from padstudio.calibration.certainty import GRID, grid_pixels
from padstudio.calibration.results import Calibration, CalibrationView

PictureState = Literal["good", "not_read", "contradicts", "rough", "little"]
PICTURE_STATES: tuple[PictureState, ...] = get_args(PictureState)

# Calibrations of fewer pictures were up to three times less exact than of a dozen.
_ENOUGH = 8
# Without a picture from so far aside, focal length and distance are told apart by the lens alone.
_TILTED_DEG = 15.0
# A focal length less sure than this share of it moves heights by as much.
_UNSURE = 1e-3
# Residuals so many times what the pictures' own scatter explains; good ones had 1 at the most.
_EXCESS = 1.8
# Parts of the grid of certainty in which fewer patches lie were not seen; so many may be.
_SEEN, _UNSEEN_SHARE = 1, 0.1
# Pictures whose residuals are larger than the usual by this factor and above so many pixels, and
# those with fewer patches than this share of the usual, are told.
_ROUGH, _ROUGH_PX, _LITTLE = 2.0, 0.1, 0.15


@dataclass(frozen=True)
class CalibrationFinding:
    """Something a calibration lacks.

    Attributes
    ----------
    code : str
        ``few_pictures``, ``little_tilt``, ``unexplained``, ``unsure_focal_length``,
        ``unseen_parts`` or ``folded_lens``.
    message : str
        What is so, with its figures, and what to do.
    """

    code: str
    message: str


@dataclass(frozen=True)
class PictureVerdict:
    """Whether a picture should be taken again.

    Attributes
    ----------
    state : {"good", "not_read", "contradicts", "rough", "little"}
    message : str
        Empty for a good one.
    """

    state: PictureState
    message: str = ""


def coverage(calibration: Calibration) -> NDArray[np.intp]:
    """Patches in each part of the picture's grid, (R, C), of all pictures that count."""
    camera = calibration.camera
    pixels = np.concatenate([view.patches.pixels for view in calibration.used if view.patches])
    x, y = (
        np.linspace(-0.5, camera.width - 0.5, GRID[0] + 1),
        np.linspace(-0.5, camera.height - 0.5, GRID[1] + 1),
    )
    counts, _, _ = np.histogram2d(pixels[:, 1], pixels[:, 0], bins=(y, x))
    return np.asarray(counts, np.intp)


def findings(calibration: Calibration) -> list[CalibrationFinding]:
    """What a calibration lacks; empty for a good one."""
    used = calibration.used
    out = []
    if len(used) < _ENOUGH:
        out.append(
            CalibrationFinding(
                "few_pictures",
                f"it rests on {len(used)} pictures; a dozen from different sides are surer",
            )
        )
    tilt = max(view.pose.tilt_deg for view in used if view.pose is not None)
    if tilt < _TILTED_DEG:
        out.append(
            CalibrationFinding(
                "little_tilt",
                f"the steepest picture leans by {tilt:.0f}°; take some from 20° … 45° aside, which "
                "tells the focal length from the distance",
            )
        )
    for asked in (_of_residuals, _of_focal_length, _of_parts, _of_lens):
        out += asked(calibration)
    return out


def _of_residuals(calibration: Calibration) -> list[CalibrationFinding]:
    if calibration.excess < _EXCESS:
        return []
    message = (
        f"residuals are {calibration.excess:.1f} times what these pictures' sharpness explains: "
        "the camera moved while its shutter rolled, the paper is bent, or the lens is of another "
        "kind; take stills, held still, of a pad that lies flat"
    )
    return [CalibrationFinding("unexplained", message)]


def _of_focal_length(calibration: Calibration) -> list[CalibrationFinding]:
    share = float(calibration.sigma.matrix[0] / calibration.camera.matrix[0, 0])
    if share < _UNSURE:
        return []
    message = (
        f"the focal length is sure to {100 * share:.2g} %, and heights to no more; add pictures "
        "from aside and with the pad larger"
    )
    return [CalibrationFinding("unsure_focal_length", message)]


def _of_parts(calibration: Calibration) -> list[CalibrationFinding]:
    unseen = (coverage(calibration) < _SEEN) & np.isfinite(calibration.sigma.picture_px)
    share = float(unseen.mean())
    if share <= _UNSEEN_SHARE:
        return []
    message = (
        f"{100 * share:.0f} % of the picture, {_where(unseen)}, never showed the pad; the lens "
        "there is guessed: take pictures with the pad in those parts"
    )
    return [CalibrationFinding("unseen_parts", message)]


def _where(unseen: NDArray[np.bool_]) -> str:
    """The picture's side or corner where most is missing, in words."""
    rows, cols = np.nonzero(unseen)
    up = rows.mean() / (unseen.shape[0] - 1) - 0.5
    left = cols.mean() / (unseen.shape[1] - 1) - 0.5
    words = [word for word, off in (("top", -up), ("bottom", up), ("left", -left), ("right", left))
             if off > 0.15]  # fmt: skip
    return f"most of it at the {' '.join(words)}" if words else "on several sides"


def _of_lens(calibration: Calibration) -> list[CalibrationFinding]:
    camera = calibration.camera
    pixels = grid_pixels(camera)
    folded = ~camera.has_ray(pixels, camera.normalize(pixels))
    if camera.model == "fisheye" or not folded.any():
        return []
    message = (
        f"in {100 * folded.mean():.0f} % of the picture the fitted lens is not one to one; take "
        "pictures with the pad there, or fit the fisheye model"
    )
    return [CalibrationFinding("folded_lens", message)]


def verdicts(calibration: Calibration) -> list[PictureVerdict]:
    """Of each picture whether to take it again."""
    used = calibration.used
    usual_px = float(np.median([view.rms_px for view in used]))
    usual = float(np.median([len(view.residuals_px) for view in used]))
    return [_verdict(view, usual_px, usual) for view in calibration.views]


def _verdict(view: CalibrationView, usual_px: float, usual: float) -> PictureVerdict:
    if view.pose is None:
        detail = view.failure.detail if view.failure else "the pad was not found"
        return PictureVerdict("not_read", f"not read: {detail}")
    if not view.is_used:
        return PictureVerdict(
            "contradicts",
            "left out: it contradicts the others, or shows too little; take it again with camera "
            "and pad at rest, the zoom as in the others, the paper flat",
        )
    if view.rms_px > max(_ROUGH * usual_px, _ROUGH_PX):
        times = view.rms_px / usual_px
        return PictureVerdict(
            "rough",
            f"residuals are {times:.1f} times the usual: it moved, is out of focus, or the paper "
            "was bent; take it again",
        )
    if len(view.residuals_px) < _LITTLE * usual:
        return PictureVerdict("little", "it shows little of the pad; come nearer, or leave it out")
    return PictureVerdict("good")
