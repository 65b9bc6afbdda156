from __future__ import annotations

import io
import struct

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from measure_print import document, edge_errors_mm, make_pad
from PIL import Image

from padstudio.errors import LimitError, SpecError
from padstudio.pad.layout import layout
from padstudio.pad.spec import Layer, Pad
from padstudio.render.painters import raster


def test_whole_pixels_are_crisp() -> None:
    pad = make_pad(4, 5, ratio=1, quiet_mm=10.0)
    image = raster.paint(pad, 0.3)
    assert image.shape == (18, 21, 3)
    inside = image[3:-3, 3:-3, 0]
    expected = np.repeat(np.repeat(pad.layers[0].field * 255, 3, axis=0), 3, axis=1)
    np.testing.assert_array_equal(inside, expected)
    assert (image[:3] == 255).all()
    assert (image[:, -3:] == 255).all()


@given(px_per_mm=st.floats(0.5, 9.0))
def test_edges_keep_their_place_at_any_resolution(px_per_mm: float) -> None:
    pad = make_pad(15, 20, quiet_mm=3.7)
    errors = edge_errors_mm(raster.paint(pad, px_per_mm), layout(pad), px_per_mm)
    assert len(errors) > 100
    assert np.abs(errors).max() < 0.01


@given(px_per_mm=st.floats(0.001, 0.05))
def test_mean_light_survives_reduction(px_per_mm: float) -> None:
    pad = make_pad(40, 40)
    image = raster.paint(pad, px_per_mm).astype(float)
    page = layout(pad)
    height, width = np.array(image.shape[:2]) / px_per_mm
    dark_area = (width * height) * (255 - image).mean(axis=(0, 1))
    patch_area = np.outer(np.diff(page.y_mm), np.diff(page.x_mm))
    truth = ((255 - page.colors.astype(float)) * patch_area[..., None]).sum(axis=(0, 1))
    np.testing.assert_allclose(dark_area, truth, atol=0.6 * width * height)


def test_bands_join_seamlessly(monkeypatch: pytest.MonkeyPatch) -> None:
    pad = make_pad(quiet_mm=2.0)
    whole = raster.paint(pad, 1.37)
    monkeypatch.setattr(raster, "_BAND_BYTES", 5000)
    np.testing.assert_array_equal(raster.paint(pad, 1.37), whole)


@pytest.mark.parametrize("dpi", [25.4, 72, 96, 150, 300])
def test_png_knows_its_size(dpi: float) -> None:
    pad = make_pad(quiet_mm=5.0)
    data = document(pad, "png", dpi=dpi)
    place = data.index(b"pHYs")
    x, y, unit = struct.unpack(">IIB", data[place + 4 : place + 13])
    assert (x, y, unit) == (round(dpi / 0.0254), round(dpi / 0.0254), 1)
    image = np.asarray(Image.open(io.BytesIO(data)))
    assert abs(image.shape[1] / x * 1000 - 260) < 1000 / x
    errors = edge_errors_mm(image, layout(pad), x / 1000)
    assert np.abs(errors).max() < 0.01
    np.testing.assert_array_equal(image, raster.paint(pad, x / 1000))
    bgr = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    np.testing.assert_array_equal(bgr[..., ::-1], image)


def test_levels_become_grey_steps() -> None:
    pad = Pad((Layer("green", 1.0, np.arange(4, dtype=np.uint8).reshape(2, 2)),), 2, 4)
    image = raster.paint(pad, 1.0)
    np.testing.assert_array_equal(image[..., 1], [[0, 85], [170, 255]])
    assert not image[..., [0, 2]].any()


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_bad_resolution_is_refused(value: float) -> None:
    with pytest.raises(SpecError, match="resolution"):
        raster.paint(make_pad(), value)
    with pytest.raises(SpecError, match="resolution"):
        document(make_pad(), "png", dpi=value)


def test_too_many_pixels_are_refused() -> None:
    with pytest.raises(LimitError, match="lower the resolution"):
        raster.paint(make_pad(), 1000.0)
