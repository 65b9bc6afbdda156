"""Simulated frames and made-up stage inputs for the tests of the dense method."""

from __future__ import annotations

from functools import cache

import numpy as np
from paper_frames import errors, frame_of, sample_pad, small_camera

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.sensor import Imaging
from padstudio.vision.cells.sampling import CellGrid, relative_field
from padstudio.vision.frame.prepare import find_stretch, take_channel
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import find_regions
from padstudio.vision.pose.edge_points import visible_borders
from padstudio.vision.search.edges import find_edges
from padstudio.vision.stage.params import DetectorParams, SearchParams
from padstudio.vision.stage.trace import Recorder

__all__ = ["errors", "frame_of", "sample_pad", "small_camera"]

IDEAL = Imaging.ideal()


def random_pad(seed, *, levels=2, cells=(125, 25), cell_mm=(10.0, 50.0), channels=("red", "blue")):
    """A pad of random fields; large windows of it are as good as unique."""
    rng = np.random.default_rng(seed)
    return Pad(
        tuple(
            Layer(channel, size, rng.integers(0, levels, (count, count)))
            for channel, count, size in zip(channels, cells, cell_mm, strict=True)
        ),
        levels=levels,
    )


def random_pose(rng, height_mm, *, tilt_deg=30.0, reach_mm=0.0) -> Pose:
    x, y = rng.uniform(-reach_mm, reach_mm, 2)
    return look_at_pad(
        height_mm,
        tilt_deg=rng.uniform(0, tilt_deg),
        heading_deg=rng.uniform(0, 360),
        tilt_towards_deg=rng.uniform(0, 360),
        target_mm=(x, y),
    )


@cache
def near_view():
    """A frame, its pyramid and its pose, near enough for both layers."""
    pose = look_at_pad(600.0, tilt_deg=20, heading_deg=35, tilt_towards_deg=140)
    image = frame_of(pose, camera=small_camera())
    return image, Pyramid(image), pose


def edges_of(image, channel="red", level=0, camera=None):
    pyramid = Pyramid(image)
    plane = take_channel(pyramid, find_stretch(pyramid), channel, level)
    edges = find_edges(plane, camera or small_camera(), SearchParams())
    region = find_regions(pyramid, sample_pad())[0]
    return edges.take(region.holds(edges.xy))


def recorder():
    return Recorder(keep=False)


def params():
    return DetectorParams()


def all_borders(pad, layer):
    """A layer's borders, from a camera that sees all of it."""
    reach = max(pad.size_mm)
    camera = Camera(4000, 4000, np.array([[4000.0, 0, 1999.5], [0, 4000.0, 1999.5], [0, 0, 1]]))
    return visible_borders(pad, layer, camera, MovingPose(look_at_pad(2 * reach)), 10**6)


def borders_amid(pad, layer, cells):
    """Those of `all_borders` within so many cells of the middle, along both axes."""
    borders = all_borders(pad, layer)
    near = np.abs(borders.points_mm[:, :2]).max(axis=1) < cells * layer.cell_mm
    return borders.take(np.flatnonzero(near))


def cell_grid(levels, channel="red", column0=0, row0=0, seen=None):
    """Cells as if read without error from levels (R, C)."""
    levels = np.asarray(levels, np.uint8)
    seen = np.ones(levels.shape, bool) if seen is None else seen
    rows, cols = levels.shape
    xy = np.stack(np.meshgrid(np.arange(cols), np.arange(rows)), axis=-1) * 10.0
    relative = np.where(seen, relative_field(levels), 0).astype(np.float32)
    return CellGrid(channel, column0, row0, levels * np.float32(60), seen, relative, xy, 10.0)


def seen_by(moving, points_mm, row_time=0.0):
    """Pad points (N, 3) in the frame of a camera that moves, at row times: the plain form."""
    s = np.broadcast_to(np.asarray(row_time, float), (len(points_mm),))[:, None]
    seen = (points_mm - moving.pose.position_mm - s * moving.shift_mm) @ moving.pose.rotation
    return seen - s * np.cross(moving.rotvec, seen)


def pad_normal(pose):
    """The pad plane's normal, away from the camera, in the camera frame."""
    return -pose.rotation.T[:, 2]
