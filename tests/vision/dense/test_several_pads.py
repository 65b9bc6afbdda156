"""Several known pads in one frame, read in one search, against the truth of simulated frames."""

from functools import cache

import numpy as np
import pytest
from dense_frames import errors, frame_of, random_pad, small_camera

from padstudio.errors import SpecError
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.coding.generate import generate_pad
from padstudio.pad.coding.pad_spec import PadSpec
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance.scene import Neighbour, Scene
from padstudio.simulate.render import render
from padstudio.vision.cells.correlation import LayerIndex
from padstudio.vision.detector import Detector
from padstudio.vision.search import search as search_module

CAMERA = small_camera()
BESIDE_MM = 700.0


@cache
def pad_of(window, levels, ratio, seed):
    spec = PadSpec(
        window=window, levels=levels, rows=60, cols=60, ratio=ratio, cell_mm=10.0, quiet_mm=20,
        seed=seed,
    )  # fmt: skip
    return generate_pad(spec)


def pads():
    """Of different windows, levels and ratios."""
    return pad_of(5, 2, 5, 1), pad_of(4, 3, 4, 2), pad_of(5, 2, 3, 4)


def view(*shown, height_mm=1200.0, turn_deg=40.0, **scene):
    """A frame of one pad or two beside each other, and the true pose relative to each."""
    pose = look_at_pad(
        height_mm, tilt_deg=12, heading_deg=25, target_mm=(BESIDE_MM / 2 * (len(shown) - 1), 0)
    )
    beside = tuple(
        Neighbour(pad=pad, x_mm=BESIDE_MM, y_mm=0.0, turn_deg=turn_deg) for pad in shown[1:]
    )
    image = frame_of(pose, pad=shown[0], camera=CAMERA, neighbours=beside, **scene)
    return image, [pose, *(item.relative(pose) for item in beside)]


def assert_near(found, pose, percent=0.5):
    position, attitude = errors(found.pose, pose)
    assert position < percent
    assert attitude < 0.5


@pytest.mark.parametrize("height_mm", [700.0, 1200.0, 2500.0])
def test_each_of_two_pads_is_read_with_its_own_pose(height_mm):
    first, second, absent = pads()
    image, poses = view(first, second, height_mm=height_mm)
    found = Detector([absent, second, first], CAMERA).detect_all(image)
    truth = {pad_id(pad): pose for pad, pose in zip((first, second), poses, strict=True)}
    assert {item.pad_id for item in found} == set(truth)
    for item in found:
        assert_near(item, truth[item.pad_id])
        assert item.to_record("frame.png")["pad_id"] == item.pad_id


def test_the_order_of_the_pads_and_another_run_change_nothing():
    first, second, absent = pads()
    image, _ = view(first, second)
    runs = [
        Detector(known, CAMERA).detect_all(image)
        for known in ([first, second, absent], [absent, second, first], [first, second, absent])
    ]
    for run in runs[1:]:
        assert [item.pad_id for item in run] == [item.pad_id for item in runs[0]]
        for a, b in zip(run, runs[0], strict=True):
            np.testing.assert_array_equal(a.pose.position_mm, b.pose.position_mm)
            assert a.log10_false_alarm == b.log10_false_alarm


def test_the_best_one_comes_first():
    first, second, _ = pads()
    image, _ = view(first, second)
    found = Detector([first, second], CAMERA).detect_all(image)
    assert found[0].quality == "full"
    assert found[0].log10_false_alarm <= found[1].log10_false_alarm


@pytest.mark.parametrize("shown", [0, 1])
def test_where_one_is_asked_for_the_search_ends_with_the_one_in_view(shown, monkeypatch):
    known = pads()[:2]
    image, (pose,) = view(known[shown])
    looks = []
    plain_find = search_module.find

    def find(*args, **kwargs):
        looks.append(args)
        return plain_find(*args, **kwargs)

    monkeypatch.setattr(search_module, "find", find)
    assert_near(Detector(known[shown], CAMERA).detect(image), pose)
    alone = len(looks)
    found = Detector(known, CAMERA).detect(image)
    assert found.pad_id == pad_id(known[shown])
    assert_near(found, pose)
    assert len(looks) == 2 * alone
    both, _ = view(*known)
    looks.clear()
    assert Detector(known, CAMERA).detect(both).ok
    one = len(looks)
    assert len(Detector(known, CAMERA).detect_all(both)) == 2
    assert len(looks) > 2 * one


def test_a_video_follows_the_pad_in_view_and_then_the_next():
    known = pads()
    poses = [look_at_pad(1200.0 - 5 * step, tilt_deg=8, heading_deg=25) for step in range(4)]
    shown = [known[1], known[2]]
    frames = [frame_of(pose, pad=pad, camera=CAMERA) for pad in shown for pose in poses]
    bare = render(Scene(pad=None, ground="grass"), CAMERA, poses[0]).image
    frames.insert(2, bare)
    truth = [poses[0], poses[1], None, poses[2], poses[3], *poses]
    ids = [None if pose is None else pad_id(shown[number > 4]) for number, pose in enumerate(truth)]
    for options in ({}, {"smooth": True}, {"fuse": False}):
        found = list(Detector(known, CAMERA).track(frames, **options))
        assert [item.pad_id for item in found] == ids
        for item, pose in zip(found, truth, strict=True):
            if pose is not None:
                assert_near(item, pose)
                assert item.single is None or not item.single.is_outlier


def test_pads_that_are_not_in_view_are_not_found():
    first, second, third = pads()
    image, _ = view(first)
    (found,) = Detector([second, third], CAMERA).detect_all(image)
    assert not found.ok
    assert found.failure is not None
    assert found.pad_id is None


@pytest.mark.parametrize("ground", ["bricks", "grass"])
def test_bare_ground_shows_none_of_many(ground):
    pose = look_at_pad(1500.0, tilt_deg=15, heading_deg=20)
    image = render(Scene(pad=None, ground=ground), CAMERA, pose).image
    many = [*pads(), *(random_pad(seed, cells=(60, 12)) for seed in range(5))]
    (found,) = Detector(many, CAMERA).detect_all(image)
    assert not found.ok


@pytest.mark.parametrize("turn_deg", [0.0, 70.0])
def test_of_two_copies_one_is_read_and_never_a_mixture(turn_deg):
    first, second, _ = pads()
    image, poses = view(first, first, turn_deg=turn_deg)
    (found,) = Detector([first, second], CAMERA).detect_all(image)
    assert found.pad_id == pad_id(first)
    assert min(errors(found.pose, pose)[0] for pose in poses) < 0.5


def test_pads_of_other_channels_and_mixtures_of_colours_are_read_in_their_own_planes():
    first, second, _ = pads()
    mixed = second.with_crosstalk(np.eye(3) + 0.02)
    green = random_pad(5, cells=(60, 12), channels=("green", "blue"))
    image, poses = view(first, mixed)
    found = Detector([green, mixed, first], CAMERA).detect_all(image)
    truth = {pad_id(first): poses[0], pad_id(mixed): poses[1]}
    assert {item.pad_id for item in found} == set(truth)
    for item in found:
        assert_near(item, truth[item.pad_id])


def test_lattices_are_sought_once_for_all_pads(monkeypatch):
    first, *others = pads()
    image, _ = view(first)
    counts = {"find": 0, "attempts": []}
    plain_find, plain_locate = search_module.find, LayerIndex.locate

    def find(*args, **kwargs):
        counts["find"] += 1
        return plain_find(*args, **kwargs)

    def locate(self, cells, attempts=1):
        counts["attempts"].append(attempts)
        return plain_locate(self, cells, attempts)

    monkeypatch.setattr(search_module, "find", find)
    # What is left out as another pattern depends on the pads.
    monkeypatch.setattr(search_module, "is_foreign", lambda *_: False)
    monkeypatch.setattr(LayerIndex, "locate", locate)
    assert not Detector(others, CAMERA).detect(image).ok
    two = counts["find"]
    # Each lattice counts against all layers of all pads.
    assert counts["attempts"][0] == 4
    counts["find"] = 0
    assert not Detector(others[0], CAMERA).detect(image).ok
    assert two == counts["find"]


def test_one_pad_is_read_as_ever_whether_alone_or_in_a_list():
    first, _, _ = pads()
    image, poses = view(first)
    alone, listed = Detector(first, CAMERA).detect(image), Detector([first], CAMERA).detect(image)
    assert alone.pad_id == listed.pad_id == pad_id(first)
    np.testing.assert_array_equal(alone.pose.position_mm, listed.pose.position_mm)
    assert_near(alone, poses[0])
    assert [item.ok for item in Detector(first, CAMERA).track([image, image])] == [True, True]


def test_what_cannot_be_told_apart_or_followed_is_refused():
    first, second, _ = pads()
    scaled = Pad(
        tuple(Layer(item.channel, 2 * item.cell_mm, np.rot90(item.field)) for item in first.layers),
        levels=first.levels,
    )
    for known, code in (([], "no_pads"), ([first, first], "pads_alike"), ([first, scaled], None)):
        with pytest.raises(SpecError) as refused:
            Detector(known, CAMERA)
        assert refused.value.error_code == (code or "pads_alike")
    with pytest.raises(SpecError, match="one pad"):
        Detector([first, second], CAMERA, method="paper")
