"""What lies in memory beyond a picture says nothing: neither behind its rows nor after them."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from av import VideoFrame
from dense_frames import near_view, params, random_pad, sample_pad, small_camera
from hypothesis import given
from hypothesis import strategies as st

from padstudio.arrays import YuvFrame
from padstudio.flights.tasks import proxies
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.media.video_frames import to_frame
from padstudio.vision.cells import cells_kernel
from padstudio.vision.detector import Detector
from padstudio.vision.frame.pixels_kernel import values_at
from padstudio.vision.frame.prepare import find_denoise
from padstudio.vision.frame.yuv import YuvPyramid
from padstudio.vision.pose.edge_points import find_edge_points, visible_borders

FILLS = (0, 255, None)
SIDES = st.integers(16, 90)
PADDING = st.integers(0, 64)


def padded(plane, by, fill):
    """A plane in wider rows and with more after them; random there where no value is given."""
    height, width = plane.shape
    rows = np.full((height + 3, width + by), 0 if fill is None else fill, np.uint8)
    if fill is None:
        rows[:] = np.random.default_rng(by).integers(0, 256, rows.shape)
    rows[:height, :width] = plane
    return rows[:height]


def planes(seed, width, height):
    rng = np.random.default_rng(seed)
    half = -(-height // 2), -(-width // 2)
    sizes = (height, width), half, half, (height, width, 3)
    y, u, v, bgr = (rng.integers(0, 256, size).astype(np.uint8) for size in sizes)
    return YuvFrame(y, u, v, width, "bt601", True, lambda: bgr)


def fillings(frame, by):
    """The frame without padding, then with several kinds of it."""
    yield frame
    for fill in FILLS:
        y = padded(frame.y, by, fill)
        u, v = (padded(plane, (by + 1) // 2, fill) for plane in (frame.u, frame.v))
        yield replace(frame, y=y, u=u, v=v)


def all_the_same(results):
    first, *others = results
    for other in others:
        np.testing.assert_array_equal(other, first)


@given(st.integers(0, 10**6), SIDES, SIDES, PADDING, st.integers(0, 2))
def test_cells_are_read_alike(seed, width, height, by, level):
    frame = planes(seed, width, height)
    # Between pixels, up to the sides and a little beyond.
    x, y = np.meshgrid(np.arange(-1, width + 1, 0.25), np.arange(-1, height + 1, 0.25))
    xy, seen = np.stack([x, y], axis=-1), np.ones(x.shape, bool)
    for channel in ("red", "green", "blue"):
        windows = (YuvPyramid(f).window(channel, level) for f in fillings(frame, by))
        all_the_same([cells_kernel.sample(window, xy, seen) for window in windows])


@given(st.integers(0, 10**6), SIDES, SIDES, PADDING)
def test_halved_planes_single_pixels_and_impulses_are_alike(seed, width, height, by):
    frame = planes(seed, width, height)
    x, y = np.meshgrid(np.arange(float(width)), np.arange(float(height)))
    xy = np.stack([x, y], axis=-1).reshape(-1, 2)
    found = [YuvPyramid(f) for f in fillings(frame, by)]
    for channel in ("red", "blue"):
        all_the_same([values_at(pyramid.window(channel, 0), xy) for pyramid in found])
        for level in (1, 2):
            windows = [pyramid.window(channel, level) for pyramid in found]
            all_the_same([w.values[:, : w.width] for w in windows])
            all_the_same([w.colours[:, : w.width] for w in windows])
    all_the_same([find_denoise(pyramid.brightness, 0.01).impulses for pyramid in found])


@given(st.integers(0, 10**6), SIDES, SIDES, PADDING, st.integers(0, 1))
def test_borders_are_found_alike_up_to_the_sides(seed, width, height, by, level):
    width, height = width + 44, height + 44
    frame, pad = planes(seed, width, height), random_pad(1)
    middle = (width - 1) / 2, (height - 1) / 2
    matrix = np.array([[100.0, 0, middle[0]], [0, 100.0, middle[1]], [0, 0, 1]])
    camera = Camera(width, height, matrix, np.zeros(5))
    rng = np.random.default_rng(seed)
    pose = MovingPose(look_at_pad(rng.uniform(50, 150), heading_deg=rng.uniform(0, 360)))
    for layer in pad.layers:
        borders = visible_borders(pad, layer, camera, pose, 10**4)
        windows = (YuvPyramid(f).window(layer.channel, level) for f in fillings(frame, by))
        found = [find_edge_points(borders, window, camera, pose, 3.0) for window in windows]
        assert level or layer.channel == "blue" or len(found[0].xy)
        for figures in zip(*((f.xy, f.weight, f.blur_px2) for f in found), strict=True):
            all_the_same(figures)


@given(st.integers(0, 10**6), SIDES, SIDES, PADDING, st.sampled_from(["bt601", "bt709"]))
def test_proxies_are_alike(seed, width, height, by, standard):
    frame = replace(planes(seed, width, height), standard=standard)
    assert len({proxies.encode(0, 0.0, f).jpeg for f in fillings(frame, by)}) == 1


@pytest.mark.parametrize("size", [(64, 48), (63, 47), (90, 50), (97, 33), (1286, 94)])
def test_a_decoded_frames_colours_are_alike(size):
    seen = []
    for fill in FILLS:
        rng = np.random.default_rng(size[0])
        frame = VideoFrame(*size, "yuv420p")
        frame.colorspace = 5
        for plane in frame.planes:
            shown = rng.integers(0, 256, (plane.height, plane.width)).astype(np.uint8)
            plane.update(padded(shown, plane.line_size - plane.width, fill).tobytes())
        seen.append(to_frame(frame, 0, 10**8))
    assert isinstance(seen[0], YuvFrame)
    all_the_same([frame.bgr for frame in seen])


@pytest.mark.parametrize("width", [638, 639])
def test_frames_are_followed_alike(width):
    image, _, _ = near_view()
    assert image.shape[1] >= width
    bgr = np.ascontiguousarray(image[:, :width])
    y, cr, cb = cv2.split(cv2.cvtColor(bgr, cv2.COLOR_BGR2YCrCb))
    size = -(-width // 2), -(-len(y) // 2)
    u, v = (cv2.resize(c, size, interpolation=cv2.INTER_AREA) for c in (cb, cr))
    frame = YuvFrame(y, u, v, width, "bt601", True, lambda: bgr)
    whole = small_camera()
    camera = Camera(width, len(y), whole.matrix, whole.distortion)
    told = []
    for filled in fillings(frame, 64):
        *_, found = Detector(sample_pad(), camera, params=params()).track([filled] * 3)
        assert found.ok
        told.append((*found.pose.position_mm, *found.pose.rotation.ravel(), found.cells_wrong))
    all_the_same(told)


@pytest.mark.parametrize("method", ["dense", "paper"])
def test_pictures_in_wider_rows_are_read_alike(method):
    image, _, _ = near_view()
    wide = [cv2.merge([padded(c, 37, fill) for c in cv2.split(image)]) for fill in FILLS]
    told = []
    for picture in (image, *(rows[:, : image.shape[1]] for rows in wide)):
        found = Detector(sample_pad(), small_camera(), method=method).detect(picture)
        assert found.ok
        told.append((*found.pose.position_mm, *found.pose.rotation.ravel(), found.cells_wrong))
    all_the_same(told)
