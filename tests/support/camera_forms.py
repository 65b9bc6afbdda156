"""Cameras written in the forms of other programs, by code of its own, and projected by OpenCV."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import NamedTuple

import cv2
import numpy as np
import yaml
from hypothesis import strategies as st


class TrueCamera(NamedTuple):
    """A camera in OpenCV's terms; a fisheye where ``fisheye``."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, ...]
    fisheye: bool

    @property
    def matrix(self):
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1.0]])


#: Rays in view, (100, 3).
RAYS = np.column_stack(
    [*(axis.ravel() for axis in np.meshgrid(*[np.linspace(-0.35, 0.35, 10)] * 2)), np.ones(100)]
)


def pixels(camera: TrueCamera):
    """Where OpenCV sees the rays, (100, 2)."""
    k, none = np.array(camera.distortion, float), np.zeros(3)
    project = cv2.fisheye.projectPoints if camera.fisheye else cv2.projectPoints
    if camera.fisheye:
        return project(RAYS[:, None], none, none, camera.matrix, k)[0][:, 0]
    return project(RAYS, none, none, camera.matrix, k)[0][:, 0]


def _coefficients(counts):
    small = st.floats(-0.02, 0.02).map(lambda v: round(v, 7))
    return st.sampled_from(counts).flatmap(
        lambda count: st.lists(small, min_size=count, max_size=count).map(tuple)
    )


@st.composite
def cameras(draw, radtan=(4, 5, 8), fisheye=True):
    """Cameras of any lens, or of radtan's with so many coefficients."""
    is_fisheye = fisheye and draw(st.booleans())
    width, height = draw(st.integers(200, 6000)), draw(st.integers(200, 6000))
    focal = st.floats(100, 5000).map(lambda v: round(v, 4))
    middle = st.floats(0.3, 0.7).map(lambda v: round(v, 4))
    return TrueCamera(
        width,
        height,
        draw(focal),
        draw(focal),
        width * draw(middle),
        height * draw(middle),
        draw(_coefficients((4,) if is_fisheye else radtan)),
        is_fisheye,
    )


def _square(camera):
    return camera._replace(fy=camera.fx)


def ros(camera, key="distortion_coefficients"):
    count = len(camera.distortion)
    model = (
        "equidistant" if camera.fisheye else "rational_polynomial" if count == 8 else "plumb_bob"
    )
    matrix = {"rows": 3, "cols": 3, "data": camera.matrix.ravel().tolist()}
    return {
        "image_width": camera.width,
        "image_height": camera.height,
        "camera_name": "front",
        "camera_matrix": matrix,
        "distortion_model": model,
        key: {"rows": 1, "cols": count, "data": list(camera.distortion)},
        "projection_matrix": {"rows": 3, "cols": 4, "data": [0.0] * 12},
    }


def ros_message(camera):
    file = ros(camera)
    return {
        "header": {"stamp": {"sec": 1}, "frame_id": "front"},
        "height": camera.height,
        "width": camera.width,
        "distortion_model": file["distortion_model"],
        "d": list(camera.distortion),
        "k": camera.matrix.ravel().tolist(),
        "r": [1.0] * 9,
        "p": [0.0] * 12,
        "binning_x": 0,
        "binning_y": 0,
        "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False},
    }


def script(camera):
    """As scripts write what OpenCV's functions gave them."""
    return {
        "mtx": camera.matrix.tolist(),
        "dist": [list(camera.distortion)],
        "fisheye": camera.fisheye,
        "img_size": [camera.width, camera.height],
        "rms_error": 0.3,
    }


def opencv(camera, ending):
    """As OpenCV's FileStorage writes it: yml, xml or json."""
    flags = cv2.FileStorage_WRITE | cv2.FileStorage_MEMORY
    storage = cv2.FileStorage(f"camera.{ending}", flags)
    storage.write("calibration_time", "Mon 3 Feb 2025")
    storage.write("image_width", camera.width)
    storage.write("image_height", camera.height)
    storage.write("flags", 4)
    storage.write("fisheye_model", int(camera.fisheye))
    storage.write("camera_matrix", camera.matrix)
    storage.write("distortion_coefficients", np.array(camera.distortion)[:, None])
    storage.write("avg_reprojection_error", 0.25)
    return storage.releaseAndGetString()


def kalibr(camera):
    chain = {
        "cam_overlaps": [],
        "camera_model": "pinhole",
        "distortion_coeffs": list(camera.distortion),
        "distortion_model": "equidistant" if camera.fisheye else "radtan",
        "intrinsics": [camera.fx, camera.fy, camera.cx, camera.cy],
        "resolution": [camera.width, camera.height],
        "rostopic": "/front/image_raw",
    }
    return {"cam0": chain}


def photonvision(camera):
    return {
        "resolution": {"width": float(camera.width), "height": float(camera.height)},
        "cameraIntrinsics": {
            "rows": 3,
            "cols": 3,
            "type": 6,
            "data": camera.matrix.ravel().tolist(),
        },
        "distCoeffs": {
            "rows": 1,
            "cols": len(camera.distortion),
            "type": 6,
            "data": list(camera.distortion),
        },
        "calobjectWarp": [1e-4, 2e-4],
        "observations": [{"snapshotName": "a.png", "locationInImageSpace": [{"x": 1, "y": 2}]}],
        "lensmodel": "LENSMODEL_OPENCV",
    }


def colmap(camera):
    """A line of cameras.txt: pixels from the corner of the first one."""
    k = camera.distortion
    name = "OPENCV_FISHEYE" if camera.fisheye else "OPENCV" if len(k) == 4 else "FULL_OPENCV"
    k = k if len(k) == 4 else (*k, 0.0, 0.0, 0.0)[:8]
    values = [camera.fx, camera.fy, camera.cx + 0.5, camera.cy + 0.5, *k]
    words = " ".join(repr(v) for v in values)
    return f"# Camera list\n1 {name} {camera.width} {camera.height} {words}\n"


def opensfm(camera):
    """OpenSfM's normalised coordinates: (pixel + 0.5 - size / 2) / longer side."""
    longer = max(camera.width, camera.height)
    names = ("k1", "k2", "k3", "k4") if camera.fisheye else ("k1", "k2", "p1", "p2", "k3")
    return {
        "v2 maker front": {
            "projection_type": "fisheye_opencv" if camera.fisheye else "brown",
            "width": camera.width,
            "height": camera.height,
            "focal_x": camera.fx / longer,
            "focal_y": camera.fy / longer,
            "c_x": (camera.cx + 0.5 - camera.width / 2) / longer,
            "c_y": (camera.cy + 0.5 - camera.height / 2) / longer,
            **dict(zip(names, (*camera.distortion, 0.0), strict=False)),
        }
    }


def agisoft(camera):
    """Metashape's: f is fy, b1 is fx - fy, p1 and p2 change places, cx and cy from the middle."""
    names = ("k1", "k2", "k3", "k4") if camera.fisheye else ("k1", "k2", "p2", "p1", "k3")
    values = {
        "projection": "fisheye" if camera.fisheye else "frame",
        "width": camera.width,
        "height": camera.height,
        "f": camera.fy,
        "cx": camera.cx + 0.5 - camera.width / 2,
        "cy": camera.cy + 0.5 - camera.height / 2,
        "b1": camera.fx - camera.fy,
        **dict(zip(names, camera.distortion, strict=False)),
        "date": "2025-02-03T10:00:00Z",
    }
    elements = "".join(
        f"  <{key}>{value!r}</{key}>\n".replace("'", "") for key, value in values.items()
    )
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<calibration>\n{elements}</calibration>\n'


def mrcal(camera):
    values = [camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion]
    return (
        "# made by hand\n{\n"
        f"    'lensmodel':  'LENSMODEL_OPENCV{len(camera.distortion)}',\n"
        "    # intrinsics are fx,fy,cx,cy,distortion0,...\n"
        f"    'intrinsics': [ {', '.join(map(repr, values))},],\n"
        "    'extrinsics': [ 0, 0, 0, 0, 0, 0,],\n"
        f"    'imagersize': [ {camera.width}, {camera.height},],\n"
        "    'icam_intrinsics': 0,\n    'optimization_inputs': b'P)j~w#4'\n}\n"
    )


def orbslam(camera):
    names = ("k1", "k2", "k3", "k4") if camera.fisheye else ("k1", "k2", "p1", "p2", "k3")
    return {
        "File.version": "1.0",
        "Camera.type": "KannalaBrandt8" if camera.fisheye else "PinHole",
        "Camera1.fx": camera.fx,
        "Camera1.fy": camera.fy,
        "Camera1.cx": camera.cx,
        "Camera1.cy": camera.cy,
        **{f"Camera1.{k}": v for k, v in zip(names, camera.distortion, strict=False)},
        "Camera.width": camera.width,
        "Camera.height": camera.height,
        "Camera.fps": 30,
        "Camera.RGB": 1,
        "ORBextractor.nFeatures": 1250,
    }


ANY, FOUR, FIVE = cameras(), cameras((4,)), cameras((4, 5))
#: Forms that are mappings: how they are written, and the cameras that they can hold.
MAPPINGS: dict[str, tuple[Callable, st.SearchStrategy]] = {
    "ros": (ros, ANY),
    "ros message": (ros_message, ANY),
    "script": (script, ANY),
    "kalibr": (kalibr, FOUR),
    "photonvision": (photonvision, cameras((4, 5, 8), fisheye=False)),
    "opensfm": (opensfm, FIVE),
    "orbslam": (orbslam, FIVE),
}
#: Forms that are texts.
TEXTS: dict[str, tuple[Callable, st.SearchStrategy]] = {
    "opencv yml": (lambda camera: opencv(camera, "yml"), ANY),
    "opencv xml": (lambda camera: opencv(camera, "xml"), ANY),
    "opencv json": (lambda camera: opencv(camera, "json"), ANY),
    "colmap": (colmap, ANY),
    "agisoft": (agisoft, FIVE),
    "mrcal": (mrcal, cameras(fisheye=False)),
}


def as_yaml(values):
    return yaml.safe_dump(values, sort_keys=False)


def as_json(values):
    return json.dumps(values, indent=1)
