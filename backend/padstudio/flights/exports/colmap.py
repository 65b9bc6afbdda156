"""A COLMAP text model: cameras.txt, images.txt and an empty points3D.txt, as a zip."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import PurePosixPath

from padstudio.flights.exports.byte_stream import ByteStream
from padstudio.flights.exports.frames.cameras import FrameCameras
from padstudio.flights.exports.options import ExportOptions, Record, full_poses
from padstudio.geometry.camera import Camera
from padstudio.geometry.camera_files.writing import colmap_cameras
from padstudio.geometry.pose import Pose

_IMAGES = """\
# Image list with two lines of data per image:
#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
#   POINTS2D[] as (X, Y, POINT3D_ID)
# world to camera; the world is the pad frame, metres: X right and Y up the page, Z out of it
# camera: x right, y down, z forward; frames without a pose of quality full are left out
"""
_POINTS = "# 3D point list: none\n"


def write_colmap(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """A zip with the three files of a sparse model.

    Poses of which only range and bearing can be used are left out: a reconstruction takes
    positions and attitudes for known. Stills are named as they are; frame 412 of flight.mp4 is
    ``flight/000412.png``. There is a camera for each size of frames.

    Raises
    ------
    SpecError
        If no camera is given.

    References
    ----------
    https://colmap.github.io/format.html
    """
    return _write(records, options, options.need_cameras("a COLMAP model"))


def _write(
    records: Iterable[Record], options: ExportOptions, cameras: FrameCameras
) -> Iterator[bytes]:
    stream = ByteStream()
    numbers: dict[Camera, int] = {}
    names = _Names()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        with archive.open(_member("images.txt"), "w", force_zip64=True) as images:
            images.write(_IMAGES.encode())
            found = full_poses(records, "a COLMAP model")
            for number, (record, pose, _) in enumerate(found, 1):
                camera = cameras.of(record)
                assert camera is not None
                camera_id = numbers.setdefault(camera, len(numbers) + 1)
                name = names.free(image_name(record, options.name_of(record)), number)
                images.write(_image_lines(pose, number, camera_id, name).encode())
                yield stream.take()
        text = colmap_cameras([camera.fields for camera in numbers])
        archive.writestr(_member("cameras.txt"), text)
        archive.writestr(_member("points3D.txt"), _POINTS)
    yield stream.take()


def _member(name: str) -> zipfile.ZipInfo:
    """A member whose bytes do not hang on the time of day."""
    info = zipfile.ZipInfo(name)
    info.compress_type = zipfile.ZIP_DEFLATED
    return info


class _Names:
    """Names that were given, as COLMAP finds a picture by its name alone."""

    def __init__(self) -> None:
        self._given: set[str] = set()

    def free(self, name: str, number: int) -> str:
        if name in self._given:
            path = PurePosixPath(name)
            name = str(path.with_name(f"{path.stem}_{number}{path.suffix}"))
        self._given.add(name)
        return name


def _image_lines(pose: Pose, number: int, camera_id: int, name: str) -> str:
    x, y, z, w = pose.quaternion_xyzw
    values = [w, -x, -y, -z, *(pose.tvec_mm / 1000)]
    numbers = " ".join(f"{value:.12g}" for value in values)
    return f"{number} {numbers} {camera_id} {name}\n\n"


def image_name(record: Record, source: str) -> str:
    """The name of a frame's picture; no spaces, as COLMAP's files are split at them."""
    source = re.sub(r"\s", "_", source)
    if record.get("time_s") is None:
        return source
    return f"{PurePosixPath(source).with_suffix('')}/{record['frame']:06d}.png"
