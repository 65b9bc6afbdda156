import numpy as np
import pytest

from padstudio.pad.layout import (
    corners_mm,
    crop,
    lattice_mm,
    lattice_of,
    layout,
    level_values,
    outline_mm,
)
from padstudio.pad.spec import Layer, Pad

RED = np.array([[0, 1, 1, 0], [1, 0, 0, 1], [0, 0, 1, 1], [1, 1, 0, 0]])
BLUE = np.array([[1, 0], [0, 1]])


def two_layers(**values):
    layers = (Layer("red", 10, RED), Layer("blue", 20, BLUE))
    return Pad(layers, **{"window": 2, "quiet_mm": 5} | values)


def test_colours_lie_where_the_fields_say():
    made = layout(two_layers())
    assert (made.page_width_mm, made.page_height_mm) == (50, 50)
    np.testing.assert_allclose(made.x_mm, [5, 15, 25, 35, 45])
    np.testing.assert_allclose(made.y_mm, [5, 15, 25, 35, 45])
    np.testing.assert_array_equal(made.colors[:, :, 0], 255 * RED)
    np.testing.assert_array_equal(made.colors[:, :, 1], 0)
    np.testing.assert_array_equal(made.colors[:, :, 2], 255 * np.kron(BLUE, np.ones((2, 2))))


def test_layers_whose_edges_do_not_meet():
    made = layout(Pad((Layer("red", 3, RED), Layer("blue", 5, BLUE)), window=2))
    np.testing.assert_allclose(made.x_mm, [0, 3, 5, 6, 9, 10, 12])
    # The blue layer is 10 mm wide and dark beyond.
    assert not made.colors[:, -1, 2].any()
    assert not made.colors[-1, :, 2].any()
    red_columns = [0, 1, 1, 2, 3, 3]
    np.testing.assert_array_equal(made.colors[0, :, 0], 255 * RED[0, red_columns])


def test_edges_that_differ_by_rounding_are_one():
    made = layout(Pad((Layer("red", 0.1, np.eye(30)), Layer("blue", 0.3, np.eye(10))), window=2))
    assert len(made.x_mm) == 31


@pytest.mark.parametrize(
    ("levels", "values"),
    [(2, [0, 255]), (3, [0, 128, 255]), (4, [0, 85, 170, 255]), (6, [0, 51, 102, 153, 204, 255])],
)
def test_levels_are_evenly_spaced(levels, values):
    np.testing.assert_array_equal(level_values(levels), values)


def test_corners_are_about_the_pads_centre_with_y_up():
    corners = corners_mm(two_layers(), "red")
    assert corners.shape == (5, 5, 3)
    np.testing.assert_allclose(corners[0, 0], [-20, 20, 0])
    np.testing.assert_allclose(corners[0, 4], [20, 20, 0])
    np.testing.assert_allclose(corners[4, 0], [-20, -20, 0])
    np.testing.assert_allclose(corners[3, 1], [-10, -10, 0])


def test_a_part_keeps_page_coordinates():
    page = layout(two_layers())
    part = crop(page, 20, 0, 38, 15)
    np.testing.assert_allclose(part.x_mm, [20, 25, 35, 38])
    np.testing.assert_allclose(part.y_mm, [5, 15])
    np.testing.assert_array_equal(part.colors, page.colors[:1, 1:4])
    assert (part.page_width_mm, part.page_height_mm) == (50, 50)


def test_a_part_on_edges_has_whole_cells():
    page = layout(two_layers())
    part = crop(page, 15, 15, 45, 50)
    np.testing.assert_allclose(part.x_mm, page.x_mm[1:])
    np.testing.assert_array_equal(part.colors, page.colors[1:, 1:])


def test_a_part_of_the_quiet_margin_is_empty():
    assert crop(layout(two_layers()), 0, 0, 5, 50).colors.size == 0
    assert crop(layout(two_layers()), 45, 0, 50, 50).colors.size == 0


def test_layers_share_the_top_left_corner():
    pad = Pad((Layer("red", 10, RED), Layer("blue", 15, BLUE)), window=2)
    np.testing.assert_allclose(corners_mm(pad, "blue")[0, 0], corners_mm(pad, "red")[0, 0])


def test_a_measured_scale_moves_corners_from_the_centre():
    nominal, measured = two_layers(), two_layers(scale=(1.02, 0.99))
    expected = corners_mm(nominal, "blue") * [1.02, 0.99, 1]
    np.testing.assert_allclose(corners_mm(measured, "blue"), expected)
    np.testing.assert_allclose(outline_mm(measured), outline_mm(nominal) * [1.02, 0.99, 1])


def test_fractions_of_a_cell():
    pad = two_layers()
    middle = lattice_mm(pad, pad.layers[0], np.array([3.5, 0.5]))
    np.testing.assert_allclose(middle, [15, 15, 0])
    np.testing.assert_allclose(lattice_of(pad, pad.layers[0], middle), [3.5, 0.5])


def test_the_outline_runs_clockwise_from_the_top_left():
    outline = outline_mm(two_layers())
    np.testing.assert_allclose(outline[:, :2], [[-20, 20], [20, 20], [20, -20], [-20, -20]])


def test_corners_of_a_layer_that_is_not_there():
    with pytest.raises(KeyError, match="green"):
        corners_mm(two_layers(), "green")
