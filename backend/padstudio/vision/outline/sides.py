"""The sides of the whole sign: where the pad's colour ends, to a part of a pixel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.color import linear_from_srgb
from padstudio.geometry.camera import Camera
from padstudio.vision.frame.pyramid import Pyramid

# Positions along a profile across a side, in units of its reach.
_STEPS = np.linspace(-1.0, 1.0, 25)
# Near the corners the other side disturbs.
_TRIM = 0.04
_LEAST_POINTS = 8
# The inside and the outside must differ by this many of their own scatter. Double loses one of 76
# stills of the footage; half changes nothing.
_LEAST_CONTRAST = 1.5
# So much is enough, even where another measure has more.
_AMPLE_CONTRAST = 4.0
# Added to the sum of channels, so that noise in the dark does not look like colour.
_DARK = 2.0
# Light, 0 … 255, of the grey values of a frame.
_LIGHT = 255 * linear_from_srgb(np.arange(256) / 255)


@dataclass(frozen=True, eq=False)
class Side:
    """A straight side.

    Attributes
    ----------
    line : (3,) float64
        Unit normal and offset on the plane z = 1, undistorted; the pad is where it is negative.
    points_xy : (N, 2) float64
        Where the step was found along it, frame pixels.
    inliers : (N,) bool
    sigma_px : float
        Standard deviation of the side's position, frame pixels.
    """

    line: Array
    points_xy: Array
    inliers: NDArray[np.bool_]
    sigma_px: float


class SideView(NamedTuple):
    """What a side is looked for in.

    Attributes
    ----------
    pyramid : Pyramid
    camera : Camera
        At the frame's size.
    level : int
        Level of the pyramid that profiles are taken from.
    unused : list of int
        As of `padstudio.vision.frame.regions.unused_channels`.
    most_profiles : int
        At the most so many are taken.
    is_last : bool
        No finer level follows: the step must be unbiased, not just be found.
    """

    pyramid: Pyramid
    camera: Camera
    level: int
    unused: list[int]
    most_profiles: int
    is_last: bool = True


def fit_side(view: SideView, ends: Array, reach_px: float) -> Side | None:
    """Fit the side between two rough corners.

    Across the rough side, short profiles are taken of whichever tells pad from ground more
    clearly there: the brightness of the channels that the pad leaves dark, or their share of the
    light. The step lies where a profile is half way between inside and outside.

    Parameters
    ----------
    view : SideView
    ends : (2, 2) float64
        Frame pixels; the pad lies to the right of the way from the first to the second one, as a
        clockwise order has it in a picture.
    reach_px : float
        Half length of a profile, frame pixels.

    Returns
    -------
    Side or None
        None where no clear step is found.
    """
    length = float(np.linalg.norm(ends[1] - ends[0]))
    if length < 4.0:
        return None
    reach_px = min(reach_px, 0.35 * length)
    count = int(np.clip(length / (1 << view.level), _LEAST_POINTS, view.most_profiles))
    feet, outward = _feet(view.camera, ends, count)
    at = feet[:, None] + (reach_px * _STEPS)[None, :, None] * outward[:, None]
    values = _clearest(_sample(view.pyramid, view.level, at), view)
    if values is None:
        return None
    shift, good = _half_way(values)
    if good.sum() < _LEAST_POINTS:
        return None
    points = feet[good] + (shift[good] * reach_px)[:, None] * outward[good]
    return _robust_line(points, view.camera, outward[good].mean(axis=0))


def _feet(camera: Camera, ends: Array, count: int) -> tuple[Array, Array]:
    """Points (count, 2) on the side, which the lens may bend, and unit vectors out of the pad."""
    first, last = camera.normalize(ends)
    share = np.linspace(_TRIM, 1 - _TRIM, count)[:, None]
    feet = camera.denormalize(first + share * (last - first))
    along = np.gradient(feet, axis=0)
    # To the left of the way, hence out of the pad.
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    return feet, outward / np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-9)


def _sample(pyramid: Pyramid, level: int, at: Array) -> Array:
    """Light (N, S, 3), 0 … 255, at frame pixels (N, S, 2)."""
    local = ((at + 0.5) / float(1 << level) - 0.5).astype(np.float32)
    image = pyramid.level(level)
    colors = cv2.remap(
        image, local[..., 0], local[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    # A pixel half on white and half on ink has half the light, but more than half the grey value.
    return np.asarray(_LIGHT[colors], float)


def _clearest(colors: Array, view: SideView) -> Array | None:
    """Profiles (N, S) of the measure with the clearest step outward, rising."""
    bright = np.asarray(colors[..., view.unused].mean(axis=2), float)
    light = np.asarray(colors.mean(axis=2) + _DARK / 3, float)
    share = bright / light
    by_light, by_share = _contrast(bright), _contrast(share)
    if max(by_light, by_share) <= _LEAST_CONTRAST:
        return None
    if not view.is_last:
        return bright if by_light >= by_share else share
    # Light adds up by area, and codecs keep it sharper than colour.
    return bright if by_light >= min(by_share, _AMPLE_CONTRAST) else _by_area(share, light)


def _contrast(values: Array) -> float:
    """The step of profiles (N, S) in units of what scatters on either side of it."""
    inside, outside = _ends(values)
    spread = np.sqrt((inside.var() + outside.var()) / 2) + 1e-6
    return float((outside.mean() - inside.mean()) / spread)


def _by_area(share: Array, light: Array) -> Array:
    """Shares that samples would have if their parts' shares weighed by area.

    A mixture's share is the mean of its parts' shares weighted by their light: where the ground is
    darker than the pad, a sample that is half of either has less than half way's.
    """
    (pad, ground), (pad_light, ground_light) = _ends(share), _ends(light)
    out, into = pad_light * (share - pad), ground_light * (ground - share)
    rise, total = ground - pad, out + into
    is_between = rise * total > 0
    return pad + rise * np.where(is_between, out / np.where(is_between, total, 1.0), 0.0)


def _ends(values: Array) -> tuple[Array, Array]:
    """Means (N, 1) of the inner and of the outer quarter of profiles (N, S)."""
    quarter = len(_STEPS) // 4
    inside, outside = values[:, :quarter], values[:, -quarter:]
    return inside.mean(axis=1, keepdims=True), outside.mean(axis=1, keepdims=True)


def _half_way(values: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Where profiles pass half way from inside to outside, −1 … 1, and whether they do so well.

    The area under the rising part tells the place better than a crossing does: it uses every
    sample, and noise averages out.
    """
    low, high = _ends(values)
    rise = high - low
    typical = float(np.median(rise))
    good = (rise[:, 0] > 0.4 * typical) & (rise[:, 0] < 2.5 * typical)
    # Clipping at 0 and 1 would count noise on one side only, and shift the step by it.
    part = np.clip((values - low) / np.where(rise > 0, rise, 1.0), -1.0, 2.0)
    step = _STEPS[1] - _STEPS[0]
    filled = (part[:, 1:] + part[:, :-1]).sum(axis=1) * step / 2
    return 1.0 - filled, good & (typical > 0)


def _robust_line(points: Array, camera: Camera, outward: Array) -> Side | None:
    """A line through most of the points, fitted on the plane z = 1."""
    rays = camera.normalize(points)
    weight = np.ones(len(points))
    line, sigma = np.zeros(3), np.inf
    for _ in range(8):
        middle = np.average(rays, axis=0, weights=weight)
        off_middle = rays - middle
        normal = np.linalg.eigh((off_middle * weight[:, None]).T @ off_middle)[1][:, 0]
        line = np.array([*normal, -float(normal @ middle)])
        off = (rays @ line[:2] + line[2]) * camera.focal_px
        sigma = max(float(np.median(np.abs(off))) / 0.6745, 0.02)
        weight = 1 / (1 + (off / (2 * sigma)) ** 2) ** 2
    inliers = np.abs(off) < 3 * sigma
    if inliers.sum() < max(_LEAST_POINTS, 0.4 * len(points)):
        return None
    # Neighbouring profiles see the same stalks of grass: a quarter of them counts.
    independent = max(2.0, inliers.sum() / 4)
    line = line * (np.sign(line[:2] @ outward) or 1.0)
    # The side's position at a corner, at its end, is twice as uncertain as in its middle.
    return Side(line, points, inliers, 2 * sigma / float(np.sqrt(independent)))
