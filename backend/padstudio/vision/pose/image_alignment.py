"""The pose of a far pad, from all its pixels at once.

From far away cells are a few pixels wide or less, and no border stands alone. The known pattern is
then matched as a whole: the picture that the pose predicts is compared with the frame pixel by
pixel, and pose, brightness, shading and the crosstalk of the inks are solved for together.

References
----------
Lucas, B. D. and Kanade, T. (1981). An iterative image registration technique with an application
to stereo vision. Baker, S. and Matthews, I. (2004). Lucas–Kanade 20 years on: a unifying framework.
doi:10.1023/B:VISI.0000011205.11775.fd
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Pad
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.pose import alignment_kernel
from padstudio.vision.pose.alignment_kernel import Brightness, Pixels, Texture
from padstudio.vision.pose.covariance import TILES, least_share
from padstudio.vision.pose.least_squares import Fit, MotionModel, MotionPrior
from padstudio.vision.pose.template import OVERSAMPLING, pixels_of, texture_of

# Steps at the most on a part of the pixels, as far as they serve, then on all. 1250 and 5000 find
# the same stills of the score.
_ROUGH_STEPS, _ROUGH_PIXELS = 5, 2500
_STEPS = 4
# A step that is shorter than so many standard deviations, squared, ends the iteration.
_ROUGHLY_SETTLED, _SETTLED = 0.5, 0.05
# Brightness terms are held to what they are by this share of what the picture says of them, so that
# those it says nothing of can be solved for.
_HELD = 1e-9
# Residuals beyond so many standard deviations, and grey values, are trusted little.
_TRUSTED, _LEAST_SCALE = 3.0, 0.3


@dataclass(frozen=True, eq=False)
class _Equations:
    """One channel's part of the normal equations of the pose, brightness eliminated.

    Attributes
    ----------
    normal : (K, K) float64
    right : (K,) float64
    scores : (T, K) float64
        The right side's parts, by tile.
    shared : (L, K) float64
        What of a step of the pose brightness takes over.
    change : (L,) float64
        Of brightness, while the pose stays.
    variance : float
        Of the residuals.
    share : float
        As of `padstudio.vision.pose.covariance.newton_share`.
    """

    normal: Array
    right: Array
    scores: Array
    shared: Array
    change: Array
    variance: float
    share: float

    @classmethod
    def of(cls, normal: Array, right: Array, sums: Array, size: int) -> _Equations:
        """The Schur complement of the brightness terms."""
        normal = normal + np.tril(normal, -1).T
        squares, weights, steepness, _ = sums
        variance = max(squares / weights, 1e-9)
        across, total = normal[:size, size:], right.sum(axis=0)
        # Terms that the picture does not show, as of a layer out of view, stay as they are.
        inner = normal[size:, size:]
        held = inner + np.diag(np.maximum(_HELD * np.diag(inner), 1e-9))
        solved = np.linalg.solve(held, np.column_stack([across.T, total[size:]]))
        shared, change = solved[:, :-1], solved[:, -1]
        return cls(
            normal=(normal[:size, :size] - across @ shared) / variance,
            right=(total[:size] - across @ change) / variance,
            scores=(right[:, :size] - right[:, size:] @ shared) / variance,
            shared=shared,
            change=change,
            variance=variance,
            share=least_share(steepness / weights),
        )


class Match:
    """Gauss–Newton for the pose; brightness, shading and crosstalk are solved for along with it.

    Each channel shows every layer, through its own inks and more or less through the others', in
    an even light or one that falls off: value = shading + Σ gain · layer. What is found of that
    for one pose serves the next.

    Parameters
    ----------
    pixels : Pixels
    texture : Texture
    """

    def __init__(self, pixels: Pixels, texture: Texture) -> None:
        self._all, self._few = pixels, pixels.thinned(_ROUGH_PIXELS)
        self._texture = texture
        self._scale = np.zeros(len(pixels.values))
        self._brightness: Array | None = None
        self._rms_px = 0.0
        self._compared = False

    @classmethod
    def of(
        cls, pyramid: Pyramid, camera: Camera, pad: Pad, start: MovingPose, most: int
    ) -> Match | None:
        """The match of a pad with a frame near a pose; None where too few pixels show the pad."""
        pixels = pixels_of(pyramid, camera, pad, start, most)
        if pixels is None:
            return None
        texture = texture_of(pad, camera.focal_px / float(start.pose.position_mm[2]))
        return cls(pixels, texture)

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
        if self._brightness is None:
            self._find_brightness(begin)
        pose: MovingPose | None = begin
        # A start that all pixels led to is not bettered by a few of them.
        if not self._compared:
            pose = self._settle(begin, prior, self._few, _ROUGH_STEPS, _ROUGHLY_SETTLED)
        if pose is not None and not rough:
            pose = self._settle(pose, prior, self._all, _STEPS, _SETTLED)
            self._compared = True
        if pose is None:
            return None
        settled, everything = pose, np.ones(len(self._all.row_time), bool)

        def explain() -> tuple[MovingPose, Array]:
            return settled, self._covariance(settled, prior)

        return Fit(settled, self._rms_px, everything, explain)

    def _find_brightness(self, pose: MovingPose) -> None:
        """Brightness at a pose, as if the pose were right."""
        terms = alignment_kernel.SHADE + alignment_kernel.GAIN * len(self._texture.layers)
        self._brightness = np.zeros((len(self._few.values), terms))
        for _ in range(3):
            for channel, part in enumerate(self._equations(pose, self._few, 0)):
                self._brightness[channel] += part.change

    def _settle(
        self, pose: MovingPose, prior: MotionPrior, pixels: Pixels, steps: int, settled: float
    ) -> MovingPose | None:
        """The pose after some steps, or None where the picture leaves it undetermined."""
        assert self._brightness is not None
        for _ in range(steps):
            parts = self._equations(pose, pixels, len(prior.weight))
            normal = np.diag(prior.weight) + sum(part.normal * part.share for part in parts)
            right = prior.pull(pose) + sum(part.right for part in parts)
            try:
                step = np.linalg.solve(normal, right)
            except np.linalg.LinAlgError:
                return None
            if not np.isfinite(step).all():
                return None
            pose = pose.moved(np.asarray(step, float))
            for channel, part in enumerate(parts):
                self._brightness[channel] += part.change / part.share - part.shared @ step
            if step @ normal @ step < settled:
                break
        return pose

    def _covariance(self, pose: MovingPose, prior: MotionPrior) -> Array:
        """Covariance (6, 6) of a solution."""
        parts = self._equations(pose, self._all, 12)
        normal = sum((part.normal * part.share for part in parts), np.zeros((12, 12)))
        size = len(prior.weight)
        scores = sum((part.scores[:, :size] for part in parts), np.zeros((TILES * TILES, size)))
        return prior.covariance(normal, scores)

    def _equations(self, pose: MovingPose, pixels: Pixels, size: int) -> list[_Equations]:
        """Each channel's equations at a pose; updates what residuals are trusted, and the rms."""
        assert self._brightness is not None
        texture, brightness = self._texture, Brightness(self._brightness, self._scale)
        normal, right, sums, residuals = alignment_kernel.match_pattern(
            pixels, texture, pose.state, brightness, size, TILES * TILES
        )
        self._scale = _scales(residuals)
        slopes = sums[:, 3].sum() / (2 * len(pixels.row_time))
        squares = (sums[:, 0] / sums[:, 1]).sum()
        self._rms_px = float(np.sqrt(squares / max(slopes, 1e-9))) * texture.place[1] / OVERSAMPLING
        return [_Equations.of(*part, size) for part in zip(normal, right, sums, strict=True)]


def _scales(residuals: NDArray[np.float32]) -> Array:
    """Beyond which residuals (C, N) are trusted little: robust standard deviations, (C,)."""
    size = np.abs(residuals)
    middle = size.shape[1] // 2
    median = np.partition(size, middle, axis=1)[:, middle].astype(float)
    return _TRUSTED * np.maximum(1.4826 * median, _LEAST_SCALE)
