"""How sure a pose is that a pattern was matched with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.planar_pnp import mirrored
from padstudio.geometry.rolling_shutter import MovingPose, picture_change
from padstudio.vision.pose.noise_kernel import TILES, pattern_noise
from padstudio.vision.pose.edge_points import Sway
from padstudio.vision.pose.least_squares import MotionModel, MotionPrior, bounds_of
from padstudio.vision.pose.pattern import alignment_kernel
from padstudio.vision.pose.pattern.alignment_kernel import Pixels
from padstudio.vision.pose.pattern.solver import Equations, PatternSolver, scales_of
from padstudio.vision.pose.pattern.template import OVERSAMPLING, on_pad
from padstudio.vision.pose.pose_posterior import Explained, RowsSeen, explain_pattern
from padstudio.vision.pose.drift_kernel import Rows
from padstudio.vision.pose.row_motion_kernel import STATIC, RowSums, intervals_over

# The other pose of a plane is looked for in so many steps, a step that is shorter than so many
# standard deviations, squared, being the last.
_ROUGH_STEPS, _ROUGHLY_SETTLED = 5, 0.5
# By so many pixels the pattern's shape is off at its rim.
_SHAPE_PX = 0.02
# A plane whose halves perspective draws so unlike has one pose alone.
_CLEAR_PX = 1.5
# Below the diagonal of the equations of a pose and its change.
_BELOW = np.tri(12, k=-1)


class PatternPosterior:
    """The covariance of a pose, from the rows of the picture that show the pattern.

    Parameters
    ----------
    solver : PatternSolver
        With the brightness that goes with the pose.
    pixels, few : Pixels
        All of them, and those that tell one pose from another.
    focal_px : float
        Of the camera.
    """

    def __init__(self, solver: PatternSolver, pixels: Pixels, few: Pixels, focal_px: float) -> None:
        self._solver, self._texture = solver, solver.texture
        self._all, self._few, self._focal_px = pixels, few, focal_px

    def explain(self, pose: MovingPose, model: MotionModel) -> Explained:
        """The pose at the middle row, and its covariance (6, 6)."""
        parts = self._solver.equations(pose, self._all, 6, TILES * TILES)
        bounds = bounds_of(pose, model, 1.0)
        blur = 0.0 if bounds.at_rest else self._blur_variance(pose)

        def rows_seen(about: MovingPose, sway: Sway | None) -> RowsSeen:
            seen = parts if sway is None else self._shaken_equations(about, sway)
            return RowsSeen(Rows(*self._row_sums(about, seen, sway)), blur)

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
        solver = self._solver
        saved = solver.brightness, solver.scale, solver.rms_px
        few, steps = self._few, _ROUGH_STEPS
        noise = max(noise * len(few.row_time) / len(self._all.row_time), 1.0)
        solver.brightness = saved[0].copy()
        other = solver.settle(MovingPose(start), prior, few, steps, _ROUGHLY_SETTLED)
        found = None
        if other is not None and other.pose.position_mm[2] > 0:
            theirs = solver.equations(other, few, 0)
            solver.brightness, solver.scale = saved[0].copy(), saved[1]
            here = solver.settle(pose, prior, few, 2, _ROUGHLY_SETTLED) or pose
            mine = solver.equations(here, few, 0)
            ratio = sum(np.log(a.variance / b.variance) for a, b in zip(theirs, mine, strict=True))
            worse = len(few.row_time) * ratio / noise / 2
            # The two differ by their perspective alone, which the picture's shape may feign.
            most = (self._perspective_px(pose) / _SHAPE_PX) ** 2 / 2
            worse *= most / (abs(worse) + most + 1e-9)
            share = np.exp(-np.logaddexp(0.0, worse))
            found = pose.step_to(other), float(share)
        solver.brightness, solver.scale, solver.rms_px = saved
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
        self, pose: MovingPose, parts: list[Equations], sway: Sway | None
    ) -> tuple[RowSums, float, float]:
        """Normal equations by intervals of rows, scaled so that their inverse is a covariance;
        linearized where a pose and a shaking put the rows."""
        brightness = self._solver.shown
        first, width, ends = self._intervals()
        starts = first + width * np.arange(len(ends) - 1.0)
        shares = np.array([part.share for part in parts])
        trust = shares / (np.array([part.variance for part in parts]) * (noise := _noise(parts)))
        lower, right = np.zeros((len(starts), 12, 12)), np.zeros((len(starts), 12))
        for k, start in enumerate(starts):
            pixels = self._all.between(ends[k], ends[k + 1])
            seen_from = pose if sway is None else sway.within(pose, start, start + width)
            found = alignment_kernel.match_pattern(
                pixels, self._texture, seen_from.state, brightness, 12, 1
            )
            square = found.normal[:, :12, :12].reshape(len(parts), 144)
            lower[k] = ((trust * shares) @ square).reshape(12, 12)
            right[k] = trust @ found.right[:, 0, :12]
        square = lower + (lower * _BELOW).transpose(0, 2, 1)
        here, once, twice = square[:, :6, :6], square[:, :6, 6:], square[:, 6:, 6:]
        at = starts[:, None, None]
        normal, pull = (
            np.zeros((3, len(starts), STATIC, STATIC)),
            np.zeros((2, len(starts), STATIC)),
        )
        normal[0, :, :6, :6] = here
        normal[1, :, :6, :6] = (once - at * here) / width
        normal[2, :, :6, :6] = (twice - 2 * at * once + at**2 * here) / width**2
        pull[0, :, :6] = right[:, :6]
        pull[1, :, :6] = (right[:, 6:] - starts[:, None] * right[:, :6]) / width
        whole = here.sum(axis=0)
        # What brightness takes over of a step of the pose, all directions alike.
        left = sum((part.normal * part.share**2 / noise for part in parts), np.zeros((6, 6)))
        kept = float(np.trace(np.linalg.solve(whole, left))) / 6
        sums = RowSums(normal * kept, pull * kept)
        if sway is not None:
            sums = sums.about_rest(sway.at(first + width * np.arange(len(starts) + 1.0)))
        return sums, first, width

    def _shaken_equations(self, pose: MovingPose, sway: Sway) -> list[Equations]:
        """As `_equations`, where a shaking puts the rows; brightness follows.

        Brightness that was found while rows were off their places shows the pattern too faintly.
        """
        (first, width, ends), found = self._intervals(), []
        brightness = self._solver.shown
        for k in range(len(ends) - 1):
            start = first + k * width
            pixels = self._all.between(ends[k], ends[k + 1])
            state = sway.within(pose, start, start + width).state
            found.append(
                alignment_kernel.match_pattern(
                    pixels, self._texture, state, brightness, 6, TILES * TILES
                )
            )
        self._solver.scale = scales_of(np.hstack([part.residuals for part in found]))
        normal = np.sum([part.normal for part in found], axis=0)
        right = np.sum([part.right for part in found], axis=0)
        sums = np.sum([part.sums for part in found], axis=0)
        parts = [Equations.of(*part, 6) for part in zip(normal, right, sums, strict=True)]
        self._solver.brightness = self._solver.brightness + np.stack(
            [part.change for part in parts]
        )
        return parts

    def _intervals(self) -> tuple[float, float, NDArray[np.intp]]:
        """As of `intervals_over`, and the first pixel of each interval, and of none."""
        time = self._all.row_time
        first, width, count = intervals_over(float(time[0]), float(time[-1]))
        return first, width, np.searchsorted(time, first + width * np.arange(count + 1))

    def _blur_variance(self, pose: MovingPose) -> float:
        """By how much the picture is blurrier than the pattern, frame pixels squared."""
        few, place, layers = self._few, self._texture.place, self._texture.layers
        x, y = np.moveaxis(on_pad(pose.pose, few.rays), -1, 0)
        height, width = layers.shape[1:]
        column = np.clip(np.round(place[0] + place[1] * x).astype(np.intp), 1, width - 2)
        row = np.clip(np.round(place[2] + place[3] * y).astype(np.intp), 1, height - 2)
        around = layers[:, row - 1, column] + layers[:, row + 1, column]
        around += layers[:, row, column - 1] + layers[:, row, column + 1]
        bend = (around - 4 * layers[:, row, column]) * (OVERSAMPLING**2 / 2)
        residuals = alignment_kernel.match_pattern(
            few,
            self._texture,
            pose.state,
            self._solver.shown,
            0,
            1,
        ).residuals
        across = along = 0.0
        for c, terms in enumerate(self._solver.brightness):
            gains = terms[alignment_kernel.SHADE :: alignment_kernel.GAIN][: len(layers)]
            change = gains @ bend
            along += float(change @ residuals[c])
            across += float(change @ change)
        return along / max(across, 1e-9)


def _noise(parts: list[Equations]) -> float:
    """Scatter of scores over that of pixels as independent as they are many."""
    normal = sum((part.normal for part in parts), np.zeros((6, 6)))
    scores = sum((part.scores for part in parts), np.zeros((TILES * TILES, 6)))
    return pattern_noise(normal, scores)
