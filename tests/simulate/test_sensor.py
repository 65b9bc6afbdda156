"""Noise, mosaic, tone and optics of the simulated sensor."""

import cv2
import numpy as np
import pytest

from padstudio.errors import SpecError
from padstudio.simulate.sensor import Glare, Imaging, encode_jpeg, expose, sensor

BARE = Imaging.ideal().with_changes(tone="linear")


def rng():
    return np.random.default_rng(11)


def flat(value, size=256):
    return np.full((size, size, 3), value, np.float32)


@pytest.mark.parametrize("level", [0.02, 0.1, 0.5, 0.8])
def test_noise_variance_is_photons_plus_reading(level):
    imaging = Imaging(full_well_e=5000.0, read_noise_e=12.0)
    raw = sensor(np.full((600, 600), level, np.float32), imaging, rng()) / 65535 * 5000
    assert raw.mean() == pytest.approx(level * 5000, abs=0.5)
    assert raw.var() == pytest.approx(level * 5000 + 12.0**2, rel=0.02)


def test_variance_against_mean_has_the_slope_of_the_gain():
    """The photon transfer curve: variance rises with the mean by one electron an electron."""
    imaging = Imaging(full_well_e=8000.0, read_noise_e=5.0)
    means, variances = [], []
    for level in np.linspace(0.05, 0.8, 12):
        raw = sensor(np.full((300, 300), level, np.float32), imaging, rng()) / 65535 * 8000
        means.append(raw.mean())
        variances.append(raw.var())
    slope, floor = np.polyfit(means, variances, 1)
    assert slope == pytest.approx(1.0, abs=0.02)
    assert floor == pytest.approx(25.0, abs=40.0)


def test_mosaic_keeps_flat_colours_and_edges_in_place():
    color = np.array([0.6, 0.2, 0.4], np.float32)
    picture = expose(
        np.broadcast_to(color, (64, 64, 3)).copy(), BARE.with_changes(bayer=True), rng()
    )
    assert np.array_equal(picture[20, 20], np.round(color[::-1] * 255).astype(np.uint8))
    light = np.zeros((64, 64, 3), np.float32)
    light[:, 32:] = 0.8
    light = cv2.GaussianBlur(light, (0, 0), 1.0)
    plain = expose(light.copy(), BARE, rng()).astype(float)
    mosaic = expose(light.copy(), BARE.with_changes(bayer=True), rng()).astype(float)
    columns = np.arange(64)
    for channel in range(3):
        slope_plain = np.gradient(plain[:, :, channel].mean(axis=0))[8:-8]
        slope_mosaic = np.gradient(mosaic[:, :, channel].mean(axis=0))[8:-8]
        edge_plain = (slope_plain * columns[8:-8]).sum() / slope_plain.sum()
        edge_mosaic = (slope_mosaic * columns[8:-8]).sum() / slope_mosaic.sum()
        assert edge_mosaic == pytest.approx(edge_plain, abs=0.03)


def test_blur_and_defocus_keep_light_and_have_the_size_asked_for():
    point = np.zeros((65, 65, 3), np.float32)
    point[32, 32] = 40.0
    y, x = np.mgrid[-32:33, -32:33]
    for imaging, expected in (
        (BARE.with_changes(blur_px=2.0), 2 * 2.0**2),
        (BARE.with_changes(defocus_px=6.0), 6.0**2 / 2),
    ):
        spread = expose(point.copy(), imaging, rng())[:, :, 1] / 255.0
        assert spread.sum() == pytest.approx(40.0, rel=0.1)
        variance = (spread * (x**2 + y**2)).sum() / spread.sum()
        assert variance == pytest.approx(expected, rel=0.12)


def test_vignetting_darkens_the_corners_by_its_share():
    picture = expose(flat(0.8), BARE.with_changes(vignetting=0.5), rng())
    assert int(picture[128, 128, 1]) == pytest.approx(204, abs=1)
    assert int(picture[0, 0, 1]) == pytest.approx(102, abs=2)


def test_glare_brightens_its_place_only():
    glare = Glare(x=0.25, y=0.5, radius=0.1, strength=2.0)
    picture = expose(flat(0.1), BARE.with_changes(glare=glare), rng())
    assert picture[128, 64, 1] == 255
    assert int(picture[128, 240, 1]) == pytest.approx(26, abs=1)


def test_stuck_pixels_and_saturation():
    picture = expose(flat(0.5), BARE.with_changes(hot_pixels=0.04), rng())
    share = ((picture[:, :, 1] == 0) | (picture[:, :, 1] == 255)).mean()
    assert share == pytest.approx(0.04, rel=0.15)
    assert (expose(flat(3.0), BARE, rng()) == 255).all()


def test_tone_is_srgb():
    picture = expose(flat(0.2140), BARE.with_changes(tone="srgb"), rng())
    assert (picture == 127).all() or (picture == 128).all()


def test_sharpening_overshoots_at_an_edge():
    light = flat(0.2)
    light[:, 128:] = 0.6
    picture = expose(light, BARE.with_changes(sharpen=1.0), rng())
    assert picture[50, 129, 1] > picture[50, 200, 1]


def test_jpeg_halves_colour_resolution():
    picture = np.zeros((16, 16, 3), np.uint8)
    data = encode_jpeg(picture, 80)
    start = data.index(b"\xff\xc0")
    assert data[start + 11] == 0x22


@pytest.mark.parametrize(
    "bad", [{"exposure_ms": -1.0}, {"jpeg_quality": 0}, {"tone": "film"}, {"full_well_e": 1.0}]
)
def test_refuses_values_out_of_range(bad):
    with pytest.raises(SpecError, match=next(iter(bad))):
        Imaging(**bad)
