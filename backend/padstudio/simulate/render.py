"""Render a scene through a camera: the picture and the truth beside it."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array, Image
from padstudio.errors import SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.layout import corners_mm
from padstudio.pad.spec import Channel, Pad
from padstudio.simulate.lay.fit import best_fit, laid
from padstudio.simulate.motion import Course, Motion, course
from padstudio.simulate.radiance.integrate import radiance
from padstudio.simulate.radiance.lens import (
    border_rays,
    check_lens,
    in_picture,
    pixels_of_points,
)
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.radiance.sheet import half_sides_mm
from padstudio.simulate.sensor import Imaging, encode_jpeg, expose

# Nearer, the lens itself would touch the ground.
MIN_HEIGHT_MM = 1.0


@dataclass(frozen=True, eq=False)
class Truth:
    """What a simulated frame really shows.

    Attributes
    ----------
    camera : Camera
    pose : Pose
        At the middle row's mid-exposure.
    scene : Scene
    imaging : Imaging
    motion : Motion
    seed : int
    """

    camera: Camera
    pose: Pose
    scene: Scene
    imaging: Imaging
    motion: Motion
    seed: int

    def corners_px(self, channel: Channel) -> Array:
        """(rows + 1, cols + 1, 2) pixels of a layer's cell corners; NaN behind the camera.

        Where the print is bent or in sheets they are where it shows them, hidden ones too.
        """
        pad, lay = self.scene.pad, self.scene.lay
        if pad is None:
            raise SpecError("the scene has no pad, hence no corners")
        if lay is None:
            return corners_px(self.camera, self.pose, pad, channel)
        flat = corners_mm(pad, channel)
        points = laid(lay, half_sides_mm(self.scene), flat[..., :2].reshape(-1, 2))
        return pixels_of_points(self.camera, self.pose.to_camera(points)).reshape(
            *flat.shape[:2], 2
        )

    @property
    def also_true(self) -> tuple[Pose, ...]:
        """Other poses that are as true as `pose`; none where one flat pad is seen.

        Of a print that is bent or in sheets those relative to the planes that fit it best, as a
        whole and where it is in view; of copies of the pad those relative to each.
        """
        scene, out = self.scene, []
        if scene.lay is not None and scene.size_mm is not None:
            half = half_sides_mm(scene)
            out = [best_fit(scene.lay, half, self.pose, seen) for seen in (None, self._in_view)]
        for other in scene.neighbours:
            if other.pad is scene.pad:
                out.append(other.relative(self.pose))
        return tuple(out)

    def _in_view(self, points: Array) -> NDArray[np.bool_]:
        """Which points (N, 3) of the pad frame are in the picture."""
        return in_picture(self.camera, self.pose.to_camera(points))


@dataclass(frozen=True, eq=False)
class Frame:
    """A simulated picture.

    Attributes
    ----------
    image : (H, W, 3) uint8
        BGR, as a reader of the stored file sees it.
    truth : Truth
    encoded : bytes or None
        The JPEG file, where `Imaging.jpeg_quality` asks for one.
    """

    image: Image
    truth: Truth
    encoded: bytes | None = field(default=None, repr=False)


def render(
    scene: Scene,
    camera: Camera,
    pose: Pose,
    imaging: Imaging | None = None,
    seed: int = 0,
    *,
    motion: Motion | None = None,
) -> Frame:
    """Take a picture.

    Parameters
    ----------
    scene : Scene
    camera : Camera
    pose : Pose
        Of the camera at the middle row's mid-exposure.
    imaging : Imaging, optional
        Optics, sensor and processing; `Imaging.ideal()` for pure geometry.
    seed : int
        Of the noise. The ground has a seed of its own in the scene.
    motion : Motion, optional
        Velocity and vibration during the frame.

    Returns
    -------
    Frame

    Raises
    ------
    SpecError
        If the camera is at or below the ground, sees no ground, or has a lens that cannot be
        inverted.
    LimitError
        If the field of view or the frame's size is beyond the simulator's limit.
    """
    imaging = imaging or Imaging()
    motion = motion or Motion()
    check_lens(camera)
    check_pose(camera, pose)
    path = course(
        pose,
        motion,
        camera.height,
        exposure_ms=imaging.exposure_ms,
        readout_ms=imaging.readout_ms,
    )
    check_course(path)
    light = radiance(scene, camera, path.poses, path.pieces)
    if imaging.response is not None:
        beside = None
        if any(imaging.response.infrared):
            beside = radiance(scene, camera, path.poses, path.pieces, infrared=True)
        light = imaging.response.sensed(light, beside)
    image = expose(light, imaging, np.random.default_rng(seed))
    encoded = None
    if imaging.jpeg_quality is not None:
        encoded = encode_jpeg(image, imaging.jpeg_quality)
        image = np.asarray(
            cv2.imdecode(np.frombuffer(encoded, np.uint8), cv2.IMREAD_COLOR), np.uint8
        )
    return Frame(image, Truth(camera, pose, scene, imaging, motion, seed), encoded)


def check_pose(camera: Camera, pose: Pose) -> None:
    """Refuse a pose from which there is nothing to see; raises `SpecError` as `render`."""
    height = float(pose.position_mm[2])
    if not height >= MIN_HEIGHT_MM:
        raise SpecError(
            f"the camera is {height:.1f} mm over the ground; it must be at least "
            f"{MIN_HEIGHT_MM:.0f} mm above it",
            code="pose_below_ground",
            detail={"height_mm": height, "limit_mm": MIN_HEIGHT_MM},
        )
    rays = border_rays(camera) @ pose.rotation.T
    if (rays[:, 2] >= 0).all() and pose.rotation[2, 2] >= 0:
        raise SpecError(
            f"the camera sees no ground (its axis is {pose.tilt_deg:.0f} degrees off straight "
            "down); tilt it less, so that some ground is in the picture",
            code="camera_sees_no_ground",
            detail={"tilt_deg": pose.tilt_deg},
        )


def check_course(path: Course) -> None:
    """Refuse a motion that goes below the ground during the frame."""
    lowest = path.poses[..., 11].min()
    if not lowest >= MIN_HEIGHT_MM:
        raise SpecError(
            f"the camera falls to {lowest:.1f} mm while the frame is exposed; give a "
            f"slower motion or a higher start (limit {MIN_HEIGHT_MM:.0f} mm)",
            code="pose_below_ground",
        )


def corners_px(camera: Camera, pose: Pose, pad: Pad, channel: Channel) -> Array:
    """Where a layer's cell corners lie in an ideal picture.

    Returns
    -------
    (rows + 1, cols + 1, 2) float64
        Pixels; NaN for corners behind the camera, or beyond a fisheye's rim.
    """
    corners = corners_mm(pad, channel)
    pixels = pixels_of_points(camera, pose.to_camera(corners.reshape(-1, 3)))
    return pixels.reshape(*corners.shape[:2], 2)
