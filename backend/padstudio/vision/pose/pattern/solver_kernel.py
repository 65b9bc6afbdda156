"""Compiled Gauss–Newton of `padstudio.vision.pose.pattern.solver`: all steps in one call."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.projection import PoseState
from padstudio.geometry.small_matrices import solve, turned
from padstudio.vision.pose.noise_kernel import least_share
from padstudio.vision.pose.pattern.alignment_kernel import match_pattern
from padstudio.vision.pose.pattern.block_kernel import GAIN, SHADE, Brightness, Pixels, Texture
from padstudio.vision.pose.pattern.elimination_kernel import (
    HELD,
    Eliminated,
    eliminated,
    without_brightness,
)

# Where residuals are large, plain steps go half of the way; they are lengthened by what the last
# two tell, but by no more than this.
_MOST_STRETCH = 2.5
# Residuals beyond so many standard deviations, and grey values, are trusted little.
_TRUSTED, _LEAST_SCALE = 3.0, 0.3
# Sizes of residuals are counted by their first bits: those of the exponent and three more.
_SIGN, _BITS = np.uint32(0x7FFFFFFF), np.uint32(20)


class Knowledge(NamedTuple):
    """What is known beforehand of the parameters, as of `least_squares.MotionPrior`."""

    weight: Array
    expected: Array


class Limits(NamedTuple):
    """When steps end.

    Attributes
    ----------
    steps : int
        So many at the most.
    settled : float
        A step that is shorter than so many standard deviations, squared, is the last.
    """

    steps: int
    settled: float


class Settled(NamedTuple):
    """Where steps led.

    Attributes
    ----------
    solved : bool
    pose : PoseState
    brightness : Brightness
    stretch : float
        By how much the last step was lengthened.
    sums : (C, 4) float64
        As of `padstudio.vision.pose.pattern.alignment_kernel.Equations`, at the last step.
    """

    solved: bool
    pose: PoseState
    brightness: Brightness
    stretch: float
    sums: Array


@fast_jit
def brightness_at(pixels: Pixels, texture: Texture, pose: PoseState) -> Brightness:
    """Brightness at a pose, as if the pose were right."""
    channels, linear = len(pixels.values), SHADE + GAIN * len(texture.layers)
    found = Brightness(np.zeros((channels, linear)), np.zeros(channels))
    for _ in range(2):
        equations = match_pattern(pixels, texture, pose, found, 0, 1)
        terms = found.terms.copy()
        for c in range(channels):
            terms[c] += without_brightness(equations.normal[c], equations.right[c, 0], 0, HELD)[3]
        found = Brightness(terms, scales_of(equations.residuals))
    return found


@fast_jit
def settle(
    pixels: Pixels,
    texture: Texture,
    start: tuple[PoseState, Brightness, float],
    known: Knowledge,
    limits: Limits,
) -> Settled:
    """Steps toward the pose at which a pattern shows what the pixels do.

    Parameters
    ----------
    pixels : Pixels
    texture : Texture
    start : (PoseState, Brightness, float)
        The last is the stretch, as of `Settled`.
    known : Knowledge
    limits : Limits
    """
    size, (pose, brightness, stretch) = len(known.weight), start
    last, sums = np.zeros(size), np.zeros((len(pixels.values), 4))
    for n in range(limits.steps):
        found = match_pattern(pixels, texture, pose, brightness, size, 1)
        held, sums = eliminated(found.normal, size), found.sums
        normal, pull = posed(held, found.right[:, 0], sums, known, pose)
        solved, step = solve(normal, pull)
        if not solved or not np.isfinite(step).all():
            return Settled(False, pose, brightness, stretch, sums)
        if n > 0:
            stretch = stretched(stretch, product(last, normal, step), last, normal)
        last, length = step, product(step, normal, step)
        step = stretch * step
        pose = moved(pose, step)
        terms = lit(brightness.terms, held, found.right[:, 0], sums, step)
        brightness = Brightness(terms, scales_of(found.residuals))
        if length < limits.settled:
            break
    return Settled(True, pose, brightness, stretch, sums)


@fast_jit
def posed(
    held: Eliminated, right: Array, sums: Array, known: Knowledge, pose: PoseState
) -> tuple[Array, Array]:
    """Normal equations (K, K) of the pose by all channels, and by what is known beforehand."""
    size = len(known.weight)
    normal, pull = np.zeros((size, size)), np.empty(size)
    for a in range(size):
        now = 0.0 if a < 6 else pose.shift[a - 6] if a < 9 else pose.rotvec[a - 9]
        normal[a, a], pull[a] = known.weight[a], known.weight[a] * (known.expected[a] - now)
    for c in range(len(right)):
        trust = 1 / max(sums[c, 0] / sums[c, 1], 1e-9)
        share = least_share(sums[c, 2] / sums[c, 1])
        for a in range(size):
            asked = right[c, a]
            for k in range(held.shared.shape[1]):
                asked -= held.shared[c, k, a] * right[c, size + k]
            pull[a] += trust * asked
            for b in range(size):
                normal[a, b] += trust * share * held.inner[c, a, b]
    return normal, pull


@fast_jit
def lit(terms: Array, held: Eliminated, right: Array, sums: Array, step: Array) -> Array:
    """Brightness (C, L) after a step of the pose."""
    out, size = terms.copy(), len(step)
    for c in range(len(terms)):
        share = least_share(sums[c, 2] / sums[c, 1])
        _, change = solve(held.linear[c], right[c, size:].copy())
        for k in range(terms.shape[1]):
            out[c, k] += change[k] / share
            for a in range(size):
                out[c, k] -= held.shared[c, k, a] * step[a]
    return out


@fast_jit
def moved(pose: PoseState, step: Array) -> PoseState:
    """A pose after a step (6,), or (12,) with those of its changes."""
    shift, rotvec = pose.shift, pose.rotvec
    if len(step) == 12:
        shift, rotvec = shift + step[6:9], rotvec + step[9:]
    return PoseState(turned(pose.rotation, step[3:6]), pose.centre + step[:3], shift, rotvec)


@fast_jit
def product(one: Array, metric: Array, other: Array) -> float:
    """Scalar product of two steps in a metric."""
    total = 0.0
    for a in range(len(one)):
        for b in range(len(other)):
            total += one[a] * metric[a, b] * other[b]
    return total


@fast_jit
def stretched(before: float, common: float, last: Array, normal: Array) -> float:
    """By how much to lengthen a step, of what the step before it, so lengthened, left to do.

    Parameters
    ----------
    before : float
        By how much the last step was lengthened.
    common : float
        Product of the last step, not lengthened, and this one, in the metric of ``normal``.
    last : (K,) float64
    normal : (K, K) float64
    """
    square = product(last, normal, last)
    if not square > 0:
        return 1.0
    return min(max(before * square / max(square - common, 1e-9 * square), 1.0), _MOST_STRETCH)


@fast_jit
def scales_of(residuals: NDArray[np.float32]) -> Array:
    """Beyond which residuals (C, N) are trusted little: robust standard deviations, (C,)."""
    out = np.empty(len(residuals))
    for c in range(len(residuals)):
        out[c] = _TRUSTED * max(1.4826 * median_size(residuals[c]), _LEAST_SCALE)
    return out


@fast_jit
def median_size(residuals: NDArray[np.float32]) -> float:
    """The upper median of absolute values (N,).

    Only the part of them is sorted whose first bits are those of the median.
    """
    bits, middle = residuals.view(np.uint32), len(residuals) // 2
    counts = np.zeros(1 << 11, np.intp)
    for i in range(len(bits)):
        counts[(bits[i] & _SIGN) >> _BITS] += 1
    part = below = 0
    while below + counts[part] <= middle:
        below += counts[part]
        part += 1
    alike, found = np.empty(counts[part], np.float32), 0
    for i in range(len(bits)):
        if (bits[i] & _SIGN) >> _BITS == part:
            alike[found] = abs(residuals[i])
            found += 1
    return float(np.partition(alike, middle - below)[middle - below])
