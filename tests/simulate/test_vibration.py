"""A vibrating camera: its poses by the formula, its rows at their times, its blur, its refusals."""

from dataclasses import replace

import numpy as np
import pytest

from padstudio.errors import LimitError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad, rotation_from_vector
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.motion import Motion, poses_at, row_times_s
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import FlightSpec, plan
from padstudio.simulate.vibration import Vibration

LINEAR = Imaging.ideal().with_changes(tone="linear")
FOCAL, HEIGHT_PX = 600.0, 240
CAMERA = Camera(320, HEIGHT_PX, np.array([[FOCAL, 0, 159.5], [0, FOCAL, 119.5], [0, 0, 1]]))


def striped():
    """Cells of 100 mm, white and black columns: one long edge every 100 mm."""
    field = np.tile(np.arange(12) % 2, (12, 1)).astype(np.uint8)
    pad = Pad((Layer("red", 100.0, field),), window=3)
    return Scene(pad=pad, inks=Inks.ideal(), ground="plain")


def edge_columns(image):
    """(H,) column of the edge nearest the middle, from the light left of it."""
    middle = image[:, 130:190, 2].astype(float) / 255
    rising = middle[0, -1] > middle[0, 0]
    return 129.5 + ((1 - middle) if rising else middle).sum(axis=1)


def test_rows_are_displaced_as_the_formula_says():
    """A turn about the camera's y axis by a small angle moves the picture by −f · angle."""
    pose = look_at_pad(600.0)
    shake = Vibration(frequency_hz=90.0, amplitude_deg=(0.0, 0.15, 0.0), phase_deg=(0, 40.0, 0))
    imaging = LINEAR.with_changes(readout_ms=20.0)
    motion = Motion(vibrations=(shake,))
    still = edge_columns(render(striped(), CAMERA, pose, LINEAR).image)
    rolled = edge_columns(render(striped(), CAMERA, pose, imaging, motion=motion).image)
    swing = 2 * np.pi * 90.0 * row_times_s(HEIGHT_PX, 20.0) + np.radians(40.0)
    angle = np.radians(0.15) * (np.sin(swing) - np.sin(np.radians(40.0)))
    # The edge lies on the axis, where a turn moves it by f · tan(angle).
    expected = still - FOCAL * np.tan(angle)
    assert np.abs(rolled - expected).max() < 0.02
    assert np.ptp(rolled) > 3.0


def test_the_frame_s_pose_is_that_of_its_middle():
    shake = Vibration(frequency_hz=70.0, amplitude_deg=(0.2, 0.1, 0.05), phase_deg=(10, 20, 30))
    motion = Motion(angular_deg_s=(3.0, 0.0, -20.0), vibrations=(shake,))
    pose = look_at_pad(500.0, tilt_deg=12.0)
    rotation, position = poses_at(pose, motion, np.array([0.0, 1 / 70.0]))
    assert np.allclose(rotation[0], pose.rotation, atol=1e-12)
    assert np.allclose(position, pose.position_mm)
    # After a whole period the vibration is where it was, and only the steady turn is left.
    steady, _ = poses_at(pose, Motion(angular_deg_s=(3.0, 0.0, -20.0)), np.array(1 / 70.0))
    assert np.degrees(np.arccos((np.sum(rotation[1] * steady) - 1) / 2)) < 2e-3


def test_frequencies_add_up_as_rotation_vectors():
    first = Vibration(frequency_hz=60.0, amplitude_deg=(0.1, 0.0, 0.0))
    second = Vibration(frequency_hz=140.0, amplitude_deg=(0.0, 0.2, 0.1), phase_deg=(0, 50, 90))
    pose, time = look_at_pad(500.0), 0.0031
    rotation, _ = poses_at(pose, Motion(vibrations=(first, second)), np.array(time))

    def vector(t):
        swing = 2 * np.pi * t * 140.0
        return np.radians(
            [
                0.1 * np.sin(2 * np.pi * 60.0 * t),
                0.2 * np.sin(swing + np.radians(50)),
                0.1 * np.sin(swing + np.radians(90)),
            ]
        )

    before, now = rotation_from_vector(vector(0.0)), rotation_from_vector(vector(time))
    assert np.allclose(rotation, pose.rotation @ before.T @ now, atol=1e-12)


def test_an_exposure_of_whole_periods_blurs_by_the_arcsine_law():
    """The picture is the mean over the swing, in a global shutter too."""
    pose = look_at_pad(500.0, heading_deg=12.0, target_mm=(30.0, 40.0))
    shake = Vibration(frequency_hz=150.0, amplitude_deg=(0.1, 0.3, 0.0), phase_deg=(0, 90, 0))
    motion = Motion(vibrations=(shake,))
    blurred = render(
        striped(), CAMERA, pose, LINEAR.with_changes(exposure_ms=20.0), motion=motion
    ).image
    instants = ((np.arange(96) + 0.5) / 96 - 0.5) * 0.02
    rotations, positions = poses_at(pose, motion, instants)
    stills = [
        render(striped(), CAMERA, replace(pose, position_mm=p, rotation=r), LINEAR).image
        for p, r in zip(positions, rotations, strict=True)
    ]
    difference = blurred - np.mean(np.array(stills, float), axis=0)
    assert np.sqrt((difference**2).mean()) < 1.5
    assert abs(difference.mean()) < 0.2


def test_a_flight_shakes_on_through_its_frames():
    shake = Vibration(frequency_hz=93.0, amplitude_deg=(0.1, 0.05, 0.02), phase_deg=(5, 6, 7))
    spec = FlightSpec(kind="landing", frames=5, from_mm=2000.0, to_mm=1000.0, seed=3)
    calm, shaken = plan(spec), plan(replace(spec, vibrations=(shake,)))
    for frame in range(5):
        # Rendering frame 0 for so long would come to the next frames' attitudes.
        extra = calm.poses[frame].rotation.T @ shaken.poses[frame].rotation
        swing = 2 * np.pi * 93.0 * frame / 30.0 + np.radians([5, 6, 7])
        expected = np.radians([0.1, 0.05, 0.02]) * np.sin(swing)
        assert np.allclose(extra, rotation_from_vector(expected), atol=1e-9)
        assert shaken.motions[frame].velocity_mm_s == calm.motions[frame].velocity_mm_s
    stills = plan(replace(spec, kind="descent", vibrations=(shake,)))
    phases = {motion.vibrations[0].phase_deg for motion in stills.motions}
    assert len(phases) == 5
    assert plan(replace(spec, kind="descent", vibrations=(shake,))).motions == stills.motions


def test_what_is_out_of_range_is_refused():
    with pytest.raises(SpecError, match=r"0\.1 … 2000"):
        Vibration(frequency_hz=0.0, amplitude_deg=(0.1, 0.1, 0.1))
    with pytest.raises(SpecError, match="-5 … 5"):
        Vibration(frequency_hz=90.0, amplitude_deg=(0.1, 9.0, 0.1))
    with pytest.raises(SpecError, match="finite"):
        Vibration(frequency_hz=90.0, amplitude_deg=(0.1, float("nan"), 0.1))
    fast = Motion(vibrations=(Vibration(frequency_hz=2000.0, amplitude_deg=(0.1, 0, 0)),))
    with pytest.raises(LimitError, match="shorter exposure") as refused:
        render(
            striped(),
            CAMERA,
            look_at_pad(500.0),
            LINEAR.with_changes(exposure_ms=500.0),
            motion=fast,
        )
    assert refused.value.error_code == "vibration_too_fast"
