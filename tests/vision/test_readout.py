"""How long a shutter rolls, from shaken clips whose readout time is known."""

import math

import numpy as np
import pytest
from dense_frames import borders_amid, sample_pad, small_camera

from padstudio.errors import StudioError
from padstudio.geometry.pose import Pose, look_at_pad, rotation_from_vector
from padstudio.geometry.rolling_shutter import MovingPose, row_times
from padstudio.simulate.paths import motion_along
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.vision.pose.least_squares_kernel import Sightings, linearize
from padstudio.vision.readout import FrameRows, estimate_readout, fit_readout

PAD, CAMERA = sample_pad(), small_camera()
FPS, NOISE_PX = 30.0, 0.1


def shaken(hertz, degrees, height_mm=900):
    """A path of a camera that is shaken by hand, about all axes and along them."""

    def path(time_s):
        angle = 2 * math.pi * hertz * time_s
        level = look_at_pad(
            height_mm + 15 * degrees * math.sin(0.7 * angle),
            heading_deg=20 + 2 * degrees * math.sin(1.1 * angle + 1),
        )
        tip = np.radians(degrees) * np.array([math.sin(angle), math.cos(0.9 * angle), 0])
        shift = degrees * np.array([20 * math.sin(angle + 2), 15 * math.cos(1.2 * angle), 0])
        return Pose(level.position_mm + shift, level.rotation @ rotation_from_vector(tip))

    return path


def rows_of(path, readout_ms, *, frames=30, seed=0, times_s=None):
    """Borders where each row's own pose puts them, with noise; poses of frames are off, too."""
    rng = np.random.default_rng(seed)
    borders = borders_amid(PAD, PAD.layers[0], 20).thinned(120)
    times_s = np.arange(frames) / FPS if times_s is None else times_s
    return [_rows(path, float(time_s), readout_ms / 1000, borders, rng) for time_s in times_s]


def _rows(path, time_s, readout_s, borders, rng):
    row_time = np.zeros(len(borders.step))
    for _ in range(3):
        poses = [path(time_s + readout_s * time) for time in row_time]
        away = borders.points_mm - np.array([pose.position_mm for pose in poses])
        turns = np.array([pose.rotation for pose in poses])
        xy = CAMERA.project(np.einsum("ni,nij->nj", away, turns))
        row_time = row_times(CAMERA, xy[:, 1])
    xy += NOISE_PX * rng.standard_normal(xy.shape)
    off = np.concatenate([rng.normal(0, 0.05, 3), rng.normal(0, 5e-5, 3)])
    pose = MovingPose(path(time_s)).moved(off)
    seen = Sightings(
        borders.points_mm, borders.along_mm, CAMERA.normalize(xy), row_times(CAMERA, xy[:, 1]),
        np.ones(len(xy)),
    )  # fmt: skip
    return FrameRows(time_s, pose.pose, linearize(seen, pose.state), seen.row_time, seen.weight)


@pytest.mark.parametrize("readout_ms", [0.0, 10.0, 20.0, 30.0])
def test_the_rows_of_shaken_frames_tell_the_readout_time(readout_ms):
    found = fit_readout(rows_of(shaken(1.5, 2.0), readout_ms))
    assert abs(found.readout_ms - readout_ms) < max(3 * found.sigma_ms, 0.05)
    assert found.sigma_ms < 0.6
    assert found.frames == 26


def test_its_sigma_is_true():
    path = shaken(1.2, 1.5)
    fits = [fit_readout(rows_of(path, 15.0, frames=20, seed=seed)) for seed in range(6)]
    off = np.array([(fit.readout_ms - 15.0) / fit.sigma_ms for fit in fits])
    assert 0.1 < np.mean(off**2) < 3


@pytest.mark.parametrize(
    ("path", "frames", "says"),
    [
        (shaken(1.5, 0.0), 30, "hardly moves"),
        (shaken(1.5, 2.0), 12, "only 8 frames"),
        (shaken(8.0, 1.0), 30, "faster"),
    ],
    ids=["still", "short", "fast"],
)
def test_clips_that_do_not_tell_are_refused(path, frames, says):
    with pytest.raises(StudioError, match=says) as refused:
        fit_readout(rows_of(path, 20.0, frames=frames))
    assert refused.value.error_code == "readout_unknown"


def test_frames_that_were_lost_are_left_out():
    path, times_s = shaken(1.5, 2.0), np.arange(50) / FPS
    kept = np.delete(times_s, [11, 12, 30])
    found = fit_readout(rows_of(path, 20.0, times_s=kept))
    assert found.frames < len(kept) - 4
    assert abs(found.readout_ms - 20.0) < max(3 * found.sigma_ms, 0.05)


def test_of_a_clip():
    path, imaging = shaken(1.5, 2.0, 500), Imaging(readout_ms=18.0, exposure_ms=2.0)
    times_s = np.arange(17) / FPS
    frames = [
        render(
            Scene(pad=PAD), CAMERA, path(time_s), imaging, seed, motion=motion_along(path, time_s)
        ).image
        for seed, time_s in enumerate(times_s)
    ]
    found = estimate_readout(PAD, CAMERA, frames, times_s)
    assert abs(found.readout_ms - 18.0) < max(3 * found.sigma_ms, 0.3)


def test_a_pad_that_is_too_far_away_is_said_to_be():
    frame = render(Scene(pad=PAD), CAMERA, look_at_pad(1500.0)).image
    with pytest.raises(StudioError, match="go nearer"):
        estimate_readout(PAD, CAMERA, [frame] * 3, [0.0, 1 / FPS, 2 / FPS])
