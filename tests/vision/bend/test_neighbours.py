"""What neighbouring borders have in common, and whether rows or parts of the print tell why."""

import numpy as np

from padstudio.vision.bend.neighbours import common_px, parts_show
from padstudio.vision.pose.edge_points_kernel import Borders
from padstudio.vision.pose.least_squares_kernel import Sightings


def test_neighbours_that_lie_alike_are_noticed_and_noise_is_not():
    rng = np.random.default_rng(1)
    noise, rise = 0.1 * rng.normal(size=1000), rng.normal(size=1000)
    heights = np.sin(np.arange(1000) / 20)
    assert abs(common_px(noise, rise, np.ones(1000)).deviations) < 3
    bent = common_px(noise + 0.1 * np.sign(rise) * heights, rise, np.ones(1000))
    assert bent.deviations > 10
    assert 0.04 < bent.px < 0.1 * np.sqrt(0.5)


def seen_from_above(shift_px):
    """Borders of a plane seen straight from above, shifted by ``shift_px(x, y)`` along x and y."""
    rng = np.random.default_rng(4)
    x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(-1, 1, 50), np.linspace(-1, 1, 40)))
    upright = rng.random(len(x)) < 0.5
    nothing = np.zeros(len(x))
    flow = np.stack([-np.ones(len(x)), nothing, x, x * y, -(1 + x * x), y], axis=1)
    level = np.stack([nothing, -np.ones(len(x)), y, 1 + y * y, -x * y, -x], axis=1)
    shift = np.where(upright, *shift_px(x, y)) + 0.05 * rng.normal(size=len(x))
    rows = np.column_stack([shift, np.where(upright[:, None], flow, level)])
    across = np.stack([upright, ~upright, nothing], axis=1).astype(float)
    points = np.stack([x, y, nothing], axis=1)
    seen = Sightings(points, across, points[:, :2], y / 2, np.ones(len(x)))
    return rows, seen, Borders(points, across, across, np.ones(len(x)))


def test_sheets_show_and_a_shaking_and_noise_do_not():
    def sheets(x, y):
        return np.sin(3 * np.floor(3 * x) + np.floor(3 * y)), np.cos(5 * np.floor(3 * x * y))

    assert parts_show(*seen_from_above(sheets))
    assert not parts_show(*seen_from_above(lambda x, y: (np.sin(9 * y), np.cos(7 * y))))
    assert not parts_show(*seen_from_above(lambda x, y: (0 * x, 0 * y)))
