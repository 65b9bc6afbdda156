"""Simulated frames and made-up stage outputs for the tests of the paper's method."""

from __future__ import annotations

from functools import cache

import numpy as np
from places import FOOTAGE

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, rotation_angle_deg
from padstudio.pad.spec import Pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.vision.baseline.edges import EdgeMap
from padstudio.vision.baseline.hough import Lines
from padstudio.vision.frame.pyramid import Plane

WIDTH, HEIGHT = 640, 480


@cache
def sample_pad():
    return Pad.load(FOOTAGE / "pad_a.json")


@cache
def paper_camera():
    """The paper's camera: f = 1886 px, 2720 x 1530."""
    return Camera.load(FOOTAGE / "camera_drone_2k7.yaml")


def small_camera(distortion=(0.0, 0.0, 0.0, 0.0)):
    matrix = np.array([[440.0, 0, (WIDTH - 1) / 2], [0, 440.0, (HEIGHT - 1) / 2], [0, 0, 1]])
    return Camera(WIDTH, HEIGHT, matrix, np.array(distortion))


def frame_of(pose, *, pad=None, camera=None, imaging=None, seed=0, **scene):
    pad = sample_pad() if pad is None else pad
    camera = camera or paper_camera()
    return render(Scene(pad=pad, **scene), camera, pose, imaging, seed).image


def errors(found: Pose, true: Pose) -> tuple[float, float]:
    """Position in percent of the height, attitude in degrees."""
    off = float(np.linalg.norm(found.position_mm - true.position_mm))
    return 100 * off / float(true.position_mm[2]), rotation_angle_deg(found.rotation, true.rotation)


def edge_map(camera=None, channel="red"):
    """An edge map without edges, for stages that only need its frame."""
    nothing = np.zeros((HEIGHT, WIDTH), np.uint8)
    plane = Plane(nothing.astype(np.float32), channel, 0, 0, 0)
    return EdgeMap(
        nothing,
        nothing,
        np.zeros((0, 2)),
        np.zeros((0, 2), np.int32),
        np.zeros(0, np.int32),
        plane,
        camera or small_camera(),
    )


def grid_lines(plane_from_lattice, columns, rows, *, intruders=(), noise_px=0.0, seed=0):
    """Lines of a lattice in the picture, longest first; intruders are pairs of points."""
    rng = np.random.default_rng(seed)
    ends = []
    for number in columns:
        ends.append([(number, min(rows)), (number, max(rows))])
    for number in rows:
        ends.append([(min(columns), number), (max(columns), number)])
    lattice = np.array(ends, float).reshape(-1, 2)
    h = np.column_stack([lattice, np.ones(len(lattice))]) @ plane_from_lattice.T
    points = (h[:, :2] / h[:, 2:]).reshape(-1, 2, 2)
    points = points + rng.normal(0, noise_px, points.shape) if noise_px else points
    if len(intruders):
        points = np.concatenate([points, np.array(intruders, float)])
    support = np.linalg.norm(points[:, 1] - points[:, 0], axis=1)
    order = np.argsort(-support, kind="stable")
    return Lines(points[order], support[order], points[order], edge_map())


def lattice_view(pose: Pose, camera: Camera, cell_mm: float):
    """(3, 3) map of lattice coordinates (column, row, 1) to pixels of an ideal lens.

    The lattice's origin is the pad's, columns run along X, rows against Y.
    """
    to_pad = np.array([[cell_mm, 0, 0], [0, -cell_mm, 0], [0, 0, 1.0]])
    back = pose.rotation.T
    plane = np.column_stack([back[:, 0], back[:, 1], -back @ pose.position_mm])
    return camera.matrix @ plane @ to_pad
