"""Bent paper and tiled prints: where their cells are seen, their isometry, their refusals."""

from dataclasses import replace

import numpy as np
import pytest
from edge_corners import measured_corner

from padstudio.errors import SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad, rotation_angle_deg
from padstudio.pad.layout import corners_mm
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.lay.fit import laid
from padstudio.simulate.lay.relief import Fold, Lift, Relief, Wave
from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

LINEAR = Imaging.ideal().with_changes(tone="linear")
CAMERA = Camera(640, 480, np.array([[440.0, 0, 320.0], [0, 440.0, 240.0], [0, 0, 1]]))
CELLS = np.indices((8, 10)).sum(0).astype(np.uint8) % 2
PAD = Pad((Layer("red", 45.0, CELLS),), window=3)
FLAT = Scene(pad=PAD, inks=Inks.ideal(), ground="plain", quiet_mm=0.0)
HALF = (225.0, 180.0)
BENDS = {
    "wave": Wave(amplitude_mm=6.0, length_mm=260.0, toward_deg=70.0, phase_deg=40.0),
    "fold": Fold(height_mm=14.0, reach_mm=60.0, toward_deg=80.0, offset_mm=30.0, radius_mm=25.0),
    "lift": Lift(height_mm=20.0, reach_mm=150.0, toward_deg=50.0, offset_mm=40.0),
}


def measured_errors(frame):
    """(N, 2) measured minus true corners well within the frame."""
    grid = frame.truth.corners_px("red")
    image = frame.image[:, :, 2].astype(float)
    errors = []
    for row in range(1, grid.shape[0] - 1):
        for col in range(1, grid.shape[1] - 1):
            corner = grid[row, col]
            if (corner > 26).all() and (corner < np.array([613, 453])).all():
                along = grid[row, col + 1] - grid[row, col - 1]
                across = grid[row + 1, col] - grid[row - 1, col]
                errors.append(measured_corner(image, corner, along, across) - corner)
    return np.array(errors)


@pytest.mark.parametrize("name", sorted(BENDS))
@pytest.mark.parametrize("tilt", [0.0, 35.0])
def test_cells_of_bent_paper_are_seen_where_it_carries_them(name, tilt):
    pose = look_at_pad(420.0, tilt_deg=tilt, heading_deg=25.0, tilt_towards_deg=200.0)
    scene = replace(FLAT, lay=Relief((BENDS[name],)))
    frame = render(scene, CAMERA, pose, LINEAR)
    errors = measured_errors(frame)
    assert len(errors) > 25
    # Corners are measured by cubics through bent edges, which costs a little.
    assert np.median(np.linalg.norm(errors, axis=1)) < 0.02
    assert np.linalg.norm(errors, axis=1).max() < 0.25
    flat = render(FLAT, CAMERA, pose, LINEAR).truth.corners_px("red")
    assert np.linalg.norm(frame.truth.corners_px("red") - flat, axis=-1).max() > 2.0


@pytest.mark.parametrize("name", sorted(BENDS))
def test_bent_paper_keeps_its_lengths(name):
    bend = BENDS[name]
    toward = np.radians(bend.toward_deg)
    along = np.linspace(-170.0, 170.0, 3001)
    points = along[:, None] * np.array([np.sin(toward), np.cos(toward)])
    there = laid(Relief((bend,)), HALF, points)
    length = np.linalg.norm(np.diff(there, axis=0), axis=1).sum()
    assert length == pytest.approx(340.0, abs=0.02)
    assert np.linalg.norm(there[-1] - there[0]) < 339.9 if name != "lift" else True
    assert np.allclose(there[:, 2], bend.height(along), atol=0.01)


def test_the_fitted_plane_takes_up_a_slope():
    """A lifted half tilts the plane that fits best; waves of many periods do not."""
    pose = look_at_pad(900.0)
    waves = Relief((Wave(amplitude_mm=2.0, length_mm=40.0),))
    lifted = Relief((Lift(height_mm=10.0, reach_mm=100.0, toward_deg=90.0, offset_mm=0.0),))
    calm = render(replace(FLAT, lay=waves), CAMERA, pose, LINEAR).truth
    tilted = render(replace(FLAT, lay=lifted), CAMERA, pose, LINEAR).truth
    assert rotation_angle_deg(calm.pose.rotation, calm.also_true[0].rotation) < 0.1
    assert rotation_angle_deg(tilted.pose.rotation, tilted.also_true[0].rotation) > 2.0
    assert render(FLAT, CAMERA, pose, LINEAR).truth.also_true == ()


def test_of_one_sheet_in_view_its_own_pose_is_true():
    """From near, the fit to what is seen is the pose relative to the one sheet."""
    tiles = Tiles(columns=2, rows=2, gap_mm=8.0, offset_mm=4.0, turn_deg=3.0, seed=4)
    pose = look_at_pad(60.0, target_mm=(120.0, 90.0))
    truth = render(replace(FLAT, lay=tiles), CAMERA, pose, LINEAR).truth
    x, y, cosine, sine, _, _, u, v = tiles.placed(*HALF)[3]
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    own = turn.T @ (pose.position_mm - np.array([x, y, 0])) + np.array([u, v, 0])
    assert np.allclose(truth.also_true[1].position_mm, own, atol=1e-6)
    assert np.allclose(truth.also_true[1].rotation, turn.T @ pose.rotation, atol=1e-9)


def test_sheets_lie_where_they_are_put():
    tiles = Tiles(columns=2, rows=2, gap_mm=4.0, offset_mm=3.0, turn_deg=1.5, seed=4)
    pose = look_at_pad(430.0, tilt_deg=10.0, heading_deg=15.0)
    frame = render(replace(FLAT, lay=tiles), CAMERA, pose, LINEAR)
    grid = frame.truth.corners_px("red")
    image = frame.image[:, :, 2].astype(float)
    errors = []
    for row in (1, 2, 3, 5, 6, 7):
        for col in (1, 2, 3, 4, 6, 7, 8, 9):
            # Those whose edges reach over no seam.
            if row in (3, 5) or col in (4, 6) or not (grid[row, col] > 26).all():
                continue
            if not (grid[row, col] < np.array([613, 453])).all():
                continue
            along = grid[row, col + 1] - grid[row, col]
            across = grid[row + 1, col] - grid[row, col]
            errors.append(measured_corner(image, grid[row, col], along, across) - grid[row, col])
    assert len(errors) > 8
    assert np.linalg.norm(errors, axis=1).max() < 0.02


def test_gaps_show_the_ground_and_swapped_sheets_each_other():
    pose = look_at_pad(600.0)
    plain = render(FLAT, CAMERA, pose, Imaging.ideal()).image
    gap = replace(FLAT, lay=Tiles(columns=2, rows=1, gap_mm=30.0))
    image = render(gap, CAMERA, pose, Imaging.ideal()).image
    middle = image[240, 312:330]
    assert (np.abs(middle.astype(int) - 128) < 3).all()
    # Two half pads exchanged: what is 5 cells to the left is now 5 to the right.
    swapped = render(
        replace(FLAT, lay=Tiles(columns=2, rows=1, swaps=1)), CAMERA, pose, Imaging.ideal()
    ).image
    shift = round(225.0 * 440.0 / 600.0)
    left = plain[160:320, 320 - shift + 3 : 317].astype(int)
    moved = swapped[160:320, 323 : 320 + shift - 3].astype(int)
    assert np.abs(left - moved).max() <= 1


def test_exact_tiles_are_the_whole_print():
    pose = look_at_pad(500.0, tilt_deg=20.0)
    whole = render(FLAT, CAMERA, pose, LINEAR).image.astype(int)
    tiled = render(replace(FLAT, lay=Tiles(columns=3, rows=2)), CAMERA, pose, LINEAR).image
    flat = render(replace(FLAT, lay=Relief(())), CAMERA, pose, LINEAR).image
    assert np.abs(whole - tiled).mean() < 0.1
    assert np.abs(whole - flat).mean() < 0.1


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Tiles(columns=0, rows=1), "columns is 0"),
        (lambda: Tiles(columns=2, rows=1, swaps=2), "of 2 sheets"),
        (lambda: Tiles(columns=2, rows=1, turn_deg=40.0), "turn_deg"),
        (lambda: Relief((Wave(amplitude_mm=1.0, length_mm=0.0),)), "length_mm"),
        (lambda: Relief((Lift(height_mm=float("nan"), reach_mm=1.0),)), "finite"),
        (lambda: Relief((Wave(amplitude_mm=50.0, length_mm=200.0),)).nodes(*HALF), "rises by"),
    ],
)
def test_what_is_out_of_range_is_refused(make, message):
    with pytest.raises(SpecError, match=message):
        make()


def test_corners_of_a_flat_print_are_the_layout_s():
    points = corners_mm(PAD, "red").reshape(-1, 3)
    assert np.allclose(laid(Relief(()), HALF, points[:, :2]), points)
    assert np.allclose(laid(Tiles(columns=4, rows=3), HALF, points[:, :2]), points)
