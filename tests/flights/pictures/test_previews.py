from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from padstudio.errors import ImageError
from padstudio.flights.pictures.previews import draw_pose, preview
from padstudio.flights.pictures.stages import PictureJob
from padstudio.flights.tasks.detectors import Recipe
from padstudio.flights.tasks.frames import StillPart
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad

PAD = (
    '{"format": "padstudio.pad", "version": 1, "name": "tiny", "window": 2, "levels": 2, '
    '"layers": [{"channel": "red", "cell_mm": 100.0, "codes": ["001", "011", "110"]}]}'
)
CAMERA = Camera(800, 600, [[600, 0, 399.5], [0, 600, 299.5], [0, 0, 1]], [0, 0, 0, 0])
SIZE_MM = (300.0, 300.0)


def _pose(height_mm: float, tilt_deg: float = 0.0) -> Pose:
    return look_at_pad(height_mm, tilt_deg=tilt_deg, heading_deg=30.0, target_mm=(20.0, -10.0))


def _record(height_mm: float, tilt_deg: float = 0.0) -> dict[str, object]:
    pose = _pose(height_mm, tilt_deg)
    return {
        "status": "ok",
        "position_mm": pose.position_mm.tolist(),
        "quaternion_xyzw": pose.quaternion_xyzw.tolist(),
    }


def _job(folder: Path, picture: np.ndarray) -> PictureJob:
    path = folder / "still.png"
    cv2.imwrite(str(path), picture)
    recipe = Recipe(PAD, CAMERA.to_ros_yaml())
    return PictureJob(recipe, StillPart(str(path), path.name), folder, 10_000_000)


@pytest.mark.parametrize(("height_mm", "tilt_deg"), [(1000.0, 0.0), (700.0, 25.0)])
def test_the_pad_is_drawn_where_the_camera_sees_it(height_mm: float, tilt_deg: float) -> None:
    pose = _pose(height_mm, tilt_deg)
    picture = np.zeros((300, 400, 3), np.uint8)
    draw_pose(picture, CAMERA, SIZE_MM, _record(height_mm, tilt_deg), 0.5)
    edges_mm = np.array([[0, 150, 0], [150, 40, 0], [-60, -150, 0], [-150, 0, 0]], float)
    rotation, origin = pose.rotation, pose.position_mm
    pixels = (CAMERA.project((edges_mm - origin) @ rotation) + 0.5) * 0.5 - 0.5
    for x, y in pixels.round().astype(int):
        assert picture[y - 1 : y + 2, x - 1 : x + 2].max() > 150
    assert picture[2, 2].max() == 0


def test_a_camera_amid_the_pad_draws_what_lies_ahead() -> None:
    picture = np.zeros((300, 400, 3), np.uint8)
    draw_pose(picture, CAMERA, SIZE_MM, _record(12.0, 70.0), 0.5)
    assert picture.any()


def test_frames_come_as_jpeg_no_wider_than_asked(tmp_path: Path) -> None:
    job = _job(tmp_path, np.full((600, 800, 3), 90, np.uint8))
    for width, shown in ((200, (150, 200, 3)), (4000, (600, 800, 3))):
        data = np.frombuffer(preview(job, _record(900.0), width), np.uint8)
        picture = cv2.imdecode(data, cv2.IMREAD_COLOR)
        assert picture.shape == shown
        assert np.ptp(picture) > 100
    failed = np.frombuffer(preview(job, {"status": "failed"}, 200), np.uint8)
    assert np.ptp(cv2.imdecode(failed, cv2.IMREAD_COLOR)) < 4


def test_a_frame_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    job = _job(tmp_path, np.full((600, 800, 3), 90, np.uint8))
    (tmp_path / "still.png").write_bytes(b"no picture")
    with pytest.raises(ImageError):
        preview(job, _record(900.0), 200)
