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
from padstudio.vision.outline import sides_kernel

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
    shift, good = sides_kernel.half_way(values)
    if good.sum() < _LEAST_POINTS:
        return None
    points = feet[good] + (shift[good] * reach_px)[:, None] * outward[good]
    return _robust_line(points, view.camera, outward[good].mean(axis=0))


def _feet(camera: Camera, ends: Array, count: int) -> tuple[Array, Array]:
    """Points (count, 2) on the side, which the lens may bend, and unit vectors out of the pad."""
    first, last = camera.normalize(ends)
    share = np.linspace(_TRIM, 1 - _TRIM, count)[:, None]
    feet = camera.denormalize(first + share * (last - first))
    around = np.concatenate([feet[:1], feet, feet[-1:]])
    along = around[2:] - around[:-2]
    # To the left of the way, hence out of the pad.
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    return feet, outward / np.maximum(np.hypot(along[:, :1], along[:, 1:]), 1e-9)


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
    # Means along so short an axis take NumPy ten times as long.
    channels = [colors[..., k] for k in range(colors.shape[2])]
    bright = np.asarray(sum(channels[k] for k in view.unused) / len(view.unused), float)
    light = np.asarray(sum(channels) / len(channels) + _DARK / 3, float)
    share = bright / light
    by_light, by_share = sides_kernel.contrast(bright), sides_kernel.contrast(share)
    if max(by_light, by_share) <= _LEAST_CONTRAST:
        return None
    if not view.is_last:
        return bright if by_light >= by_share else share
    # Light adds up by area, and codecs keep it sharper than colour.
    return bright if by_light >= min(by_share, _AMPLE_CONTRAST) else _by_area(share, light)


def _by_area(share: Array, light: Array) -> Array:
    """Shares that samples would have if their parts' shares weighed by area.

    A mixture's share is the mean of its parts' shares weighted by their light: where the ground is
    darker than the pad, a sample that is half of either has less than half way's.
    """
    pad, ground = (end[:, None] for end in sides_kernel.ends(share))
    pad_light, ground_light = (end[:, None] for end in sides_kernel.ends(light))
    out, into = pad_light * (share - pad), ground_light * (ground - share)
    rise, total = ground - pad, out + into
    is_between = rise * total > 0
    return pad + rise * np.where(is_between, out / np.where(is_between, total, 1.0), 0.0)


def _robust_line(points: Array, camera: Camera, outward: Array) -> Side | None:
    """A line through most of the points, fitted on the plane z = 1."""
    line, off, sigma = sides_kernel.robust_line(camera.normalize(points), camera.focal_px)
    inliers = np.abs(off) < 3 * sigma
    if inliers.sum() < max(_LEAST_POINTS, 0.4 * len(points)):
        return None
    # Neighbouring profiles see the same stalks of grass: a quarter of them counts.
    independent = max(2.0, inliers.sum() / 4)
    line = line * (np.sign(line[:2] @ outward) or 1.0)
    # The side's position at a corner, at its end, is twice as uncertain as in its middle.
    return Side(line, points, inliers, 2 * sigma / float(np.sqrt(independent)))
