"""Spectral responses: matrices over colours and the near infrared, and grey pictures."""

import numpy as np
import pytest

from padstudio.color import linear_from_srgb
from padstudio.errors import SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.response import RESPONSES, Response
from padstudio.simulate.sensor import Imaging

LINEAR = Imaging.ideal().with_changes(tone="linear")
CAMERA = Camera(80, 60, np.array([[100.0, 0, 39.5], [0, 100.0, 29.5], [0, 0, 1]]))
INKS = Inks()


def seen(red, blue, imaging, seed=0):
    """(3,) mean BGR of one full colour of the pad that fills the frame."""
    layers = (
        Layer("red", 500.0, np.full((3, 3), red, np.uint8)),
        Layer("blue", 500.0, np.full((3, 3), blue, np.uint8)),
    )
    scene = Scene(pad=Pad(layers, window=3), inks=INKS)
    return render(scene, CAMERA, look_at_pad(500.0), imaging, seed).image


@pytest.mark.parametrize("name", sorted(RESPONSES))
def test_each_ink_is_seen_as_the_matrix_says(name):
    response = RESPONSES[name]
    inks = {(0, 0): 0, (1, 0): 1, (0, 1): 4, (1, 1): 5}
    primaries = [INKS.black, INKS.red, None, None, INKS.blue, INKS.magenta]
    for (red, blue), place in inks.items():
        image = seen(red, blue, LINEAR.with_changes(response=response))
        colour = linear_from_srgb(np.array(primaries[place]) / 255)
        infrared = linear_from_srgb(np.array(INKS.infrared_greys[place]) / 255)
        expected = np.array(response.matrix) @ colour + infrared * np.array(response.infrared)
        expected = np.clip(np.broadcast_to(expected, 3), 0, 1) * 255
        assert np.abs(image.reshape(-1, 3)[:, ::-1] - expected).max() < 1


def test_a_monochrome_picture_has_three_equal_channels_and_its_own_noise():
    noisy = Imaging(blur_px=0.0, vignetting=0.0, jpeg_quality=None, tone="linear")
    mono = noisy.with_changes(response=RESPONSES["mono"])
    image = seen(1, 1, mono)
    assert (image[..., 0] == image[..., 1]).all()
    assert (image[..., 0] == image[..., 2]).all()
    grey = image[..., 0].astype(float)
    # Photons of one sensor: nothing is interpolated, so neighbours are independent.
    share = grey.mean() / 255
    expected = 255 * np.sqrt(share / 8000 + (4 / 8000) ** 2 + (1 / 255) ** 2 / 12)
    assert grey.std() == pytest.approx(expected, rel=0.06)
    left, right = grey[:, :-1].ravel(), grey[:, 1:].ravel()
    assert abs(np.corrcoef(left, right)[0, 1]) < 0.05


def test_no_response_changes_nothing():
    same = Response(matrix=((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0)))
    imaging = Imaging(jpeg_quality=None)
    assert np.array_equal(seen(1, 0, imaging), seen(1, 0, imaging.with_changes(response=same)))


def test_faded_ink_loses_density_towards_the_paper():
    half = INKS.faded(0.5)
    white, red = (linear_from_srgb(np.array(c) / 255) for c in (INKS.white, INKS.red))
    faded = linear_from_srgb(np.array(half.red) / 255)
    assert np.allclose(np.log(faded / white), 0.5 * np.log(red / white), atol=1e-6)
    assert np.allclose(INKS.faded(0.0).blue, INKS.blue, atol=1e-6)
    assert np.allclose(INKS.faded(1.0).magenta, INKS.white, atol=1e-6)
    with pytest.raises(SpecError, match="faded"):
        INKS.faded(1.5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Response(matrix=((1.0, 0.0, 0.0),) * 2), "one or three rows"),
        (lambda: Response(matrix=((1.0, 0.0, 0.0),), infrared=(1.0, 1.0)), "one weight a row"),
        (lambda: Response(matrix=((99.0, 0.0, 0.0),)), "-10 … 10"),
    ],
)
def test_what_is_ill_formed_is_refused(make, message):
    with pytest.raises(SpecError, match=message):
        make()
