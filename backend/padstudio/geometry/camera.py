"""A calibrated camera: intrinsics and lens distortion.

Pixel (0, 0) is the centre of the top-left pixel.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from padstudio import text
from padstudio.arrays import Array
from padstudio.errors import CameraFormatError, CameraMismatchError, shown
from padstudio.geometry import projection
from padstudio.geometry.camera_files.parts.fields import Asked, CameraFields, LensModel, naming
from padstudio.geometry.camera_files.parts.values import MAX_SIDE
from padstudio.geometry.projection import Lens

_COEFFICIENTS = {"radtan": (0, 4, 5, 8), "fisheye": (0, 4)}
# Two aspect ratios count as one when they differ by less than one pixel row in a thousand.
_ASPECT_TOLERANCE = 2e-3
# Rays are measured on up to 85 degrees from the axis: beyond, a pixel spans more of the plane z = 1
# than all pixels within. A pixel whose ray leads back to within this of it, pixels, has that ray.
_WIDEST, _SAME_PX = 11.43, 0.1
# Far beyond what lenses are; coefficients of long ones have gone to some ten thousands.
_LEAST_FOCAL_PX, _MOST_PX, _MOST_DISTORTION = 1e-3, 1e8, 1e8
#: Reading a frame takes no longer than a slow frame rate's whole period.
MAX_READOUT_MS = 1000.0


@dataclass(frozen=True, eq=False)
class Camera:
    """Pinhole intrinsics with a lens model.

    Attributes
    ----------
    width, height : int
        Size of the frames that the calibration is for, pixels.
    matrix : (3, 3) float64
        OpenCV's K, pixels.
    distortion : (0,), (4,), (5,) or (8,) float64
        Radial-tangential coefficients in OpenCV's order, or the four of the equidistant fisheye.
    model : {"radtan", "fisheye"}
    name : str
    nominal : bool
        True where the intrinsics come from a data sheet rather than a calibration.
    scale : float
        1.0, or the factor by which `for_frame` scaled a calibration made at another size.
    readout_ms : float or None
        From the first row's exposure to the last row's; 0 is a global shutter, None is unknown.
    notes : tuple of str
        What a user must know of how its file was read.
    """

    width: int
    height: int
    matrix: Array
    distortion: Array = field(default_factory=lambda: np.zeros(0))
    model: LensModel = "radtan"
    name: str = "camera"
    nominal: bool = False
    scale: float = 1.0
    readout_ms: float | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        matrix, distortion = _numbers(self.matrix), _numbers(self.distortion).ravel()
        if not (1 <= self.width <= MAX_SIDE and 1 <= self.height <= MAX_SIDE):
            raise CameraFormatError(
                f"image size {self.width} x {self.height} is not positive or beyond {MAX_SIDE}; "
                "give the calibrated size"
            )
        if matrix.shape != (3, 3) or not (np.abs(matrix) <= _MOST_PX).all():
            raise CameraFormatError(
                f"the camera matrix must be 3 x 3 finite numbers within ±{_MOST_PX:g} pixels"
            )
        if min(matrix[0, 0], matrix[1, 1]) < _LEAST_FOCAL_PX or not np.allclose(
            matrix[2], (0, 0, 1)
        ):
            raise CameraFormatError(
                "the camera matrix must have positive focal lengths, at least "
                f"{_LEAST_FOCAL_PX:g} pixels, and last row 0 0 1"
            )
        if self.model not in _COEFFICIENTS:
            raise CameraFormatError(
                f"unknown lens model {shown(self.model)}; use radtan or fisheye"
            )
        if len(distortion) not in _COEFFICIENTS[self.model]:
            allowed = ", ".join(map(str, _COEFFICIENTS[self.model]))
            raise CameraFormatError(
                f"{self.model} takes {allowed} distortion coefficients, not {len(distortion)}"
            )
        if not (np.abs(distortion) <= _MOST_DISTORTION).all():
            raise CameraFormatError(
                f"the distortion coefficients must be finite numbers within ±{_MOST_DISTORTION:g}"
            )
        if self.readout_ms is not None and not 0 <= self.readout_ms <= MAX_READOUT_MS:
            raise CameraFormatError(
                f"readout_ms is {self.readout_ms:g}; give 0 (global shutter) … {MAX_READOUT_MS:g}"
            )
        try:
            object.__setattr__(self, "name", text.plain(self.name))
        except ValueError as error:
            raise CameraFormatError(f"the camera's name: {error}") from error
        matrix.setflags(write=False)
        distortion.setflags(write=False)
        object.__setattr__(self, "matrix", matrix)
        object.__setattr__(self, "distortion", distortion)

    @classmethod
    def load(
        cls, path: str | Path, *, no_distortion: bool = False, which: str | None = None
    ) -> Camera:
        """Read a camera file of any form that is read (docs/camera-files.md).

        Parameters
        ----------
        path : str or Path
        no_distortion : bool
            The lens has none; only where the file holds no distortion either.
        which : str, optional
            Of a file of several cameras, the name or number of the one that is meant.

        Raises
        ------
        CameraFormatError
            If it cannot be read, is of no such form, or says anything of the lens that is not
            understood, naming what is wrong and where.
        """
        # The reader of YAML takes a tenth of all imports, and many cameras come from no file.
        from padstudio.geometry.camera_files import reading

        path = Path(path)
        data = reading.read(path)
        return cls.loads(data, path.name, no_distortion=no_distortion, which=which)

    @classmethod
    def loads(
        cls,
        data: bytes | str,
        name: str = "camera file",
        *,
        no_distortion: bool = False,
        which: str | None = None,
    ) -> Camera:
        """Read a camera from a file's content.

        Parameters
        ----------
        data : bytes or str
        name : str
            The file's name; messages start with it, and a camera without a name takes its stem.
        no_distortion, which
            As of `load`.

        Raises
        ------
        CameraFormatError
            As `load`.
        """
        from padstudio.geometry.camera_files import reading

        fields = reading.parse(data, name, Asked(no_distortion, which))
        with naming(name):
            return cls(**fields._asdict())

    def save(self, path: str | Path) -> None:
        """Write a ROS ``camera_info`` YAML file."""
        Path(path).write_text(self.to_ros_yaml(), encoding="utf-8")

    def to_ros_yaml(self) -> str:
        """The camera as ROS ``camera_info`` YAML, which `loads` reads back.

        Fewer than the five coefficients of ``plumb_bob`` are filled up with zeros, which is the
        same lens. The keys ``nominal`` and ``readout_ms`` stand where they say something; ROS
        ignores them.
        """
        return self.to_form("ros")

    def to_form(self, form: str) -> str:
        """The camera as a file of another program, which `loads` reads back.

        Parameters
        ----------
        form : {"ros", "opencv", "kalibr", "colmap"}

        Raises
        ------
        CameraFormatError
            If the form has no such lens.
        """
        from padstudio.geometry.camera_files import writing

        return writing.write(self.fields, form)

    @property
    def fields(self) -> CameraFields:
        """What files say of the camera."""
        lens = (self.width, self.height, self.matrix, self.distortion, self.model)
        return CameraFields(*lens, self.name, self.nominal, self.readout_ms, self.notes)

    @cached_property
    def distorted(self) -> bool:
        """True if any distortion coefficient differs from zero."""
        return bool(np.any(self.distortion)) or self.model == "fisheye"

    @cached_property
    def lens(self) -> Lens:
        """The camera as compiled loops take it."""
        coefficients = np.zeros(9)
        coefficients[0] = self.model == "fisheye"
        coefficients[1 : 1 + len(self.distortion)] = self.distortion
        # A copy, which can be written to, as compiled loops take arrays of one kind.
        return Lens(self.matrix.copy(), coefficients, self.width, self.height)

    @cached_property
    def focal_px(self) -> float:
        """Geometric mean of the two focal lengths, pixels."""
        return float(np.sqrt(self.matrix[0, 0] * self.matrix[1, 1]))

    def for_frame(self, width: int, height: int) -> Camera:
        """The camera for frames of another size of the same picture.

        Parameters
        ----------
        width, height : int
            The frame's size, pixels.

        Raises
        ------
        CameraMismatchError
            If the aspect differs, so that the frame cannot be the calibrated picture scaled.
        """
        if (width, height) == (self.width, self.height):
            return self
        sx, sy = width / self.width, height / self.height
        if abs(sx / sy - 1) > _ASPECT_TOLERANCE:
            turned = abs(width * self.width / (height * self.height) - 1) <= _ASPECT_TOLERANCE
            what = "turned by a quarter" if turned else "of another aspect"
            todo = "turn the picture back, as the sensor gave it, or" if turned else ""
            raise CameraMismatchError(
                f"the frame is {width} x {height}, camera {self.name!r} is calibrated for "
                f"{self.width} x {self.height}, {what}; {todo} choose the camera file made at "
                "the frame's size".replace(";  ", "; "),
                detail={
                    "frame": [width, height],
                    "camera": [self.width, self.height],
                    "turned": turned,
                },
            )
        matrix = self.matrix.copy()
        # Pixel centres are integers, so the picture's corner lies at -0.5.
        matrix[0, 2] += 0.5
        matrix[1, 2] += 0.5
        matrix[0] *= sx
        matrix[1] *= sy
        matrix[0, 2] -= 0.5
        matrix[1, 2] -= 0.5
        return replace(self, width=width, height=height, matrix=matrix, scale=self.scale * sx)

    def normalize(self, pixels: ArrayLike) -> Array:
        """Undistort pixels to the plane z = 1 of the camera frame.

        Parameters
        ----------
        pixels : (N, 2) array_like
            Pixel coordinates.

        Returns
        -------
        (N, 2) float64
            Normalized coordinates x/z, y/z.
        """
        points = np.ascontiguousarray(pixels, float).reshape(-1, 2)
        if self.distorted:
            return projection.undistorted(points, self.lens)
        # An ideal lens needs no compiled loops, which take their time to load.
        y = (points[:, 1] - self.matrix[1, 2]) / self.matrix[1, 1]
        x = (points[:, 0] - self.matrix[0, 2] - self.matrix[0, 1] * y) / self.matrix[0, 0]
        return np.stack([x, y], axis=1)

    def has_ray(self, pixels: Array, normalized: Array) -> NDArray[np.bool_]:
        """Which pixels (N, 2) the lens model takes to one ray of the plane z = 1, (N,).

        False where a fisheye looks sideways or backwards, where the lens's polynomial has turned
        back, and beyond a fisheye's picture; True everywhere for an ideal lens. Only such pixels
        may be measured on.

        Parameters
        ----------
        pixels : (N, 2) float64
        normalized : (N, 2) float64
            As `normalize` gives for them.
        """
        if not self.distorted:
            return np.ones(len(pixels), bool)
        with np.errstate(invalid="ignore"):
            ahead = np.hypot(normalized[:, 0], normalized[:, 1]) < _WIDEST
            back = np.abs(self.denormalize(normalized) - pixels).max(axis=1) < _SAME_PX
        return np.asarray(ahead & back)

    def sharpness(self, pixels: Array, normalized: Array) -> Array:
        """How finely the lens shows the plane z = 1 at pixels (N, 2), (N,); 1 for an ideal lens.

        Parameters
        ----------
        pixels : (N, 2) float64
        normalized : (N, 2) float64
            As `normalize` gives for them.

        Returns
        -------
        (N,) float64
            Pixels outward for a step of 1 on the plane, over the focal length: the squared cosine
            of the angle to the axis, for an equidistant fisheye.
        """
        if not self.distorted:
            return np.ones(len(pixels))
        outward = pixels - self.matrix[:2, 2]
        outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-9)
        # Inward, so that the last pixel with a ray has one as well.
        step = np.linalg.norm(normalized - self.normalize(pixels - outward), axis=1)
        return np.asarray(1 / (self.focal_px * np.maximum(step, 1e-12)))

    def denormalize(self, normalized: ArrayLike) -> Array:
        """Distort normalized coordinates to pixels; the inverse of `normalize`.

        Parameters
        ----------
        normalized : (N, 2) array_like
            Coordinates x/z, y/z.

        Returns
        -------
        (N, 2) float64
            Pixel coordinates.
        """
        xy = np.asarray(normalized, float).reshape(-1, 2)
        if self.distorted:
            points = np.column_stack([xy, np.ones(len(xy))])
            return projection.pixels_of(points, self.lens)
        return xy @ self.matrix[:2, :2].T + self.matrix[:2, 2]

    def project(self, points_camera: ArrayLike) -> Array:
        """Project camera-frame points to pixels.

        Parameters
        ----------
        points_camera : (N, 3) array_like
            Any length unit.

        Returns
        -------
        (N, 2) float64
            Pixel coordinates; NaN behind the camera.
        """
        points = np.asarray(points_camera, float).reshape(-1, 3)
        depth = np.where(points[:, 2:] > projection.NEAREST, points[:, 2:], np.nan)
        return self.denormalize(points[:, :2] / depth)


def _numbers(values: ArrayLike) -> Array:
    try:
        return np.array(values, float)
    except (TypeError, ValueError, OverflowError) as error:
        raise CameraFormatError("a camera's matrix and coefficients must be numbers") from error
