"""Gauss–Newton on a pattern's pixels: pose, brightness, shading and crosstalk together.

References
----------
Lucas, B. D. and Kanade, T. (1981). An iterative image registration technique with an application
to stereo vision. Baker, S. and Matthews, I. (2004). Lucas–Kanade 20 years on: a unifying framework.
doi:10.1023/B:VISI.0000011205.11775.fd. Barzilai, J. and Borwein, J. M. (1988). Two-point step size
gradient methods. doi:10.1093/imanum/8.1.141
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose.noise_kernel import least_share
from padstudio.vision.pose.least_squares import MotionPrior
from padstudio.vision.pose.pattern import alignment_kernel
from padstudio.vision.pose.pattern.alignment_kernel import Brightness, Pixels, Texture
from padstudio.vision.pose.pattern.template import OVERSAMPLING

# Where residuals are large, plain steps go half of the way; they are lengthened by what the last
# two tell, but by no more than this.
_MOST_STRETCH = 2.5
# As `alignment_kernel.without_brightness` takes it.
_HELD = 1e-9
# Residuals beyond so many standard deviations, and grey values, are trusted little.
_TRUSTED, _LEAST_SCALE = 3.0, 0.3


@dataclass(frozen=True, eq=False)
class Equations:
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
    def of(cls, normal: Array, right: Array, sums: Array, size: int) -> Equations:
        """The Schur complement of the brightness terms."""
        squares, weights, steepness, _ = sums
        variance = max(squares / weights, 1e-9)
        inner, pull, shared, change = alignment_kernel.without_brightness(
            normal, right.sum(axis=0), size, _HELD
        )
        return cls(
            normal=inner / variance,
            right=pull / variance,
            scores=(right[:, :size] - right[:, size:] @ shared) / variance,
            shared=shared,
            change=change,
            variance=variance,
            share=least_share(steepness / weights),
        )


class PatternSolver:
    """Steps toward the pose at which a pattern shows what the pixels do.

    Each channel shows every layer, through its own inks and more or less through the others', in
    an even light or one that falls off: value = shading + Σ gain · layer. What is found of that
    for one pose serves the next.

    Parameters
    ----------
    texture : Texture
    channels : int

    Attributes
    ----------
    brightness : (C, 6 + 3 L) float64
        As of `alignment_kernel.Brightness`.
    scale : (C,) float64
        Likewise.
    rms_px : float
        Root mean square of the last residuals, frame pixels.
    """

    def __init__(self, texture: Texture, channels: int) -> None:
        self.texture = texture
        terms = alignment_kernel.SHADE + alignment_kernel.GAIN * len(texture.layers)
        self.brightness = np.zeros((channels, terms))
        self.scale = np.zeros(channels)
        self.rms_px = 0.0
        self._stretch = 1.0

    @property
    def shown(self) -> Brightness:
        """As compiled loops take it."""
        return Brightness(self.brightness, self.scale)

    def find_brightness(self, pose: MovingPose, pixels: Pixels) -> None:
        """Brightness at a pose, as if the pose were right."""
        self.brightness[:] = 0.0
        for _ in range(2):
            for channel, part in enumerate(self.equations(pose, pixels, 0)):
                self.brightness[channel] += part.change

    def settle(
        self, pose: MovingPose, prior: MotionPrior, pixels: Pixels, steps: int, settled: float
    ) -> MovingPose | None:
        """The pose after some steps, or None where the picture leaves it undetermined."""
        last: Array | None = None
        for _ in range(steps):
            parts = self.equations(pose, pixels, len(prior.weight))
            normal = np.diag(prior.weight) + sum(part.normal * part.share for part in parts)
            right = prior.pull(pose) + sum(part.right for part in parts)
            try:
                step = np.asarray(np.linalg.solve(normal, right), float)
            except np.linalg.LinAlgError:
                return None
            if not np.isfinite(step).all():
                return None
            if last is not None:
                self._stretch = stretched(self._stretch, float(last @ normal @ step), last, normal)
            last, length = step, float(step @ normal @ step)
            step = self._stretch * step
            pose = pose.moved(step)
            for channel, part in enumerate(parts):
                self.brightness[channel] += part.change / part.share - part.shared @ step
            if length < settled:
                break
        return pose

    def equations(
        self, pose: MovingPose, pixels: Pixels, size: int, tiles: int = 1
    ) -> list[Equations]:
        """Each channel's equations at a pose; updates what residuals are trusted, and the rms."""
        texture = self.texture
        normal, right, sums, residuals = alignment_kernel.match_pattern(
            pixels, texture, pose.state, self.shown, size, tiles
        )
        self.scale = scales_of(residuals)
        slopes = sums[:, 3].sum() / (2 * len(pixels.row_time))
        squares = (sums[:, 0] / sums[:, 1]).sum()
        self.rms_px = float(np.sqrt(squares / max(slopes, 1e-9))) * texture.place[1] / OVERSAMPLING
        return [Equations.of(*part, size) for part in zip(normal, right, sums, strict=True)]


def stretched(before: float, common: float, last: Array, normal: Array) -> float:
    """By how much to lengthen a step, of what the step before it, so lengthened, left to do.

    Parameters
    ----------
    before : float
        By how much the last step was lengthened.
    common : float
        Product of the last step, not lengthened, and this one, in the metric of ``normal``.
    last : (K,) float64
    normal : (K, K) float64
    """
    square = float(last @ normal @ last)
    done = max(square - common, 1e-9 * square)
    return min(max(before * square / done, 1.0), _MOST_STRETCH) if square > 0 else 1.0


def scales_of(residuals: NDArray[np.float32]) -> Array:
    """Beyond which residuals (C, N) are trusted little: robust standard deviations, (C,)."""
    size = np.abs(residuals)
    middle = size.shape[1] // 2
    median = np.partition(size, middle, axis=1)[:, middle].astype(float)
    return _TRUSTED * np.maximum(1.4826 * median, _LEAST_SCALE)
