"""Several pads on one ground."""

from dataclasses import replace

import numpy as np
import pytest

from padstudio.errors import SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.lay.relief import Relief
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.radiance.scene import Neighbour, Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

IDEAL = Imaging.ideal()
CAMERA = Camera(240, 180, np.array([[250.0, 0, 119.5], [0, 250.0, 89.5], [0, 0, 1]]))


def random_pad(seed, cells, cell_mm, scale=(1.0, 1.0)):
    rng = np.random.default_rng(seed)
    field = rng.integers(0, 2, cells).astype(np.uint8)
    return Pad((Layer("red", cell_mm, field),), window=3, scale=scale)


OWN, OTHER = random_pad(1, (10, 12), 20.0), random_pad(2, (9, 7), 13.0, (1.02, 0.99))


@pytest.mark.parametrize("pad", [OWN, OTHER], ids=["a copy", "another size and scale"])
def test_a_neighbour_is_seen_as_if_it_lay_alone(pad):
    """From above its own place and heading it looks as it does alone."""
    beside = Neighbour(pad=pad, x_mm=400.0, y_mm=-90.0, turn_deg=37.0)
    scene = Scene(pad=OWN, inks=Inks.ideal(), ground="plain", neighbours=(beside,))
    alone = replace(scene, pad=pad, neighbours=())
    both = render(scene, CAMERA, look_at_pad(420.0, heading_deg=37.0, target_mm=(400, -90)), IDEAL)
    single = render(alone, CAMERA, look_at_pad(420.0), IDEAL)
    # Pixels that straddle cells are sampled beside pads, and exact where one lies alone.
    difference = np.abs(both.image.astype(int) - single.image)[20:160, 60:180]
    assert np.percentile(difference, 90) <= 3
    assert np.percentile(difference, 99) <= 16


def test_the_pose_relative_to_a_copy_is_true_too():
    beside = Neighbour(pad=OWN, x_mm=400.0, y_mm=-90.0, turn_deg=37.0)
    scene = Scene(pad=OWN, ground="plain", neighbours=(beside,))
    pose = look_at_pad(420.0, heading_deg=37.0, target_mm=(400, -90))
    (other,) = render(scene, CAMERA, pose, IDEAL).truth.also_true
    assert np.allclose(other.position_mm, look_at_pad(420.0).position_mm, atol=1e-9)
    assert np.allclose(other.rotation, look_at_pad(420.0).rotation, atol=1e-9)
    foreign = replace(scene, neighbours=(replace(beside, pad=OTHER),))
    assert render(foreign, CAMERA, pose, IDEAL).truth.also_true == ()


def test_the_scene_s_own_pad_is_not_changed():
    beside = Neighbour(pad=OTHER, x_mm=400.0, y_mm=0.0)
    scene = Scene(pad=OWN, inks=Inks.ideal(), ground="plain")
    pose = look_at_pad(300.0, heading_deg=12.0)
    plain = render(scene, CAMERA, pose, IDEAL).image.astype(int)
    image = render(replace(scene, neighbours=(beside,)), CAMERA, pose, IDEAL).image
    assert np.abs(image - plain).mean() < 0.2


def test_what_does_not_go_together_is_refused():
    beside = Neighbour(pad=OTHER, x_mm=400.0, y_mm=0.0)
    with pytest.raises(SpecError, match="beside a pad that is flat"):
        Scene(pad=OWN, lay=Relief(()), neighbours=(beside,))
    with pytest.raises(SpecError, match="finite"):
        Neighbour(pad=OTHER, x_mm=float("inf"), y_mm=0.0)
