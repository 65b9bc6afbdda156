"""A pattern that is no pad's is compared once, and hides no pad."""

from dataclasses import replace

import numpy as np
import pytest
from dense_frames import errors, frame_of, params, random_pad, recorder, sample_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.radiance.scene import Neighbour
from padstudio.vision.detector import Detector
from padstudio.vision.frame.prepare import find_stretch
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import find_regions
from padstudio.vision.search.foreign import explained, within
from padstudio.vision.search.known_pads import KnownPad
from padstudio.vision.search.looks import Search
from padstudio.vision.search.search import Miss, Sighting, sightings

FOREIGN = random_pad(77)


def search_of(image):
    pyramid, pad = Pyramid(image), sample_pad()
    known = (KnownPad.of(pad),)
    frame = Search(pyramid, small_camera(), find_stretch(pyramid), known, params(), recorder())
    return frame, find_regions(pyramid, pad)


def view(pad, height_mm, tilt_deg):
    pose = look_at_pad(height_mm, tilt_deg=tilt_deg, heading_deg=33, tilt_towards_deg=140)
    return frame_of(pose, pad=pad, camera=small_camera())


@pytest.mark.parametrize(("height_mm", "tilt_deg"), [(600.0, 5), (900.0, 30), (1200.0, 15)])
def test_a_foreign_pad_is_compared_few_times_and_the_pad_is_none(height_mm, tilt_deg):
    frame, regions = search_of(view(FOREIGN, height_mm, tilt_deg))
    found = list(sightings(frame, regions))
    assert [type(item) for item in found] == [Miss]
    assert frame.foreign
    assert len(frame.lattices) <= 4
    frame, regions = search_of(view(sample_pad(), height_mm, tilt_deg))
    assert isinstance(next(sightings(frame, regions)), Sighting)
    assert not frame.foreign


@pytest.mark.parametrize(("gap_mm", "turn_deg"), [(60.0, 0.0), (400.0, 40.0)])
@pytest.mark.parametrize("nearer", ["pad", "foreign"])
def test_a_pad_beside_a_foreign_one_is_read(nearer, gap_mm, turn_deg):
    pad = sample_pad()
    shown = (pad, FOREIGN) if nearer == "pad" else (FOREIGN, pad)
    away = (pad.size_mm[0] + FOREIGN.size_mm[0]) / 2 + gap_mm
    beside = Neighbour(pad=shown[1], x_mm=away, y_mm=0.0, turn_deg=turn_deg)
    pose = look_at_pad(
        1500.0, tilt_deg=35, heading_deg=5, tilt_towards_deg=270, target_mm=(away / 2, 0)
    )
    image = frame_of(pose, pad=shown[0], camera=small_camera(), neighbours=(beside,))
    found = Detector(pad, small_camera()).detect(image)
    assert found.ok
    assert errors(found.pose, pose if nearer == "pad" else beside.relative(pose))[0] < 0.5


def test_a_lattice_holds_its_own_cells_alone():
    frame, regions = search_of(view(FOREIGN, 900.0, 10))
    list(sightings(frame, regions))
    lattice = frame.foreign[0]
    (c0, c1), (r0, r1) = lattice.columns, lattice.rows
    turn = np.array([[0, -1.0, c1], [1.0, 0, r0], [0, 0, 1]])
    part = replace(
        lattice,
        ray_from_lattice=lattice.ray_from_lattice @ turn,
        columns=(0, r1 - r0),
        rows=(0, c1 - c0),
    )
    assert lattice.holds(part)
    assert part.holds(lattice)
    assert not lattice.holds(lattice.widened())
    finer = replace(
        lattice,
        ray_from_lattice=lattice.ray_from_lattice @ np.diag([0.5, 0.5, 1.0]),
        columns=(2 * c0, 2 * c1),
        rows=(2 * r0, 2 * r1),
    )
    assert not lattice.holds(finer)
    middle = lattice.to_rays(np.array([[(c0 + c1) / 2 + 0.5, (r0 + r1) / 2], [c1 + 3.0, r0]]))
    assert within(lattice, middle).tolist() == [True, False]
    lines = lattice.to_rays(np.array([[c0 + 1.0, r0 + 0.5], [c0 + 1.5, r0 + 1.5]]))
    assert explained(lattice, lines).tolist() == [True, False]
