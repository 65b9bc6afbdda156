"""What a calibration gives: a camera, how sure it is, and what each picture added."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from padstudio.arrays import Array
from padstudio.calibration.certainty import LensSigma, excess
from padstudio.calibration.patches import Patches
from padstudio.calibration.solve import rms_px
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.vision.stage.trace import StageFailure


@dataclass(frozen=True, eq=False)
class CalibrationView:
    """What one picture adds.

    Attributes
    ----------
    pose : Pose or None
        None where the pad was not found, or too little of it.
    failure : StageFailure or None
        Why the pad was not found.
    patches : Patches or None
        Those that count.
    residuals_px : (N, 2) float64
        Of the patches: where they are less where the camera puts them.
    is_used : bool
        False also where the picture contradicts the others.
    """

    pose: Pose | None
    failure: StageFailure | None = None
    patches: Patches | None = None
    residuals_px: Array = field(default_factory=lambda: np.zeros((0, 2)))
    is_used: bool = False

    @property
    def rms_px(self) -> float:
        """Root mean square of the residuals' lengths; 0 without patches."""
        return rms_px(self.residuals_px) if len(self.residuals_px) else 0.0


@dataclass(frozen=True, eq=False)
class Calibration:
    """A camera from pictures.

    Attributes
    ----------
    camera : Camera
    sigma : LensSigma
    views : list of CalibrationView
        One for each picture.
    """

    camera: Camera
    sigma: LensSigma
    views: list[CalibrationView]

    @property
    def used(self) -> list[CalibrationView]:
        """Those that the camera rests on."""
        return [view for view in self.views if view.is_used]

    @property
    def rms_px(self) -> float:
        """Root mean square of the residuals' lengths of all pictures that count."""
        return rms_px(np.concatenate([view.residuals_px for view in self.used]))

    @property
    def excess(self) -> float:
        """Residuals over what the pictures' own scatter explains; about 1 for a good one."""
        told = [(view.patches, view.residuals_px) for view in self.used if view.patches is not None]
        return excess([patches for patches, _ in told], [residuals for _, residuals in told])
