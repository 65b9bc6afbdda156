"""What rows say of motion: sums, what they tell apart, and what stays in doubt."""

import numpy as np
import pytest
from dense_frames import all_borders, random_pose, sample_pad, small_camera

from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose import row_motion_kernel
from padstudio.vision.pose.edge_points import EdgePoints, Sway
from padstudio.vision.pose.least_squares import MotionModel, fit_pose

CAMERA = small_camera()
HEIGHT_MM = 900.0


def seen_by(pose, sway, *, noise_px=0.1, blur_px2=0.0, seed=0):
    """Borders as a camera sees them whose rotation vector at row time s is ``sway(s)`` besides."""
    rng = np.random.default_rng(seed)
    pad = sample_pad()
    borders = all_borders(pad, pad.layers[0])
    xy = MovingPose(pose).project(CAMERA, borders.points_mm)
    for _ in range(4):
        time = (xy[:, 1] - (CAMERA.height - 1) / 2) / CAMERA.height
        points = pose.to_camera(borders.points_mm)
        xy = CAMERA.project(points - np.cross(sway(time), points))
    keep = (xy > 0).all(axis=1) & (xy < [CAMERA.width - 1, CAMERA.height - 1]).all(axis=1)
    which = np.flatnonzero(keep)[::7]
    noisy = xy[which] + rng.normal(0, noise_px, (len(which), 2))
    ones = np.ones(len(which))
    return EdgePoints(borders.take(which), noisy, ones, blur_px2 * ones)


def vibration(rng, amplitude_rad, periods):
    """A harmonic sway about each axis, none at the middle row."""
    phase = rng.uniform(0, 2 * np.pi, 3)

    def sway(time):
        angle = 2 * np.pi * periods * np.asarray(time)[:, None] + phase
        return amplitude_rad * (np.sin(angle) - np.sin(phase))

    return sway


def squared_error(fit, pose):
    error = fit.pose.step_to(MovingPose(pose))
    return error @ np.linalg.solve(fit.covariance, error) / 6


def test_sums_are_those_of_the_rows_in_an_interval():
    rng = np.random.default_rng(2)
    rows, sides = rng.normal(size=(90, 7)), rng.normal(size=(90, 2))
    time, trust = rng.uniform(-0.4, 0.4, 90), rng.uniform(0, 1, 90)
    sums = row_motion_kernel.row_sums(rows, sides, time, trust, -0.4, 0.2, 4)
    jacobian = np.hstack([rows[:, 1:], sides])
    at = (time + 0.4) / 0.2
    for k in range(4):
        here = at.astype(int) == k
        f, j, w = at[here] - k, jacobian[here], trust[here]
        for power in range(3):
            plain = (j * (w * f**power)[:, None]).T @ j
            np.testing.assert_allclose(sums.normal[power, k], plain, atol=1e-10)
        for power in range(2):
            plain = j.T @ (w * f**power * rows[here, 0])
            np.testing.assert_allclose(sums.pull[power, k], plain, atol=1e-10)


def test_noise_sums_are_those_of_single_scores():
    rng = np.random.default_rng(3)
    rows, trust, tile = rng.normal(size=(60, 7)), rng.uniform(0, 1, 60), rng.integers(0, 9, 60)
    normal, squares, scores = row_motion_kernel.noise_sums(rows, trust, tile, 9)
    single = (trust * rows[:, 0])[:, None] * rows[:, 1:]
    np.testing.assert_allclose(normal, (rows[:, 1:] * trust[:, None]).T @ rows[:, 1:], atol=1e-10)
    np.testing.assert_allclose(squares, single.T @ single, atol=1e-10)
    for number in range(9):
        np.testing.assert_allclose(scores[number], single[tile == number].sum(axis=0), atol=1e-10)


@pytest.mark.parametrize(
    ("name", "amplitude_rad", "rolling"),
    [("still", 0.0, True), ("still, global shutter", 0.0, False), ("vibrating", 0.002, True)],
)
def test_the_covariance_is_true(name, amplitude_rad, rolling):
    squares = []
    for seed in range(24):
        rng = np.random.default_rng(seed)
        pose = random_pose(rng, HEIGHT_MM, tilt_deg=15.0)
        sway = vibration(rng, amplitude_rad, rng.uniform(1.0, 3.0))
        edge_points = seen_by(pose, sway, seed=seed)
        model = MotionModel(moving=False, rolling=rolling)
        fit = fit_pose(MovingPose(pose), edge_points, CAMERA, model, iterations=4)
        assert fit is not None
        squares.append(squared_error(fit.settled(), pose))
    # No picture was taken here, so that what pictures leave over is reckoned with in vain.
    assert 0.3 < np.mean(squares) < 1.5, name


def test_a_shaken_frame_is_put_right_by_its_rows():
    rng = np.random.default_rng(1)
    pose = random_pose(rng, HEIGHT_MM, tilt_deg=10.0)
    edge_points = seen_by(pose, vibration(rng, 0.003, 2.0))
    fit = fit_pose(MovingPose(pose), edge_points, CAMERA, MotionModel(moving=False))
    assert fit is not None
    off, left = (
        np.linalg.norm(each.pose.step_to(MovingPose(pose))[3:]) for each in (fit, fit.settled())
    )
    assert left < 0.7 * off


def test_a_blur_leaves_the_attitude_in_doubt_and_nothing_else():
    pose = random_pose(np.random.default_rng(4), HEIGHT_MM)
    sharp, blurred = (
        fit_pose(
            MovingPose(pose),
            seen_by(pose, lambda time: np.zeros((len(time), 3)), blur_px2=blur_px2),
            CAMERA,
            MotionModel(moving=False, rolling=False),
        )
        for blur_px2 in (0.0, 3.2)
    )
    assert sharp is not None
    assert blurred is not None
    turn = np.sqrt(np.diag(blurred.covariance)[3:5]) * CAMERA.focal_px
    # A blur of 3 square pixels as of squared slopes is one of a pixel.
    np.testing.assert_allclose(turn, 1.0, rtol=0.2)
    moved = [np.sqrt(np.trace(fit.covariance[:3, :3])) for fit in (sharp, blurred)]
    assert moved[1] < 0.001 * HEIGHT_MM
    assert moved[0] < moved[1]


def test_sums_about_a_shaking_tell_of_it_as_those_about_none():
    rng = np.random.default_rng(6)
    rows, sides = rng.normal(size=(90, 7)), rng.normal(size=(90, 2))
    time, trust = rng.uniform(-0.4, 0.4, 90), rng.uniform(0, 1, 90)
    turns = rng.normal(size=(5, 3))
    knots = -0.4 + 0.2 * np.arange(5)
    left = rows.copy()
    left[:, 0] -= (rows[:, 4:] * Sway(knots, turns).at(time)).sum(axis=1)
    plain, about = (
        row_motion_kernel.row_sums(each, sides, time, trust, -0.4, 0.2, 4) for each in (rows, left)
    )
    np.testing.assert_allclose(about.about_rest(turns).pull, plain.pull, atol=1e-10)


def test_borders_of_a_shaken_frame_are_looked_for_where_they_are_seen():
    rng = np.random.default_rng(7)
    pose = random_pose(rng, HEIGHT_MM, tilt_deg=20.0)
    seen = seen_by(pose, vibration(rng, 0.004, 1.0), noise_px=0.0, seed=7)
    rng = np.random.default_rng(7)
    random_pose(rng, HEIGHT_MM, tilt_deg=20.0)
    knots = np.linspace(-0.5, 0.5, 65)
    sway = Sway(knots, vibration(rng, 0.004, 1.0)(knots))
    points = sway.seen_at(seen.borders.points_mm, CAMERA, MovingPose(pose))
    off = MovingPose(pose).project(CAMERA, points) - seen.xy
    still = MovingPose(pose).project(CAMERA, seen.borders.points_mm) - seen.xy
    assert np.abs(still).max() > 1.0
    # Rows move by as much as the picture does, which is left to the next look.
    assert np.abs(off).max() < 0.1 * np.abs(still).max()


class FoundWithin:
    """Finds the borders that are seen within reach of where they are looked for, and counts them.

    It stands for an `EdgeFinder`.
    """

    def __init__(self, every, reach_px):
        self.every, self.reach_px, self.looks = every, reach_px, []

    def find(self, pose, sway=None):
        every, points = self.every, self.every.borders.points_mm
        points = points if sway is None else sway.seen_at(points, CAMERA, pose)
        off = every.xy - pose.project(CAMERA, points)
        which = np.flatnonzero(np.hypot(*off.T) < self.reach_px)
        self.looks.append(len(which))
        part = every.xy[which], every.weight[which], every.blur_px2[which]
        return EdgePoints(every.borders.take(which), *part, finder=self)


def test_profiles_are_centred_again_where_a_shaking_exceeds_their_reach():
    squares = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        pose = random_pose(rng, HEIGHT_MM, tilt_deg=10.0)
        every = seen_by(pose, vibration(rng, 0.003, 2.0), seed=seed)
        finder = FoundWithin(every, 1.2)
        first = finder.find(MovingPose(pose))
        fit = fit_pose(MovingPose(pose), first, CAMERA, MotionModel(moving=False))
        assert fit is not None
        squares.append(squared_error(fit.settled(), pose))
        assert finder.looks[0] < 0.5 * len(every.xy)
        assert finder.looks[-1] > 0.95 * len(every.xy)
    assert 0.3 < np.mean(squares) < 1.5


def test_answers_with_priors_are_those_of_linear_algebra():
    rng = np.random.default_rng(5)
    root = rng.normal(size=(20, 14)) * 10.0 ** rng.integers(-3, 3, 14)
    normal, pull, sigma = root.T @ root, rng.normal(size=14), rng.uniform(0.1, 9, (3, 6))
    log_prior = np.log([0.5, 0.3, 0.2])
    weight, mean, covariance = row_motion_kernel.solve_with_priors(normal, pull, sigma, log_prior)
    for k in range(3):
        whole = normal + np.diag([*np.zeros(8), *sigma[k] ** -2.0])
        inverse = np.linalg.inv(whole)
        np.testing.assert_allclose(covariance[k], inverse[:6, :6], rtol=1e-6)
        np.testing.assert_allclose(mean[k], inverse @ pull, rtol=1e-6)
        spread = np.linalg.slogdet(whole)[1] / 2 + np.log(sigma[k]).sum()
        likely = log_prior[k] + pull @ inverse @ pull / 2 - spread
        assert weight[k] == pytest.approx(likely, rel=1e-6)
