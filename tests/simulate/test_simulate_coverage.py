"""Simulated maps of success, and their agreement with the geometric chart."""

import numpy as np
import pytest

from padstudio.errors import LimitError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.coverage import METHOD_LIMITS, layer_span
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.coverage import judge, only, success_map, view_of
from padstudio.simulate.imaging import Imaging
from padstudio.simulate.inks import Inks
from padstudio.simulate.scene import Scene
from padstudio.vision.pipeline import Detector


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
        heights_mm=[300, 600],
        values=[0, 20, 40],
        trials=2,
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
        heights_mm=[150],
        axis="blur_px",
        values=[0.0, 6.0, 18.0],
        trials=1,
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
    scene = Scene(pad=pad(), ground="plain")
    with pytest.raises(LimitError, match="20000"):
        success_map(scene, camera(), lambda bgr: None, heights_mm=[300], trials=100_000)
    with pytest.raises(SpecError, match="0 … 89"):
        success_map(scene, camera(), lambda bgr: None, heights_mm=[300], values=[90])
    with pytest.raises(SpecError, match="no pad"):
        success_map(Scene(pad=None), camera(), lambda bgr: None, heights_mm=[300])
    with pytest.raises(SpecError, match="above 1 mm"):
        success_map(scene, camera(), lambda bgr: None, heights_mm=[0.5])


def test_the_chart_agrees_with_what_simulation_finds():
    """To one cell across at the low end; at the high end, which fades, to 15 % and a third."""
    field = np.random.default_rng(0).integers(0, 2, (25, 25)).astype(np.uint8)
    lone = Pad((Layer("blue", 50.0, field),))
    half = camera(1360, 765, 943.0)
    view = view_of(half)
    span = layer_span(lone, lone.layers[0], view, METHOD_LIMITS["dense"])
    one_cell = 50.0 / view.extent_per_height(0.0)
    detector = Detector(lone, half)

    def by_cells(bgr):
        # The chart is of layers; from farther still the whole sign's outline gives poses.
        detection = detector.detect(bgr)
        return None if detection.layer == "outline" else detection.pose

    found = success_map(
        Scene(pad=lone),
        half,
        by_cells,
        heights_mm=[
            span.low_mm - one_cell,
            span.low_mm + one_cell,
            span.high_mm * 0.85,
            span.high_mm * 1.35,
        ],
        trials=3,
    )
    below, low, high, above = found.share[:, 0]
    assert min(low, high) > 0.6
    assert max(below, above) < 0.4
    assert not found.wrong.any()
