"""The pose of a far pad, from all its pixels at once.

From far away cells are a few pixels wide or less, and no border stands alone. The known pattern is
then matched as a whole: the picture that the pose predicts is compared with the frame pixel by
pixel, and pose, brightness, shading and the crosstalk of the inks are solved for together.

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
from padstudio.geometry.camera import Camera
from padstudio.geometry.planar_pnp import mirrored
from padstudio.geometry.rolling_shutter import MovingPose, picture_change
from padstudio.pad.spec import Pad
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.pose import alignment_kernel
from padstudio.vision.pose.alignment_kernel import Brightness, Pixels, Texture
from padstudio.vision.pose.covariance import TILES, least_share, pattern_noise
from padstudio.vision.pose.edge_points import Sway
from padstudio.vision.pose.least_squares import Fit, MotionModel, MotionPrior, bounds_of
from padstudio.vision.pose.pose_posterior import Explained, RowsSeen, explain_pattern
from padstudio.vision.pose.row_motion import intervals_over
from padstudio.vision.pose.row_motion_kernel import STATIC, RowSums
from padstudio.vision.pose.template import OVERSAMPLING, on_pad, pixels_of, texture_of

# Steps at the most on a part of the pixels, as far as they serve, then on all. 1250 and 5000 find
# the same stills of the score.
_ROUGH_STEPS, _ROUGH_PIXELS = 5, 2500
_STEPS = 4
# A step that is shorter than so many standard deviations, squared, ends the iteration: the last one
# of a start among others, or before all pixels are taken, whose pose is as far off; and the last.
_ROUGHLY_SETTLED, _NEAR, _SETTLED = 0.5, 8.0, 0.1
# Where residuals are large, plain steps go half of the way; they are lengthened by what the last
# two tell, but by no more than this.
_MOST_STRETCH = 2.5
# As `alignment_kernel.without_brightness` takes it.
_HELD = 1e-9
# By so many pixels the pattern's shape is off at its rim.
_SHAPE_PX = 0.02
# A plane whose halves perspective draws so unlike has one pose alone.
_CLEAR_PX = 1.5
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


class Match:
    """Gauss–Newton for the pose; brightness, shading and crosstalk are solved for along with it.

    Each channel shows every layer, through its own inks and more or less through the others', in
    an even light or one that falls off: value = shading + Σ gain · layer. What is found of that
    for one pose serves the next.

    Parameters
    ----------
    pixels : Pixels
    texture : Texture
    focal_px : float
        Of the camera.
    """

    def __init__(self, pixels: Pixels, texture: Texture, focal_px: float) -> None:
        self._all, self._few = pixels, pixels.thinned(_ROUGH_PIXELS)
        self._texture, self._focal_px = texture, focal_px
        self._scale = np.zeros(len(pixels.values))
        self._brightness: Array | None = None
        self._rms_px = 0.0
        self._compared = False
        self._stretch = 1.0

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
        if self._brightness is None:
            self._find_brightness(begin)
        pose: MovingPose | None = begin
        # A start that all pixels led to is not bettered by a few of them.
        if not self._compared:
            enough = _ROUGHLY_SETTLED if rough else _NEAR
            pose = self._settle(begin, prior, self._few, _ROUGH_STEPS, enough)
        if pose is not None and not rough:
            pose = self._settle(pose, prior, self._all, _STEPS, _SETTLED)
            self._compared = True
        if pose is None:
            return None
        settled, everything = pose, np.ones(len(self._all.row_time), bool)
        assert self._brightness is not None
        found = self._brightness.copy(), self._scale

        def explain() -> Explained:
            # Another fit since then may have led elsewhere.
            self._brightness, self._scale = found[0].copy(), found[1]
            return self._explain(settled, model)

        return Fit(settled, self._rms_px, everything, explain)

    def _find_brightness(self, pose: MovingPose) -> None:
        """Brightness at a pose, as if the pose were right."""
        terms = alignment_kernel.SHADE + alignment_kernel.GAIN * len(self._texture.layers)
        self._brightness = np.zeros((len(self._few.values), terms))
        for _ in range(2):
            for channel, part in enumerate(self._equations(pose, self._few, 0)):
                self._brightness[channel] += part.change

    def _settle(
        self, pose: MovingPose, prior: MotionPrior, pixels: Pixels, steps: int, settled: float
    ) -> MovingPose | None:
        """The pose after some steps, or None where the picture leaves it undetermined."""
        assert self._brightness is not None
        last: Array | None = None
        for _ in range(steps):
            parts = self._equations(pose, pixels, len(prior.weight))
            normal = np.diag(prior.weight) + sum(part.normal * part.share for part in parts)
            right = prior.pull(pose) + sum(part.right for part in parts)
            try:
                step = np.asarray(np.linalg.solve(normal, right), float)
            except np.linalg.LinAlgError:
                return None
            if not np.isfinite(step).all():
                return None
            if last is not None:
                self._stretch = _stretch(self._stretch, float(last @ normal @ step), last, normal)
            last, length = step, float(step @ normal @ step)
            step = self._stretch * step
            pose = pose.moved(step)
            for channel, part in enumerate(parts):
                self._brightness[channel] += part.change / part.share - part.shared @ step
            if length < settled:
                break
        return pose

    def _explain(self, pose: MovingPose, model: MotionModel) -> Explained:
        """The pose at the middle row, and its covariance (6, 6)."""
        parts = self._equations(pose, self._all, 6, TILES * TILES)
        bounds = bounds_of(pose, model, 1.0)
        blur = 0.0 if bounds.at_rest else self._blur_variance(pose)

        def rows_seen(about: MovingPose, sway: Sway | None) -> RowsSeen:
            seen = parts if sway is None else self._shaken_equations(about, sway)
            return RowsSeen(*self._row_sums(about, seen, sway), blur)

        settled, covariance, shaking = explain_pattern(pose, rows_seen, self._focal_px, bounds)
        covariance = covariance + self._shape_doubt(pose)
        other = self._mirrored(pose, MotionPrior.of(pose, model), _noise(parts))
        if other is not None:
            step, share = other
            covariance = covariance + share * np.outer(step, step)
        return Explained(settled, covariance, shaking)

    def _mirrored(
        self, pose: MovingPose, prior: MotionPrior, noise: float
    ) -> tuple[Array, float] | None:
        """The step to the other pose of a small plane, and its share of what may be; few pixels
        tell as well as all that are as unlike each other.

        None where perspective sets the two apart beyond doubt, or the other one is no minimum.
        """
        start = mirrored(pose.pose)
        if self._perspective_px(pose) > _CLEAR_PX or start.position_mm[2] <= 0:
            return None
        assert self._brightness is not None
        saved = self._brightness, self._scale, self._rms_px
        few, steps = self._few, _ROUGH_STEPS
        noise = max(noise * len(few.row_time) / len(self._all.row_time), 1.0)
        self._brightness = saved[0].copy()
        other = self._settle(MovingPose(start), prior, few, steps, _ROUGHLY_SETTLED)
        found = None
        if other is not None and other.pose.position_mm[2] > 0:
            theirs = self._equations(other, few, 0)
            self._brightness, self._scale = saved[0].copy(), saved[1]
            here = self._settle(pose, prior, few, 2, _ROUGHLY_SETTLED) or pose
            mine = self._equations(here, few, 0)
            ratio = sum(np.log(a.variance / b.variance) for a, b in zip(theirs, mine, strict=True))
            worse = len(few.row_time) * ratio / noise / 2
            # The two differ by their perspective alone, which the picture's shape may feign.
            most = (self._perspective_px(pose) / _SHAPE_PX) ** 2 / 2
            worse *= most / (abs(worse) + most + 1e-9)
            share = np.exp(-np.logaddexp(0.0, worse))
            found = pose.step_to(other), float(share)
        self._brightness, self._scale, self._rms_px = saved
        return found

    def _shape_doubt(self, pose: MovingPose) -> Array:
        """What a picture whose shape is off by a share of a pixel at the pad's rim does to a pose.

        From afar tilt is told by the pad's shape alone, which pattern, lens and mosaic leave so
        uncertain.
        """
        place, (_, height, width) = self._texture.place, self._texture.layers.shape
        sides = np.abs([width / place[1], height / place[3]]) / 2
        grid = np.array([[x, y, 0.0] for x in (-1, 0, 1) for y in (-1, 0, 1)])
        points = pose.pose.to_camera(grid * [*sides, 0.0])
        change = self._focal_px * picture_change(points, pose.pose.rotation)
        shape = points[:, :2] - points.mean(axis=0)[:2]
        shape /= np.abs(shape).max()
        bent = np.zeros((9, 2, 4))
        bent[:, 0, :2], bent[:, 1, 2:] = shape, shape
        moved = _SHAPE_PX * np.linalg.lstsq(change.reshape(18, 6), bent.reshape(18, 4))[0]
        return np.asarray(moved @ moved.T)

    def _perspective_px(self, pose: MovingPose) -> float:
        """By how much the pad's far half is drawn smaller than its near half, frame pixels."""
        position = pose.pose.position_mm
        distance = float(np.linalg.norm(position))
        sine = float(np.hypot(*position[:2])) / distance
        half = (self._texture.layers.shape[2] / abs(self._texture.place[1])) / 2
        return float(self._focal_px * (half / distance) ** 2 * sine)

    def _row_sums(
        self, pose: MovingPose, parts: list[_Equations], sway: Sway | None
    ) -> tuple[RowSums, float, float]:
        """Normal equations by intervals of rows, scaled so that their inverse is a covariance;
        linearized where a pose and a shaking put the rows."""
        assert self._brightness is not None
        brightness = Brightness(self._brightness, self._scale)
        first, width, ends = self._intervals()
        count = len(ends) - 1
        normal, pull = np.zeros((3, count, STATIC, STATIC)), np.zeros((2, count, STATIC))
        whole, noise = np.zeros((6, 6)), _noise(parts)
        for k in range(count):
            pixels = self._all.between(ends[k], ends[k + 1])
            start = first + k * width
            seen_from = pose if sway is None else sway.within(pose, start, start + width)
            found = alignment_kernel.match_pattern(
                pixels, self._texture, seen_from.state, brightness, 12, 1
            )
            for c, part in enumerate(parts):
                share = part.share / (part.variance * noise)
                square = found.normal[c, :12, :12]
                square = share * part.share * (square + np.tril(square, -1).T)
                right = share * found.right[c, 0, :12]
                here, once, twice = square[:6, :6], square[:6, 6:], square[6:, 6:]
                whole += here
                normal[0, k, :6, :6] += here
                normal[1, k, :6, :6] += (once - start * here) / width
                normal[2, k, :6, :6] += (twice - 2 * start * once + start**2 * here) / width**2
                pull[0, k, :6] += right[:6]
                pull[1, k, :6] += (right[6:] - start * right[:6]) / width
        # What brightness takes over of a step of the pose, all directions alike.
        left = sum((part.normal * part.share**2 / noise for part in parts), np.zeros((6, 6)))
        kept = float(np.trace(np.linalg.solve(whole, left))) / 6
        sums = RowSums(normal * kept, pull * kept)
        if sway is not None:
            sums = sums.about_rest(sway.at(first + width * np.arange(count + 1.0)))
        return sums, first, width

    def _shaken_equations(self, pose: MovingPose, sway: Sway) -> list[_Equations]:
        """As `_equations`, where a shaking puts the rows; brightness follows.

        Brightness that was found while rows were off their places shows the pattern too faintly.
        """
        assert self._brightness is not None
        (first, width, ends), found = self._intervals(), []
        brightness = Brightness(self._brightness, self._scale)
        for k in range(len(ends) - 1):
            start = first + k * width
            pixels = self._all.between(ends[k], ends[k + 1])
            state = sway.within(pose, start, start + width).state
            found.append(
                alignment_kernel.match_pattern(
                    pixels, self._texture, state, brightness, 6, TILES * TILES
                )
            )
        self._scale = _scales(np.hstack([part.residuals for part in found]))
        normal = np.sum([part.normal for part in found], axis=0)
        right = np.sum([part.right for part in found], axis=0)
        sums = np.sum([part.sums for part in found], axis=0)
        parts = [_Equations.of(*part, 6) for part in zip(normal, right, sums, strict=True)]
        self._brightness = self._brightness + np.stack([part.change for part in parts])
        return parts

    def _intervals(self) -> tuple[float, float, NDArray[np.intp]]:
        """As of `intervals_over`, and the first pixel of each interval, and of none."""
        time = self._all.row_time
        first, width, count = intervals_over(float(time[0]), float(time[-1]))
        return first, width, np.searchsorted(time, first + width * np.arange(count + 1))

    def _blur_variance(self, pose: MovingPose) -> float:
        """By how much the picture is blurrier than the pattern, frame pixels squared."""
        assert self._brightness is not None
        few, place, layers = self._few, self._texture.place, self._texture.layers
        x, y = np.moveaxis(on_pad(pose.pose, few.rays), -1, 0)
        height, width = layers.shape[1:]
        column = np.clip(np.round(place[0] + place[1] * x).astype(np.intp), 1, width - 2)
        row = np.clip(np.round(place[2] + place[3] * y).astype(np.intp), 1, height - 2)
        around = layers[:, row - 1, column] + layers[:, row + 1, column]
        around += layers[:, row, column - 1] + layers[:, row, column + 1]
        bend = (around - 4 * layers[:, row, column]) * (OVERSAMPLING**2 / 2)
        residuals = alignment_kernel.match_pattern(
            few, self._texture, pose.state, Brightness(self._brightness, self._scale), 0, 1
        ).residuals
        across = along = 0.0
        for c, terms in enumerate(self._brightness):
            gains = terms[alignment_kernel.SHADE :: alignment_kernel.GAIN][: len(layers)]
            change = gains @ bend
            along += float(change @ residuals[c])
            across += float(change @ change)
        return along / max(across, 1e-9)

    def _equations(
        self, pose: MovingPose, pixels: Pixels, size: int, tiles: int = 1
    ) -> list[_Equations]:
        """Each channel's equations at a pose; updates what residuals are trusted, and the rms."""
        assert self._brightness is not None
        texture, brightness = self._texture, Brightness(self._brightness, self._scale)
        normal, right, sums, residuals = alignment_kernel.match_pattern(
            pixels, texture, pose.state, brightness, size, tiles
        )
        self._scale = _scales(residuals)
        slopes = sums[:, 3].sum() / (2 * len(pixels.row_time))
        squares = (sums[:, 0] / sums[:, 1]).sum()
        self._rms_px = float(np.sqrt(squares / max(slopes, 1e-9))) * texture.place[1] / OVERSAMPLING
        return [_Equations.of(*part, size) for part in zip(normal, right, sums, strict=True)]


def _noise(parts: list[_Equations]) -> float:
    """Scatter of scores over that of pixels as independent as they are many."""
    normal = sum((part.normal for part in parts), np.zeros((6, 6)))
    scores = sum((part.scores for part in parts), np.zeros((TILES * TILES, 6)))
    return pattern_noise(normal, scores)


def _stretch(before: float, common: float, last: Array, normal: Array) -> float:
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


def _scales(residuals: NDArray[np.float32]) -> Array:
    """Beyond which residuals (C, N) are trusted little: robust standard deviations, (C,)."""
    size = np.abs(residuals)
    middle = size.shape[1] // 2
    median = np.partition(size, middle, axis=1)[:, middle].astype(float)
    return _TRUSTED * np.maximum(1.4826 * median, _LEAST_SCALE)
