"""What is drawn at random for each frame of a budget: the same in all of its cases."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from padstudio.experiments.budget.conditions import Conditions
from padstudio.experiments.budget.order import BudgetOrder
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.spec import Pad
from padstudio.simulate.lay.relief import Relief, Wave
from padstudio.simulate.motion import Motion
from padstudio.simulate.vibration import Vector, Vibration

# Columns of the Hadamard matrix of order 8 (Sylvester), as masks of the frame's number: no two of
# these systematic errors go together, and none has a mean.
_SCALE, _FOCAL, _PRINCIPAL_X, _PRINCIPAL_Y, _DISTORTION = 1, 2, 4, 7, 3
# How far off the middle the axis meets the pad, of the height and of half the pad's shorter side.
_REACH_OF_HEIGHT, _REACH_OF_PAD = 0.1, 0.5


@dataclass(frozen=True, eq=False)
class Draw:
    """A frame's share of chance.

    Attributes
    ----------
    number : int
        Of the frame; signs of systematic errors follow from it.
    pose : Pose
        The true one.
    motion : Motion
    relief : Relief or None
        Of the paper; None where it is flat.
    """

    number: int
    pose: Pose
    motion: Motion
    relief: Relief | None


def draw(order: BudgetOrder, conditions: Conditions, number: int) -> Draw:
    """The frame's pose, motion and paper; for a seed the same directions whatever the sizes."""
    rng = np.random.default_rng([order.seed, number, *b"budget"])
    reach = min(_REACH_OF_HEIGHT * order.height_mm, _REACH_OF_PAD * min(order.pad.size_mm) / 2)
    x, y = (float(value) for value in rng.uniform(-reach, reach, 2))
    heading, lean, course, bend, phase = (float(value) for value in rng.uniform(0, 360, 5))
    axis = rng.standard_normal(3)
    axis /= np.linalg.norm(axis)
    phases = _vector(rng.uniform(0, 360, 3))
    pose = look_at_pad(
        order.height_mm,
        tilt_deg=conditions.tilt_deg,
        heading_deg=heading,
        tilt_towards_deg=lean,
        target_mm=(x, y),
    )
    drift = conditions.drift_mm_s
    motion = Motion(
        velocity_mm_s=(
            drift * math.sin(math.radians(course)),
            drift * math.cos(math.radians(course)),
            -conditions.descent_mm_s,
        ),
        angular_deg_s=_vector(conditions.turn_deg_s * axis),
        vibrations=_shaking(conditions, phases),
    )
    return Draw(number, pose, motion, _relief(conditions, bend, phase))


def _shaking(conditions: Conditions, phases: Vector) -> tuple[Vibration, ...]:
    amplitude = conditions.vibration_deg
    if not amplitude:
        return ()
    shaking = Vibration(
        frequency_hz=conditions.vibration_hz,
        amplitude_deg=(amplitude, amplitude, amplitude),
        phase_deg=phases,
    )
    return (shaking,)


def _relief(conditions: Conditions, toward_deg: float, phase_deg: float) -> Relief | None:
    if not conditions.waves_mm:
        return None
    wave = Wave(
        amplitude_mm=conditions.waves_mm,
        length_mm=conditions.waves_length_mm,
        toward_deg=toward_deg,
        phase_deg=phase_deg,
    )
    return Relief((wave,))


def believed_pad(pad: Pad, conditions: Conditions, number: int) -> Pad:
    """The pad as the detector knows it, where the print is larger or smaller than measured."""
    true_over_believed = 1 + _sign(number, _SCALE) * conditions.scale_percent / 100
    x, y = pad.scale
    return replace(pad, scale=(x / true_over_believed, y / true_over_believed))


def believed_camera(camera: Camera, conditions: Conditions, number: int) -> Camera:
    """The camera as its file has it, where the true one differs by the calibration's error."""
    matrix = camera.matrix.copy()
    matrix[:2, :2] *= 1 + _sign(number, _FOCAL) * conditions.focal_percent / 100
    matrix[0, 2] += _sign(number, _PRINCIPAL_X) * conditions.principal_px
    matrix[1, 2] += _sign(number, _PRINCIPAL_Y) * conditions.principal_px
    distortion = camera.distortion.copy()
    if conditions.distortion_px:
        if not len(distortion):
            distortion = np.zeros(4)
        # The shift of a first radial coefficient is f k r^3, r the tangent of the angle to the axis
        # (Brown 1966); of an equidistant fisheye the angle itself.
        corner = math.hypot(camera.width, camera.height) / 2 / camera.focal_px
        change = conditions.distortion_px / (camera.focal_px * corner**3)
        distortion[0] += _sign(number, _DISTORTION) * change
    return replace(camera, matrix=matrix, distortion=distortion)


def _sign(number: int, mask: int) -> int:
    """+1 or -1, an entry of the Hadamard matrix."""
    return 1 - 2 * ((number & mask).bit_count() % 2)


def _vector(values: np.typing.NDArray[np.float64]) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
