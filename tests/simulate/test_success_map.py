"""Simulated maps of success, and their agreement with the geometric chart."""

import numpy as np
import pytest

from padstudio.errors import LimitError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.coverage.spans import METHOD_LIMITS, coverage, layer_span
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.success_map import MapGrid, judge, only, success_map, view_of
from padstudio.vision.detector import Detector


def camera(width=160, height=120, focal=110.0):
    matrix = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    return Camera(width, height, matrix)


def pad(cell_mm=20.0, cells=24):
    field = np.random.default_rng(6).integers(0, 2, (cells, cells)).astype(np.uint8)
    return Pad((Layer("blue", cell_mm, field), Layer("red", cell_mm, field)))


def moved(pose, by_mm, turn_deg=0.0):
    angle = np.radians(turn_deg)
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    return Pose(pose.position_mm + np.array([by_mm, 0, 0]), pose.rotation @ turn)


def test_verdicts_follow_the_limits_of_the_score():
    truth = look_at_pad(1000.0)
    assert judge(None, truth) == "none"
    assert judge(moved(truth, 20.9), truth) == "good"
    assert judge(moved(truth, 21.1), truth) == "poor"
    assert judge(moved(truth, 104.9), truth) == "poor"
    assert judge(moved(truth, 105.1), truth) == "wrong"
    assert judge(moved(truth, 0.0, 1.9), truth) == "good"
    assert judge(moved(truth, 0.0, 2.1), truth) == "poor"
    assert judge(moved(truth, 0.0, 10.1), truth) == "wrong"


def test_a_map_counts_what_its_reader_says():
    seen = []

    def blind(bgr):
        seen.append(bgr)

    found = success_map(
        Scene(pad=pad(), ground="plain"),
        camera(),
        blind,
        MapGrid([300, 600], values=[0, 20, 40], trials=2),
    )
    assert found.share.shape == found.wrong.shape == (2, 3)
    assert not found.share.any()
    assert not found.wrong.any()
    assert len(seen) == 12
    assert len({picture.tobytes() for picture in seen}) == 12


def test_blur_blurs_by_the_pixels_asked_for():
    """A path of n pixels adds n² / 12 to the variance of a lone cell's light, of side² / 6."""
    field = np.zeros((11, 11), np.uint8)
    field[5, 5] = 1
    lone = Pad((Layer("red", 31.0, field),), window=3)
    variances = []

    def spread(bgr):
        light = bgr[:, :, 2] / bgr[:, :, 2].sum(dtype=float)
        y, x = np.indices(light.shape)
        mean_x, mean_y = (light * x).sum(), (light * y).sum()
        variances.append((light * ((x - mean_x) ** 2 + (y - mean_y) ** 2)).sum())

    success_map(
        Scene(pad=lone, inks=Inks.ideal(), ground="plain"),
        camera(),
        spread,
        MapGrid([150], axis="blur_px", values=[0.0, 6.0, 18.0], trials=1),
        imaging=Imaging.ideal().with_changes(tone="linear"),
    )
    side = 31.0 * 110.0 / 150.0
    for variance, blur in zip(variances, (0.0, 6.0, 18.0), strict=True):
        assert variance == pytest.approx(side**2 / 6 + blur**2 / 12 + 1 / 6, rel=0.01)


def test_only_keeps_one_layer():
    assert [layer.channel for layer in only(pad(), "red").layers] == ["red"]
    with pytest.raises(SpecError, match="no green layer"):
        only(pad(), "green")


def test_limits_are_named():
    with pytest.raises(LimitError, match="20000"):
        MapGrid([300], trials=100_000)
    with pytest.raises(SpecError, match="0 … 89"):
        MapGrid([300], values=[90])
    with pytest.raises(SpecError, match="no pad"):
        success_map(Scene(pad=None), camera(), lambda bgr: None, MapGrid([300]))
    with pytest.raises(SpecError, match="above 1 mm"):
        MapGrid([0.5])


def lone(cells, cell_mm):
    """A pad of one layer."""
    field = np.random.default_rng(3).integers(0, 2, (cells, cells)).astype(np.uint8)
    return Pad((Layer("blue", cell_mm, field),))


def shares(pad, shot, heights_mm, tilt_deg, trials):
    """Share of frames that the detector reads, at each height."""
    detector = Detector(pad, shot)
    found = success_map(
        Scene(pad=pad),
        shot,
        lambda bgr: detector.detect(bgr).pose,
        MapGrid(heights_mm, values=[tilt_deg], trials=trials),
    )
    return found.share[:, 0]


@pytest.mark.parametrize(
    ("cells", "cell_mm", "tilt_deg", "trials"),
    [
        # Straight above the lean is lost first, which fades; then the sign's side, then its cells.
        (25, 50.0, 0.0, 12),
        (25, 50.0, 55.0, 6),
        (40, 20.0, 30.0, 6),
    ],
)
def test_the_charts_highest_height_is_where_half_of_the_frames_are_read(
    cells, cell_mm, tilt_deg, trials
):
    """To 10 %, by Spearman and Kärber's mean over heights from three quarters to four thirds."""
    pad, shot = lone(cells, cell_mm), camera(640, 480, 500.0)
    spans = coverage(pad, view_of(shot), METHOD_LIMITS["dense"], (tilt_deg,))
    high = max(span.high_mm for span in spans)
    factors = np.geomspace(0.75, 4 / 3, 5)
    share = shares(pad, shot, (high * factors).tolist(), tilt_deg, trials)
    step = np.log(factors[1] / factors[0])
    half = factors[0] * np.exp(step * (share.sum() - 0.5))
    assert half == pytest.approx(1.0, abs=0.1)
    assert share[0] > 0.8
    assert share[-1] < 0.2


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0])
def test_the_charts_lowest_height_is_right_to_one_cell(tilt_deg):
    shot = camera(680, 382, 471.5)
    pad, view = lone(25, 50.0), view_of(shot)
    span = layer_span(pad, pad.layers[0], view, METHOD_LIMITS["dense"], tilt_deg)
    one_cell = 50.0 / view.extent_per_height(tilt_deg)
    heights = [span.low_mm - one_cell, span.low_mm + one_cell]
    below, above = shares(pad, shot, heights, tilt_deg, trials=8)
    assert below < 0.4
    assert above > 0.6


def test_a_layer_larger_than_the_picture_ends_with_its_cells():
    """No side of the sign is in view."""
    pad, shot = lone(200, 10.0), camera(640, 480, 500.0)
    span = layer_span(pad, pad.layers[0], view_of(shot), METHOD_LIMITS["dense"])
    low, high = shares(pad, shot, [span.high_mm * 0.85, span.high_mm * 1.15], 0.0, trials=6)
    assert low > 0.8
    assert high < 0.2
