from __future__ import annotations

import io

import cv2
import numpy as np
import pytest
from measure_print import Array, pages

from padstudio.arrays import Image
from padstudio.color import linear_from_srgb
from padstudio.errors import ImageError
from padstudio.pad.sheets import strip
from padstudio.render.pdf.strip import write_strip
from padstudio.vision.frame.unmix import unmix
from padstudio.vision.strip_photo import estimate_crosstalk

MATRIX = np.array([[0.62, 0.14, 0.09], [0.06, 0.70, 0.10], [0.12, 0.17, 0.55]])
OFFSET = 1 - MATRIX.sum(axis=1)


@pytest.fixture(scope="module")
def sheet(tmp_path_factory: pytest.TempPathFactory) -> Image:
    out = io.BytesIO()
    write_strip(out)
    return pages(out.getvalue(), tmp_path_factory.mktemp("strip"), 100)[0]


def test_matrix_comes_back(sheet: Image) -> None:
    found = estimate_crosstalk(photograph(sheet, MATRIX, OFFSET))
    np.testing.assert_allclose(found.matrix, MATRIX, atol=0.02)
    np.testing.assert_allclose(found.offset, OFFSET, atol=0.02)
    assert found.residual < 0.01
    assert found.warnings == ()
    # Red stands out in its channel by what red gives, less what blue gives.
    assert found.red_separation == pytest.approx(0.62 - 0.09, abs=0.03)
    assert found.blue_separation == pytest.approx(0.55 - 0.12, abs=0.03)


def test_unmixing_gives_nominal_colours_back(sheet: Image) -> None:
    mixed = photograph(sheet, MATRIX, OFFSET, light=1.0, fall=0.0)
    found = estimate_crosstalk(mixed)
    before, after = _separations(mixed), _separations(unmix(mixed, found.matrix))
    # What black reflects stays, alike in all channels: white is 1 and black this much less.
    contrast = 1 / (1 + np.linalg.inv(MATRIX) @ OFFSET)[[0, 2]].max()
    assert after == pytest.approx(contrast, abs=0.03)
    assert after > before + 0.3
    again = estimate_crosstalk(unmix(mixed, found.matrix))
    off_diagonal = again.matrix - np.diag(np.diag(again.matrix))
    assert np.abs(off_diagonal).max() < 0.03


def test_close_colours_are_warned_of(sheet: Image) -> None:
    close = np.array([[0.30, 0.05, 0.22], [0.05, 0.70, 0.05], [0.25, 0.05, 0.33]])
    found = estimate_crosstalk(photograph(sheet, close, 1 - close.sum(axis=1)))
    assert any("red and blue are too close" in warning for warning in found.warnings)
    assert found.usable


def test_overexposure_is_warned_of(sheet: Image) -> None:
    found = estimate_crosstalk(photograph(sheet, MATRIX, OFFSET, light=1.4))
    assert any("overexposed" in warning for warning in found.warnings)
    assert not found.usable


def test_three_markers_are_enough_and_two_are_not(sheet: Image) -> None:
    photo = photograph(sheet, MATRIX, OFFSET)
    height = len(photo)
    photo[: height // 2, :125] = 128
    np.testing.assert_allclose(estimate_crosstalk(photo).matrix, MATRIX, atol=0.05)
    photo[:, :125] = 128
    with pytest.raises(ImageError, match="2 of the test strip's 4 markers") as caught:
        estimate_crosstalk(photo)
    assert caught.value.error_code == "no_test_strip"


def photograph(
    sheet: Image, matrix: Array, offset: Array, *, light: float = 0.75, fall: float = 0.3
) -> Image:
    """A camera's picture of the printed strip: inks that mix, slanted, unevenly lit, noisy."""
    scale = 100 / 25.4
    x0, y0 = 12 * scale, 30 * scale
    x1, y1 = x0 + (strip.WIDTH_MM + 10) * scale, y0 + (strip.HEIGHT_MM + 10) * scale
    corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], np.float32)
    seen = np.array([[60, 40], [940, 90], [900, 380], [30, 330]], np.float32)
    flat = cv2.warpPerspective(
        sheet,
        cv2.getPerspectiveTransform(corners, seen),
        (1000, 430),
        flags=cv2.INTER_AREA,
        borderValue=(255, 255, 255),
    )
    linear = linear_from_srgb(flat.astype(float) / 255) @ matrix.T + offset
    linear *= light * (1 - fall * np.linspace(0, 1, flat.shape[1]))[None, :, None]
    shown = 255 * np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )
    noisy = shown + np.random.default_rng(3).normal(0, 2, shown.shape)
    return np.ascontiguousarray(np.clip(np.round(noisy), 0, 255).astype(np.uint8)[..., ::-1])


def _separations(bgr: Image) -> float:
    found = estimate_crosstalk(bgr)
    return min(found.red_separation, found.blue_separation)
