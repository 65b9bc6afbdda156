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

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.covariance import newton_share, sums_by_tile
from padstudio.vision.motion import KnownMotion, MovingPose
from padstudio.vision.pattern import (
    OVERSAMPLING,
    Pixels,
    Texture,
    by_pose,
    look_up,
    on_pad,
    pixels_of,
    texture_of,
)
from padstudio.vision.planes import Pyramid
from padstudio.vision.refine import Fit, MotionPrior
from padstudio.vision.types import Array

_ITERATIONS = 6
# A step that moves the picture by less ends the iteration.
_SETTLED_PX = 5e-3


def align(
    pyramid: Pyramid,
    camera: Camera,
    pad: Pad,
    start: MovingPose,
    *,
    motion: bool,
    known: KnownMotion | None = None,
    rolling: bool = True,
) -> Fit | None:
    """Match the whole pad to the frame.

    Parameters
    ----------
    pyramid : Pyramid
    camera : Camera
        At the frame's size.
    pad : Pad
    start : MovingPose
        Right to about a pixel.
    motion : bool
        Let the pose change within the frame.
    known : KnownMotion or None
        What the change within the frame should be near to.
    rolling : bool
        The shutter may roll, so that an unseen change of height enters the covariance.

    Returns
    -------
    Fit or None
        None where too few pixels show the pad, or the picture leaves the pose undetermined.
    """
    pixels = pixels_of(pyramid, camera, pad, start)
    if pixels is None:
        return None
    texture = texture_of(pad, camera.focal_px / float(start.pose.position_mm[2]))
    match = _Match(pixels, texture, MotionPrior.of(start, known, 12 if motion else 6))
    pose = start if motion else MovingPose(start.pose)
    for _ in range(_ITERATIONS):
        step = match.step(pose)
        if step is None:
            return None
        pose = pose.moved(step)
        if np.abs(step[3:6]).max() * camera.focal_px < _SETTLED_PX and (
            np.abs(step[:3]).max() * camera.focal_px < _SETTLED_PX * pose.pose.position_mm[2]
        ):
            break
    everything = np.ones(len(pixels.moment), bool)
    return Fit(pose, match.rms_px, everything, lambda: match.covariance(pose, rolling=rolling))


@dataclass(frozen=True, eq=False)
class _Channel:
    """One channel's part of the normal equations of the pose, brightness solved for.

    Attributes
    ----------
    normal : (K, K) float64
    right : (K,) float64
    variance : float
        Of the residuals.
    share : float
        As of `padstudio.vision.covariance.newton_share`.
    steepness : float
        Mean squared slope of the brightness along one axis, per mm.
    jacobian, linear : (N, K) and (N, L)
        Change of the values with the pose, and with the brightness.
    shared : (L, K) float64
        What of the former the latter can take over.
    pull : (N,) float32
        Residuals over their variance, as far as they are trusted.
    """

    normal: Array
    right: Array
    variance: float
    share: float
    steepness: float
    jacobian: Array
    linear: NDArray[np.float32]
    shared: Array
    pull: NDArray[np.float32]

    @classmethod
    def of(
        cls,
        jacobian: Array,
        linear: NDArray[np.float32],
        residual: NDArray[np.float32],
        weight: NDArray[np.float32],
        steepness: float,
    ) -> _Channel:
        """The Schur complement of the brightness terms."""
        size = jacobian.shape[1]
        both = np.column_stack([jacobian, linear])
        moment = ((both * weight[:, None]).T @ np.column_stack([both, residual])).astype(float)
        a, b, right = moment[:size, :size], moment[:size, size:-1], moment[:size, -1]
        c, rest = moment[size:, size:-1], moment[size:, -1]
        solved = np.linalg.lstsq(c, np.column_stack([b.T, rest]), rcond=None)[0]
        variance = float((weight * residual**2).sum() / weight.sum())
        return cls(
            normal=(a - b @ solved[:, :-1]) / variance,
            right=(right - b @ solved[:, -1]) / variance,
            variance=variance,
            share=newton_share(weight.astype(float)),
            steepness=steepness,
            jacobian=jacobian,
            linear=linear,
            shared=solved[:, :-1],
            pull=weight * residual / np.float32(variance),
        )

    def gradients(self) -> Array:
        """(N, K) float64, each pixel's part of the right side."""
        return (self.jacobian - self.linear @ self.shared) * self.pull[:, None]


class _Match:
    """Gauss–Newton for the pose; brightness, shading and crosstalk are solved for along with it.

    Each channel shows every layer, through its own inks and more or less through the others', in
    an even light or one that falls off: value = shading + Σ gain · layer.
    """

    def __init__(self, pixels: Pixels, texture: Texture, prior: MotionPrior) -> None:
        self._pixels = pixels
        self._texture = texture
        self._prior = prior
        self._brightness: dict[Channel, Array] = {}
        self.rms_px = 0.0

    def step(self, pose: MovingPose) -> Array | None:
        """The step of the pose, or None where the picture leaves it undetermined."""
        size = len(self._prior.weight)
        parts = list(self._channels(pose, size))
        normal = np.diag(self._prior.weight) + sum(part.normal for part in parts)
        try:
            step = np.linalg.solve(normal, self._prior.pull(pose) + sum(p.right for p in parts))
        except np.linalg.LinAlgError:
            return None
        px_mm = self._texture.mm[0] * OVERSAMPLING
        squares, slopes = sum(p.variance for p in parts), sum(p.steepness for p in parts)
        self.rms_px = float(np.sqrt(squares / max(slopes, 1e-9))) / px_mm
        return np.asarray(step, float) if np.isfinite(step).all() else None

    def covariance(self, pose: MovingPose, *, rolling: bool) -> Array:
        """Covariance (6, 6) of a solution."""
        size = len(self._prior.weight)
        parts = list(self._channels(pose, 12))
        normal = sum((part.normal * part.share for part in parts), np.zeros((12, 12)))
        gradients = sum((part.gradients()[:, :size] for part in parts), np.zeros(()))
        scores = sums_by_tile(gradients, self._pixels.tile)
        return self._prior.covariance(normal, scores, rolling=rolling)

    def _channels(self, pose: MovingPose, size: int) -> Iterator[_Channel]:
        pixels = self._pixels
        points, direction = on_pad(pose, pixels.rays, pixels.moment)
        moved = by_pose(pose, pixels.rays, direction)
        if size == 12:
            moved = np.concatenate([moved, moved * pixels.moment[:, None, None]], axis=2)
        shown = [look_up(self._texture, layer, points) for layer in self._texture.layers]
        gains = [value[:, None] * pixels.shade[:, :3] for value, _ in shown]
        linear = np.column_stack([pixels.shade, *gains]).astype(np.float32)
        for channel, values in pixels.values.items():
            residual, weight = self._residual(channel, linear, values)
            slope = self._slope(channel, [d for _, d in shown])
            jacobian = slope[:, :1] * moved[:, 0] + slope[:, 1:] * moved[:, 1]
            steepness = float((slope**2).sum(axis=1).mean()) / 2
            yield _Channel.of(jacobian, linear, residual, weight, steepness)

    def _residual(
        self, channel: Channel, linear: NDArray[np.float32], values: Array
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """What brightness leaves over at the present pose, and how far each pixel is trusted."""
        known = self._brightness.get(channel)
        weight = np.ones(len(values), np.float32)
        for _ in range(3 if known is None else 1):
            if known is not None:
                weight = _trust(values - linear @ known)
            weighted = linear * weight[:, None]
            known = np.linalg.lstsq(
                (weighted.T @ linear).astype(float), (weighted.T @ values).astype(float), rcond=None
            )[0]
        assert known is not None
        self._brightness[channel] = known
        return (values - linear @ known).astype(np.float32), weight

    def _slope(self, channel: Channel, slopes: list[Array]) -> NDArray[np.float32]:
        """Change of a channel's brightness per mm of X and Y, (N, 2)."""
        known, shade = self._brightness[channel], self._pixels.shade[:, :3]
        parts = [
            (shade @ known[6 + 3 * k : 9 + 3 * k])[:, None] * slope
            for k, slope in enumerate(slopes)
        ]
        return np.asarray(sum(parts), np.float32)


def _trust(residual: Array) -> NDArray[np.float32]:
    scale = max(1.4826 * float(np.median(np.abs(residual))), 0.3)
    return (1 / (1 + (residual / (3 * scale)) ** 2) ** 2).astype(np.float32)
