"""What an attitude that is hardly known makes of a position: an arc rather than a line.

Where a camera sees a plane's centre is known far better than how it is turned. Poses that fit lie
on an arc about the centre: a camera whose attitude is off by θ stands off by −R(θ × t), and in the
second order by −½ R(θ × (θ × t)), where t is the centre in the camera frame. A covariance of the
first order knows nothing of the latter, and promises far too much across the arc.

References
----------
Maybeck, P. S. (1982). Stochastic models, estimation, and control, volume 2, chapter 12.3: the
Gaussian second-order filter. Moments of quadratic forms: Magnus, J. R. (1978). The moments of
products of quadratic forms in normal variables. doi:10.1111/j.1467-9574.1978.tb01399.x.
"""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.pose import Pose


def with_curvature(covariance: Array, pose: Pose) -> Array:
    """A pose's covariance of the first order with that of the second.

    Parameters
    ----------
    covariance : (6, 6) float64
        Position (mm, pad frame), then attitude (radians, about the camera's axes).
    pose : Pose

    Returns
    -------
    (6, 6) float64
        With the second moment of the position's terms of second order; `without_curvature` takes
        it away again.
    """
    out = covariance.copy()
    out[:3, :3] += _second_moment(covariance[3:, 3:], pose)
    return out


def without_curvature(covariance: Array, pose: Pose) -> Array:
    """The first order's part of a covariance with curvature.

    One that never had any, and cannot spare it, is given back as it is.
    """
    out = covariance.copy()
    out[:3, :3] -= _second_moment(covariance[3:, 3:], pose)
    unit = 1 / np.sqrt(np.maximum(covariance.diagonal(), 1e-300))
    try:
        np.linalg.cholesky(out * unit * unit[:, None])
    except np.linalg.LinAlgError:
        return covariance
    return out


def _second_moment(attitude: Array, pose: Pose) -> Array:
    """Of ½ θ × (θ × t) in the pad frame, (3, 3), for θ of a covariance (3, 3).

    By Isserlis' theorem, of ½ (θ (θ·t) − t |θ|²).
    """
    # In the pad frame, where the centre lies opposite to the position.
    turn, centre = pose.rotation @ attitude @ pose.rotation.T, -pose.position_mm
    pull = turn @ centre
    trace = float(turn[0, 0] + turn[1, 1] + turn[2, 2])
    mixed = (trace * pull + 2 * (turn @ pull))[:, None] * centre
    both = trace**2 + 2 * float(turn.ravel() @ turn.ravel())
    out = float(centre @ pull) * turn + (2 * pull)[:, None] * pull - mixed - mixed.T
    return np.asarray((out + (both * centre)[:, None] * centre) / 4)
