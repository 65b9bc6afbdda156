"""What a frame without a pad costs is counted, and does not grow with the ground's texture."""

import numpy as np
import pytest
from dense_frames import frame_of, params, recorder, sample_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.vision.frame.prepare import find_stretch
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import faint_regions, find_regions
from padstudio.vision.search import search as search_module
from padstudio.vision.search.known_pads import KnownPad
from padstudio.vision.search.looks import Search
from padstudio.vision.search.search import Miss, sightings


def search_of(image):
    pad, pyramid = sample_pad(), Pyramid(image)
    camera, known = small_camera(), (KnownPad.of(pad),)
    return Search(pyramid, camera, find_stretch(pyramid), known, params(), recorder())


def ground(kind):
    pose = look_at_pad(1500.0, tilt_deg=15, heading_deg=20)
    return render(Scene(pad=None, ground=kind), small_camera(), pose, seed=2).image


def plaid():
    """Coloured lines at right angles, as promising as a ground can be."""
    y, x = np.mgrid[:480, :640]
    picture = np.stack([40 + 150 * ((x // w + y // w) % 2) for w in (12, 9, 7)], axis=-1)
    noise = np.random.default_rng(1).normal(0, 4, picture.shape)
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


def regions_of(frame):
    pad = sample_pad()
    *clear, whole = find_regions(frame.pyramid, pad)
    return [*clear, *faint_regions(frame.pyramid, pad, clear), whole]


@pytest.mark.parametrize("kind", ["gravel", "grass", "bricks", "asphalt", "plaid"])
def test_so_many_lattices_are_sought_and_compared_at_the_most(kind, monkeypatch):
    frame = search_of(plaid() if kind == "plaid" else ground(kind))
    sought = []
    plain = search_module.find

    def counted(*args, **kwargs):
        sought.append(args)
        return plain(*args, **kwargs)

    monkeypatch.setattr(search_module, "find", counted)
    found = list(sightings(frame, regions_of(frame)))
    assert isinstance(found[-1], Miss)
    assert all(isinstance(item, Miss) for item in found)
    search = frame.params.search
    assert len(sought) <= 2 * search.most_tries
    assert len(frame.lattices) <= 2 * (2 * search.most_tries + search.most_unsure)
    if kind in ("gravel", "asphalt"):
        assert not frame.lattices


def test_a_pad_promises_more_than_any_ground_of_no_order():
    pad = search_of(frame_of(look_at_pad(700.0, tilt_deg=25), camera=small_camera()))
    gravel = search_of(ground("gravel"))
    channels = ("red", "blue")
    promises = [
        max(
            frame.look(regions_of(frame)[0], level, channel).promise
            for level in (1, 2)
            for channel in channels
        )
        for frame in (pad, gravel)
    ]
    assert promises[0] > 0.4
    assert promises[1] < 0.15


def test_a_grey_picture_is_looked_at_once_and_in_its_middle_at_full_scale():
    pose = look_at_pad(1100.0, tilt_deg=12, heading_deg=33)
    colour = frame_of(pose, camera=small_camera())
    grey = np.repeat(colour.mean(axis=2, keepdims=True).round().astype(np.uint8), 3, axis=2)
    large = np.repeat(np.repeat(grey, 3, axis=0), 3, axis=1)
    frame = search_of(large)
    assert frame.stretch.grey
    assert len(frame.looked_at) == 1
    whole = find_regions(frame.pyramid, sample_pad())[-1:]
    assert min(level for _, level in frame.places(whole)) == 0
    assert search_of(colour).looked_at == search_of(colour).channels
