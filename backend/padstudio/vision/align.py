"""The pose of a far pad, from all its pixels at once.

From far away cells are a few pixels wide or less, and no border stands alone. The known pattern is
then matched as a whole: the picture that the pose predicts is compared with the frame pixel by
pixel, and pose, brightness, shading and the crosstalk of the inks are solved for together.

References
----------
Lucas, B. D. and Kanade, T. (1981). An iterative image registration technique with an application
to stereo vision. Baker, S. and Matthews, I. (2004). Lucas–Kanade 20 years on: a unifying framework.
doi:10.1023/B:VISI.0000011205.11775.fd
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.camera import Camera
from padstudio.pad.layout import outline_mm
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.motion import MovingPose, cross
from padstudio.vision.planes import Box, Pyramid
from padstudio.vision.refine import Fit, MotionPrior
from padstudio.vision.types import Array

# Texture pixels per pixel of the frame, and the blur of lens, sensor and demosaicing, in the
# latter.
_OVERSAMPLING = 2.0
_BLUR_PX = 0.8
# More pixels than this are thinned evenly.
_MOST_PIXELS = 16_000
_LEAST_PIXELS = 150
_ITERATIONS = 6
# A step that moves the picture by less ends the iteration.
_SETTLED_PX = 5e-3
# Pixels this near to the pad's rim see the ground.
_RIM_PX = 2.0


@dataclass(frozen=True, eq=False)
class Texture:
    """The pad's layers as brightness over the pad frame, at a frame's scale.

    Attributes
    ----------
    layers : tuple of (h, w) float32
        0 … 1, blurred as the camera does, in the order of ``pad.layers``.
    mm : (x, y) of float
        Size of a texture pixel.
    size_mm : (w, h) of float
        Measured size of the pad.
    """

    layers: tuple[NDArray[np.float32], ...]
    mm: tuple[float, float]
    size_mm: tuple[float, float]

    def coordinates(self, points: Array) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Texture pixels of pad points (N, 2), mm."""
        x = (points[:, 0] + self.size_mm[0] / 2) / self.mm[0] - 0.5
        y = (self.size_mm[1] / 2 - points[:, 1]) / self.mm[1] - 0.5
        return x.astype(np.float32), y.astype(np.float32)


@dataclass(frozen=True, eq=False)
class Pixels:
    """Pixels of the frame that show the pad.

    Attributes
    ----------
    rays : (N, 3) float64
    moment : (N,) float64
        When they were read, −0.5 … 0.5 of the frame.
    shade : (N, 6) float64
        Terms of a smooth shading.
    values : mapping of channel to (N,) float64
    """

    rays: Array
    moment: Array
    shade: Array
    values: dict[Channel, Array]


def align(
    pyramid: Pyramid,
    camera: Camera,
    pad: Pad,
    start: MovingPose,
    *,
    motion: bool,
    known: MovingPose | None = None,
) -> Fit | None:
    """Match the whole pad to the frame.

    Parameters
    ----------
    pyramid : Pyramid
    camera : Camera
        At the frame's size.
    pad : Pad
    start : MovingPose
        Right to about a pixel.
    motion : bool
        Let the pose change within the frame.
    known : MovingPose or None
        A pose whose change within the frame this one's should be near to.

    Returns
    -------
    Fit or None
        None where too few pixels show the pad, or the picture leaves the pose undetermined.
    """
    pixels = _pixels(pyramid, camera, pad, start)
    if pixels is None:
        return None
    texture = _texture(pad, camera.focal_px / float(start.pose.position_mm[2]))
    size = 12 if motion else 6
    match = _Match(pixels, texture, MotionPrior.of(start, known, size), size)
    pose = start if motion else MovingPose(start.pose)
    for _ in range(_ITERATIONS):
        step = match.step(pose)
        if step is None:
            return None
        pose = pose.moved(step)
        if np.abs(step[3:6]).max() * camera.focal_px < _SETTLED_PX and (
            np.abs(step[:3]).max() * camera.focal_px < _SETTLED_PX * pose.pose.position_mm[2]
        ):
            break
    return Fit(pose, match.rms_px, match.covariance, np.ones(len(pixels.moment), bool))


def _pixels(pyramid: Pyramid, camera: Camera, pad: Pad, pose: MovingPose) -> Pixels | None:
    box = _outline_box(camera, pad, pose)
    if box is None:
        return None
    stride = max(1, int(np.sqrt((box.x1 - box.x0) * (box.y1 - box.y0) / _MOST_PIXELS)))
    x, y = np.meshgrid(np.arange(box.x0, box.x1, stride), np.arange(box.y0, box.y1, stride))
    xy = np.stack([x.ravel(), y.ravel()], axis=1)
    rays = np.column_stack([camera.normalize(xy), np.ones(len(xy))])
    points, _ = _on_pad(pose, rays, np.zeros(len(xy)))
    width, height = pad.size_mm
    rim = _RIM_PX * float(pose.pose.position_mm[2]) / camera.focal_px
    inside = (np.abs(points[:, 0]) < width / 2 - rim) & (np.abs(points[:, 1]) < height / 2 - rim)
    if int(inside.sum()) < _LEAST_PIXELS:
        return None
    xy, rays = xy[inside], rays[inside]
    values = {}
    for layer in pad.layers:
        plane = pyramid.plane(layer.channel, 0, box).values
        values[layer.channel] = plane[xy[:, 1] - box.y0, xy[:, 0] - box.x0].astype(float)
    u, v = ((xy - xy.mean(axis=0)) / max(box.side / 2, 1)).T
    shade = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1)
    return Pixels(rays, pose.moment(camera, xy[:, 1].astype(float)), shade, values)


def _outline_box(camera: Camera, pad: Pad, pose: MovingPose) -> Box | None:
    corners = pose.project(camera, outline_mm(pad))
    if not np.isfinite(corners).all():
        return None
    low = np.clip(np.floor(corners.min(axis=0)), 0, None).astype(int)
    high = np.ceil(corners.max(axis=0)).astype(int) + 1
    box = Box(low[0], low[1], min(camera.width, high[0]), min(camera.height, high[1]))
    return box if min(box.x1 - box.x0, box.y1 - box.y0) >= 4 else None


def _texture(pad: Pad, px_per_mm: float) -> Texture:
    """The pad as a picture of about the frame's resolution, blurred as the camera does."""
    width, height = pad.size_mm
    w = max(8, round(width * px_per_mm * _OVERSAMPLING))
    h = max(8, round(height * px_per_mm * _OVERSAMPLING))
    mm = (width / w, height / h)
    sigma = _BLUR_PX * _OVERSAMPLING
    layers = []
    for layer in pad.layers:
        field = layer.field.astype(np.float32) / (pad.levels - 1)
        cover = (
            round(layer.width_mm * pad.scale[0] / mm[0]),
            round(layer.height_mm * pad.scale[1] / mm[1]),
        )
        # Averaging over areas is exact only downwards, so the cells are enlarged first.
        factor = max(1, -(-cover[0] // field.shape[1]), -(-cover[1] // field.shape[0]))
        large = np.repeat(np.repeat(field, factor, axis=0), factor, axis=1)
        shown = cv2.resize(large, cover, interpolation=cv2.INTER_AREA)
        canvas = np.zeros((h, w), np.float32)
        canvas[: shown.shape[0], : shown.shape[1]] = shown[:h, :w]
        layers.append(np.asarray(cv2.GaussianBlur(canvas, (0, 0), sigma), np.float32))
    return Texture(tuple(layers), mm, (width, height))


def _on_pad(pose: MovingPose, rays: Array, moment: Array) -> tuple[Array, Array]:
    """Where rays meet the pad (N, 2), mm, and their directions (N, 3) in the pad frame."""
    s = moment[:, None]
    turned = rays if pose.still else rays + s * cross(np.broadcast_to(pose.turn, rays.shape), rays)
    direction = turned @ pose.pose.rotation.T
    centre = pose.pose.position_mm + s * pose.shift_mm
    reach = -centre[:, 2] / direction[:, 2]
    return centre[:, :2] + reach[:, None] * direction[:, :2], direction


def _by_pose(pose: MovingPose, rays: Array, direction: Array) -> Array:
    """Change of the points on the pad with the pose, (N, 2, 6): centre, then turn."""
    height = float(pose.pose.position_mm[2])
    dx, dy, dz = direction.T
    out = np.zeros((len(rays), 2, 6))
    out[:, 0, 0] = out[:, 1, 1] = 1
    out[:, 0, 2], out[:, 1, 2] = -dx / dz, -dy / dz
    for k in range(3):
        axis = np.zeros(3)
        axis[k] = 1
        turned = cross(np.broadcast_to(axis, rays.shape), rays) @ pose.pose.rotation.T
        out[:, 0, 3 + k] = height / dz * (-turned[:, 0] + dx / dz * turned[:, 2])
        out[:, 1, 3 + k] = height / dz * (-turned[:, 1] + dy / dz * turned[:, 2])
    return out


class _Match:
    """Gauss–Newton for the pose; brightness, shading and crosstalk are solved for along with it.

    Each channel shows every layer, through its own inks and more or less through the others', in
    an even light or one that falls off: value = shading + Σ gain · layer.
    """

    def __init__(self, pixels: Pixels, texture: Texture, prior: MotionPrior, size: int) -> None:
        self._pixels = pixels
        self._texture = texture
        self._prior = prior
        self._size = size
        self._brightness: dict[Channel, Array] = {}
        self.rms_px = 0.0
        self.covariance = np.zeros((6, 6))

    def step(self, pose: MovingPose) -> Array | None:
        """The step of the pose, or None where the picture leaves it undetermined."""
        pixels, size = self._pixels, self._size
        points, direction = _on_pad(pose, pixels.rays, pixels.moment)
        by_pose = _by_pose(pose, pixels.rays, direction)
        if size == 12:
            by_pose = np.concatenate([by_pose, by_pose * pixels.moment[:, None, None]], axis=2)
        shown = [_look_up(self._texture, layer, points) for layer in self._texture.layers]
        gains = [value[:, None] * pixels.shade[:, :3] for value, _ in shown]
        linear = np.column_stack([pixels.shade, *gains]).astype(np.float32)
        normal, right = np.diag(self._prior.weight), self._prior.pull(pose)
        squares = slopes = 0.0
        for channel, values in pixels.values.items():
            residual, weight = self._residual(channel, linear, values)
            slope = self._slope(channel, [d for _, d in shown])
            jacobian = slope[:, :1] * by_pose[:, 0] + slope[:, 1:] * by_pose[:, 1]
            both = np.column_stack([jacobian, linear])
            moment = (both * weight[:, None]).T @ np.column_stack([both, residual])
            variance = float((weight * residual**2).sum() / weight.sum())
            n, r = _without_brightness(moment.astype(float), size)
            normal, right = normal + n / variance, right + r / variance
            squares += variance
            slopes += float((slope**2).sum(axis=1).mean()) / 2
        try:
            step = np.linalg.solve(normal, right)
            self.covariance = np.asarray(np.linalg.inv(normal)[:6, :6], float)
        except np.linalg.LinAlgError:
            return None
        px_mm = self._texture.mm[0] * _OVERSAMPLING
        self.rms_px = float(np.sqrt(squares / max(slopes, 1e-9))) / px_mm
        return np.asarray(step, float) if np.isfinite(step).all() else None

    def _residual(
        self, channel: Channel, linear: NDArray[np.float32], values: Array
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """What brightness leaves over at the present pose, and how far each pixel is trusted."""
        known = self._brightness.get(channel)
        weight = np.ones(len(values), np.float32)
        for _ in range(3 if known is None else 1):
            if known is not None:
                weight = _trust(values - linear @ known)
            weighted = linear * weight[:, None]
            known = np.linalg.lstsq(
                (weighted.T @ linear).astype(float), (weighted.T @ values).astype(float), rcond=None
            )[0]
        assert known is not None
        self._brightness[channel] = known
        return (values - linear @ known).astype(np.float32), weight

    def _slope(self, channel: Channel, slopes: list[Array]) -> NDArray[np.float32]:
        """Change of a channel's brightness per mm of X and Y, (N, 2)."""
        known, shade = self._brightness[channel], self._pixels.shade[:, :3]
        parts = [
            (shade @ known[6 + 3 * k : 9 + 3 * k])[:, None] * slope
            for k, slope in enumerate(slopes)
        ]
        return np.asarray(sum(parts), np.float32)


def _trust(residual: Array) -> NDArray[np.float32]:
    scale = max(1.4826 * float(np.median(np.abs(residual))), 0.3)
    return (1 / (1 + (residual / (3 * scale)) ** 2) ** 2).astype(np.float32)


def _without_brightness(moment: Array, size: int) -> tuple[Array, Array]:
    """Normal equations of the pose alone: the Schur complement of the brightness terms."""
    a, b = moment[:size, :size], moment[:size, size:-1]
    c, r, s = moment[size:, size:-1], moment[:size, -1], moment[size:, -1]
    solved = np.linalg.lstsq(c, np.column_stack([b.T, s]), rcond=None)[0]
    return a - b @ solved[:, :-1], r - b @ solved[:, -1]


def _look_up(texture: Texture, layer: NDArray[np.float32], points: Array) -> tuple[Array, Array]:
    """Brightness (N,) at pad points, and its slope (N, 2) per mm of X and Y."""
    x, y = texture.coordinates(points)

    def at(dx: float, dy: float) -> Array:
        # cv2.remap takes at most 32767 columns.
        shape = (-1, 256)
        pad_count = -len(x) % 256
        px = np.pad(x + np.float32(dx), (0, pad_count), mode="edge").reshape(shape)
        py = np.pad(y + np.float32(dy), (0, pad_count), mode="edge").reshape(shape)
        values = cv2.remap(layer, px, py, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(values, float).ravel()[: len(x)]

    slope_x = (at(0.5, 0) - at(-0.5, 0)) / texture.mm[0]
    slope_y = -(at(0, 0.5) - at(0, -0.5)) / texture.mm[1]
    return at(0, 0), np.stack([slope_x, slope_y], axis=1)
