"""Levels of the cells, as the picture alone tells them."""

import numpy as np
import pytest
from dense_frames import IDEAL, frame_of, random_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import lattice_mm
from padstudio.simulate.radiance.scene import Light
from padstudio.vision.cells.sampling import read_cells, relative_field
from padstudio.vision.frame.pyramid import Pyramid


def read(pad, pose, layer, *, imaging=IDEAL, **scene):
    camera = small_camera()
    pyramid = Pyramid(frame_of(pose, pad=pad, camera=camera, imaging=imaging, **scene))

    def to_pixels(at):
        return MovingPose(pose).project(camera, lattice_mm(pad, layer, at))

    return read_cells(pyramid, layer.channel, to_pixels, (0, layer.cols), (0, layer.rows))


@pytest.mark.parametrize("levels", [2, 3, 4])
@pytest.mark.parametrize("height_mm", [150.0, 700.0, 1800.0])
def test_levels_are_the_pads(levels, height_mm):
    pad = random_pad(5, levels=levels, cells=(25,), cell_mm=(50.0,), channels=("red",))
    layer = pad.layers[0]
    cells = read(pad, look_at_pad(height_mm, tilt_deg=12, heading_deg=40), layer)
    assert cells is not None
    found = cells.levels(levels)
    wrong = (found != layer.field)[cells.seen].mean()
    # With more levels than two a block's mean is known less well than it needs to be.
    assert wrong <= (0.0 if levels == 2 and height_mm > 200 else 0.2)
    np.testing.assert_array_equal(found == -1, ~cells.seen)


def test_light_that_falls_off_to_a_tenth_does_not_matter():
    pad = random_pad(6, cells=(25,), cell_mm=(50.0,), channels=("blue",))
    light = Light(gradient_per_m=(1.3, 0.3))
    cells = read(pad, look_at_pad(1600.0), pad.layers[0], light=light)
    assert cells is not None
    assert (cells.levels(2) == pad.layers[0].field).mean() > 0.98


def test_cells_cut_by_the_frames_edge_are_read_where_they_show():
    pad = random_pad(7, cells=(25,), cell_mm=(50.0,), channels=("red",))
    layer = pad.layers[0]
    cells = read(pad, look_at_pad(120.0, heading_deg=15), layer)
    assert cells is not None
    inside = (cells.xy >= 0).all(axis=-1) & (cells.xy <= [639, 479]).all(axis=-1)
    assert inside[cells.seen].all()
    np.testing.assert_array_equal(cells.levels(2)[cells.seen], layer.field[cells.seen])
    assert cells.cell_px == pytest.approx(440 * 50 / 120, rel=0.05)


def test_no_cell_in_view_is_no_grid():
    pad = random_pad(7, cells=(25,), cell_mm=(50.0,), channels=("red",))
    assert read(pad, look_at_pad(300.0, target_mm=(9000, 0)), pad.layers[0]) is None


def test_cells_behind_the_camera_are_not_seen():
    pad = random_pad(7, cells=(25,), cell_mm=(50.0,), channels=("red",))
    pose = look_at_pad(60.0, tilt_deg=75, tilt_towards_deg=0)
    cells = read(pad, pose, pad.layers[0])
    assert cells is not None
    behind = np.isnan(cells.xy).any(axis=-1)
    assert behind.any()
    assert not cells.seen[behind].any()


def test_a_field_looks_as_its_cells_would():
    field = np.random.default_rng(2).integers(0, 2, (30, 30)).astype(np.uint8)
    relative = relative_field(field)
    assert ((relative > 0) == (field == 1)).mean() > 0.99


def test_where_nothing_differs_no_code_is_read():
    pad = random_pad(7, cells=(25,), cell_mm=(50.0,), channels=("red",))
    layer, camera, pose = pad.layers[0], small_camera(), look_at_pad(1300.0)
    image = frame_of(pose, pad=pad, camera=camera, imaging=IDEAL)
    image[120:360, 200:440] = 255

    def to_pixels(at):
        return MovingPose(pose).project(camera, lattice_mm(pad, layer, at))

    pyramid = Pyramid(image)
    cells = read_cells(pyramid, layer.channel, to_pixels, (0, layer.cols), (0, layer.rows))
    x, y = cells.xy[..., 0], cells.xy[..., 1]
    amid = (abs(x - 320) < 120 - 4 * cells.cell_px) & (abs(y - 240) < 120 - 4 * cells.cell_px)
    outside = (abs(x - 320) > 130) | (abs(y - 240) > 130)
    assert amid.any()
    assert not cells.seen[amid].any()
    assert (cells.levels(2)[amid] == -1).all()
    whole = read_cells(
        Pyramid(frame_of(pose, pad=pad, camera=camera, imaging=IDEAL)),
        layer.channel, to_pixels, (0, layer.cols), (0, layer.rows),
    )  # fmt: skip
    np.testing.assert_array_equal(cells.seen[outside], whole.seen[outside])
