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

from padstudio.arrays import Array
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose.least_squares import MotionPrior
from padstudio.vision.pose.noise_kernel import least_share
from padstudio.vision.pose.pattern import alignment_kernel, solver_kernel
from padstudio.vision.pose.pattern.block_kernel import GAIN, SHADE, Brightness, Pixels, Texture
from padstudio.vision.pose.pattern.elimination_kernel import HELD, without_brightness
from padstudio.vision.pose.pattern.solver_kernel import Knowledge, Limits
from padstudio.vision.pose.pattern.template import OVERSAMPLING


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
        inner, pull, shared, change = without_brightness(normal, right.sum(axis=0), size, HELD)
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
        As of `block_kernel.Brightness`.
    scale : (C,) float64
        Likewise.
    rms_px : float
        Root mean square of the last residuals, frame pixels.
    """

    def __init__(self, texture: Texture, channels: int) -> None:
        self.texture = texture
        terms = SHADE + GAIN * len(texture.layers)
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
        found = solver_kernel.brightness_at(pixels, self.texture, pose.state)
        self.brightness, self.scale = found.terms, found.scale

    def settle(
        self, pose: MovingPose, prior: MotionPrior, pixels: Pixels, limits: Limits
    ) -> MovingPose | None:
        """The pose after some steps, or None where the picture leaves it undetermined."""
        start = pose.state, self.shown, self._stretch
        known = Knowledge(prior.weight, prior.expected)
        found = solver_kernel.settle(pixels, self.texture, start, known, limits)
        (self.brightness, self.scale), self._stretch = found.brightness, found.stretch
        self._measure(found.sums, pixels)
        return MovingPose.of(found.pose) if found.solved else None

    def variances(self, pose: MovingPose, pixels: Pixels) -> Array:
        """Of the channels' residuals at a pose, (C,); updates what residuals are trusted."""
        found = alignment_kernel.match_pattern(pixels, self.texture, pose.state, self.shown, 0, 0)
        self.scale = solver_kernel.scales_of(found.residuals)
        return np.maximum(found.sums[:, 0] / found.sums[:, 1], 1e-9)

    def _measure(self, sums: Array, pixels: Pixels) -> None:
        """The root mean square of residuals, by their sums and those of slopes."""
        slopes = sums[:, 3].sum() / (2 * len(pixels.row_time))
        squares = (sums[:, 0] / sums[:, 1]).sum()
        scale = self.texture.place[1] / OVERSAMPLING
        self.rms_px = float(np.sqrt(squares / max(slopes, 1e-9))) * scale
