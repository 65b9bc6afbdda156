"""The pose of a far pad, from all its pixels at once.

From far away cells are a few pixels wide or less, and no border stands alone. The known pattern is
then matched as a whole: the picture that the pose predicts is compared with the frame pixel by
pixel, and pose, brightness, shading and the crosstalk of the inks are solved for together.

References
----------
Lucas, B. D. and Kanade, T. (1981). An iterative image registration technique with an application
to stereo vision.
"""

from __future__ import annotations

import numpy as np

from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Pad
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.pose.least_squares import Fit, MotionModel, MotionPrior
from padstudio.vision.pose.pattern.block_kernel import Pixels, Texture
from padstudio.vision.pose.pattern.posterior import PatternPosterior
from padstudio.vision.pose.pattern.solver import PatternSolver
from padstudio.vision.pose.pattern.solver_kernel import Limits
from padstudio.vision.pose.pattern.template import pixels_of, texture_of
from padstudio.vision.pose.pose_posterior import Explained

# Steps are taken on a part of the pixels, as far as they serve, then on all. 1250 and 5000 find the
# same stills of the score.
_ROUGH_PIXELS = 2500
# The last step of a start among others, or before all pixels are taken, whose pose is as far off;
# and the last.
_ROUGHLY, _NEAR, _SETTLED = Limits(5, 0.5), Limits(5, 8.0), Limits(4, 0.1)


class Match:
    """A pad's pattern and the pixels that show it: the pose at which they agree.

    Parameters
    ----------
    pixels : Pixels
    texture : Texture
    focal_px : float
        Of the camera.
    """

    def __init__(self, pixels: Pixels, texture: Texture, focal_px: float) -> None:
        self._all, self._few = pixels, pixels.thinned(_ROUGH_PIXELS)
        self._focal_px = focal_px
        self._solver = PatternSolver(texture, len(pixels.values))
        self._has_brightness = self._compared = False

    @classmethod
    def of(
        cls, pyramid: Pyramid, camera: Camera, pad: Pad, start: MovingPose, most: int
    ) -> Match | None:
        """The match of a pad with a frame near a pose; None where too few pixels show the pad."""
        pixels = pixels_of(pyramid, camera, pad, start, most)
        if pixels is None:
            return None
        texture = texture_of(pad, camera.focal_px / float(start.pose.position_mm[2]))
        return cls(pixels, texture, camera.focal_px)

    def fit(self, start: MovingPose, model: MotionModel, *, rough: bool = False) -> Fit | None:
        """The pose that matches best.

        Parameters
        ----------
        start : MovingPose
            Right to about a pixel.
        model : MotionModel
        rough : bool
            A part of the pixels must do: enough to tell one start from another.

        Returns
        -------
        Fit or None
            None where the picture leaves the pose undetermined.
        """
        prior = MotionPrior.of(start, model)
        begin = start if model.moving else MovingPose(start.pose)
        solver = self._solver
        if not self._has_brightness:
            solver.find_brightness(begin, self._few)
            self._has_brightness = True
        pose: MovingPose | None = begin
        # A start that all pixels led to is not bettered by a few of them.
        if not self._compared:
            pose = solver.settle(begin, prior, self._few, _ROUGHLY if rough else _NEAR)
        if pose is not None and not rough:
            pose = solver.settle(pose, prior, self._all, _SETTLED)
            self._compared = True
        if pose is None:
            return None
        settled, everything = pose, np.ones(len(self._all.row_time), bool)
        found = solver.brightness.copy(), solver.scale

        def explain() -> Explained:
            # Another fit since then may have led elsewhere.
            solver.brightness, solver.scale = found[0].copy(), found[1]
            posterior = PatternPosterior(solver, self._all, self._few, self._focal_px)
            return posterior.explain(settled, model)

        return Fit(settled, solver.rms_px, everything, explain)
