"""From the printer to the pose: sheets cut and joined, photographed, detected."""

from __future__ import annotations

import io
from pathlib import Path

import cv2
import numpy as np
import pytest
from measure_print import assemble, pages
from numpy.typing import NDArray
from places import FOOTAGE

from padstudio import Camera, Detector, Pad, Pose
from padstudio.pad.sheets.tiling import SheetOptions
from padstudio.render.painters.options import PrintOptions
from padstudio.render.pdf.sheets import write_sheets
from padstudio.simulate.radiance.inks import Inks
from padstudio.simulate.sensor import Imaging, expose

DPI = 80
SCALE = DPI / 25.4
CAMERA = Camera(1360, 765, np.array([[943.0, 0, 679.5], [0, 943.0, 382.0], [0, 0, 1]]))


@pytest.mark.parametrize("joint", ["butt", "overlap"])
def test_joined_sheets_give_the_pose_of_the_camera(joint: str, tmp_path: Path) -> None:
    pad = Pad.load(FOOTAGE / "pad_a.json")
    out = io.BytesIO()
    options = SheetOptions(paper="A3", joint=joint)  # type: ignore[arg-type]
    plan = write_sheets(pad, out, PrintOptions(sheets=options, assembly_map=False))
    joined = assemble(plan, pages(out.getvalue(), tmp_path, DPI), SCALE)
    pose = look(position_mm=[140.0, -90.0, 900.0], rvec=[0.12, -0.08, 0.4])
    detection = Detector(pad, CAMERA).detect(photograph(joined, pose))
    assert detection.pose is not None, detection.failure
    np.testing.assert_allclose(detection.pose.position_mm, pose.position_mm, atol=1.5)
    between = detection.pose.rotation.T @ pose.rotation
    assert np.linalg.norm(cv2.Rodrigues(between)[0]) < np.radians(0.1)


def look(*, position_mm: list[float], rvec: list[float]) -> Pose:
    """A camera that looks down on the pad, turned a little."""
    down = np.diag([1.0, -1.0, -1.0])
    turn = np.asarray(cv2.Rodrigues(np.array(rvec))[0])
    return Pose(np.array(position_mm), turn @ down)


def photograph(page: NDArray[np.uint8], pose: Pose) -> NDArray[np.uint8]:
    """A noisy picture of a printed page on grey ground, in the inks of an office printer."""
    finer = 2
    matrix = CAMERA.matrix * finer
    matrix[:2, 2] += (finer - 1) / 2
    matrix[2, 2] = 1.0
    pad_of_pixel = np.array(
        [
            [1 / SCALE, 0, (0.5 - page.shape[1] / 2) / SCALE],
            [0, -1 / SCALE, (page.shape[0] / 2 - 0.5) / SCALE],
            [0, 0, 1],
        ]
    )
    T = pose.T_camera_pad
    to_image = matrix @ np.column_stack([T[:3, 0], T[:3, 1], T[:3, 3]]) @ pad_of_pixel
    size = (CAMERA.width * finer, CAMERA.height * finer)
    colors = cv2.warpPerspective(page, to_image, size, borderValue=(70, 80, 60))
    colors = cv2.resize(colors, (CAMERA.width, CAMERA.height), interpolation=cv2.INTER_AREA)
    return expose(Inks().reflectance(colors), Imaging(), np.random.default_rng(1))
