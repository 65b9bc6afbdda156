"""Where the pad's colour ends, whatever the brightness of what is round it."""

import cv2
import numpy as np
import pytest
from paper_frames import HEIGHT, WIDTH, small_camera

from padstudio.color import picture_from_linear
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.outline.sides import SideView, fit_side

GREEN = [1]
# Light of blue, green, red.
INKS = np.array([[0.03, 0.03, 0.03], [0.6, 0.05, 0.04], [0.04, 0.05, 0.6], [0.55, 0.06, 0.55]])


def edge_at(x, ground, *, blur_px=0.9, fine=8, seed=4):
    """A picture whose pad ends at an upright side, x of its right rim, pixels."""
    rng = np.random.default_rng(seed)
    cells = INKS[rng.integers(0, 4, (HEIGHT // 5 + 1, WIDTH // 5 + 1))]
    light = np.repeat(np.repeat(cells, 5, axis=0), 5 * fine, axis=1)[:HEIGHT, : WIDTH * fine]
    light[:, round((x + 0.5) * fine) :] = ground
    # Lens and pixels mix light, not grey values.
    light = cv2.GaussianBlur(light, (0, 0), sigmaX=blur_px * fine, sigmaY=blur_px)
    light = light.reshape(HEIGHT, WIDTH, fine, 3).mean(axis=2)
    return picture_from_linear(
        np.clip(light + rng.normal(0, 0.004, light.shape), 0, 1).astype("f4")
    )


def found_x(picture, rough_x):
    """Where the side is found half way down, pixels."""
    camera = small_camera()
    ends = np.array([[rough_x, 60.0], [rough_x, HEIGHT - 60.0]])
    # The pad lies to the left of the way down, hence to the right of the way up.
    side = fit_side(SideView(Pyramid(picture), camera, 0, GREEN, 400), ends, 6.0)
    assert side is not None
    return camera.denormalize(np.array([[-side.line[2] / side.line[0], 0.0]]))[0, 0]


@pytest.mark.parametrize(
    "ground",
    [(0.04, 0.12, 0.05), (0.1, 0.3, 0.12), (0.25, 0.3, 0.28), (0.6, 0.65, 0.6), (0.85, 0.9, 0.85)],
    ids=["dark grass", "grass", "gravel", "concrete", "white"],
)
@pytest.mark.parametrize("x", [300.0, 300.375])
def test_sides_are_where_the_pad_ends_on_any_ground(ground, x):
    assert found_x(edge_at(x, ground), x + 0.5) == pytest.approx(x, abs=0.08)


def test_no_side_is_found_without_a_step():
    rng = np.random.default_rng(1)
    picture = rng.integers(90, 110, (HEIGHT, WIDTH, 3)).astype(np.uint8)
    ends = np.array([[300.0, 60.0], [300.0, HEIGHT - 60.0]])
    view = SideView(Pyramid(picture), small_camera(), 0, GREEN, 400)
    assert fit_side(view, ends, 6.0) is None
    assert fit_side(view, ends[[0, 0]] + [[0, 0], [0, 3.0]], 6.0) is None
