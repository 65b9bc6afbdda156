"""Compiled steps of the filter over poses: predict, update, and the smoother's step back.

A state is told from the camera: where it sees the pad's centre, which it knows well, and how it is
turned, which from afar it hardly knows. Both move on by the camera's own velocity and turn rate,
whatever the attitude is, so that errors of it do not spread. A state's error is (18,): the pad's
centre (mm), attitude (radians), velocity and turn rate, all in the camera frame, and six of the
frames' lasting error.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.small_matrices import turned
from padstudio.vision.fusion.algebra import (
    lower_root,
    product,
    rotation_vector,
    sandwich,
    skew,
    solved,
)

#: Length of a state's error, and that of a frame's shaking beside it.
STATE, SHAKE = 18, 3


class Track(NamedTuple):
    """A state of the filter: of the camera that does not shake, in its own frame.

    Attributes
    ----------
    centre : (3,) float64
        The pad's centre, mm.
    rotation : (3, 3) float64
        Takes camera vectors to pad vectors.
    velocity : (3,) float64
        Of the camera, mm/s.
    rate : (3,) float64
        Turn rate, radians/s.
    lasting : (6,) float64
        Of the frames' errors the part that lasts, in units of its standard deviation.
    covariance : (18, 18) float64
    """

    centre: Array
    rotation: Array
    velocity: Array
    rate: Array
    lasting: Array
    covariance: Array


class Noise(NamedTuple):
    """What the filter takes for granted; units of mm, radians and seconds.

    Attributes
    ----------
    acceleration, turning : float
        Spectral densities of white acceleration, mm²/s³, and angular acceleration, rad²/s³.
    shake : float
        Variance of the shaking about each axis, rad².
    share, memory_s : float
        Of a frame's covariance the share that lasts, and how long.
    """

    acceleration: float
    turning: float
    shake: float
    share: float
    memory_s: float


class Sight(NamedTuple):
    """What a frame adds: its pose against the predicted one.

    Attributes
    ----------
    innovation : (6,) float64
        Of the pad's centre in the camera frame, mm, and of the attitude, radians.
    gain : (21, 6) float64
    observed : (6, 21) float64
        Derivatives of what is measured by the state's error and the shaking.
    noise : (6, 6) float64
        Covariance of the part of the frame's error that does not last, as the gain takes it.
    before : (21, 21) float64
        Covariance of state and shaking without the frame.
    distance : float
        Squared Mahalanobis distance of the innovation,
    centre_distance : float
        and of the pad's centre alone.
    """

    innovation: Array
    gain: Array
    observed: Array
    noise: Array
    before: Array
    distance: float
    centre_distance: float


@fast_jit
def begun(
    centre: Array, rotation: Array, seen: Array, fastest: Array, noise: Noise
) -> tuple[Track, Array]:
    """The state after a first frame, and its covariance with the shaking's (21, 21).

    Parameters
    ----------
    centre, rotation
        What the frame says, as of `Track`.
    seen : (6, 6) float64
        Covariance of both.
    fastest : (2,) float64
        One standard deviation of the velocity, mm/s, and of the turn rate, radians/s.
    """
    joint = np.zeros((STATE + SHAKE, STATE + SHAKE))
    low = lower_root(seen)
    # What a frame shows is the shaken camera; the steady one differs by the shaking.
    shaking = np.zeros((6, SHAKE))
    shaking[:3], shaking[3:] = -skew(centre), -np.eye(3)
    joint[:6, :6] = seen + noise.shake * product(shaking, shaking.T.copy())
    for i in range(6):
        for j in range(6):
            joint[i, 12 + j] = joint[12 + j, i] = -math.sqrt(noise.share) * low[i, j]
        for j in range(SHAKE):
            joint[i, STATE + j] = joint[STATE + j, i] = noise.shake * shaking[i, j]
        joint[6 + i, 6 + i] = fastest[i // 3] ** 2
        joint[12 + i, 12 + i] = 1.0
    for i in range(STATE, STATE + SHAKE):
        joint[i, i] = noise.shake
    none = np.zeros(3)
    own = joint[:STATE, :STATE].copy()
    return Track(centre.copy(), rotation.copy(), none, none, np.zeros(6), own), joint


@fast_jit
def moved(track: Track, dt: float, noise: Noise) -> tuple[Track, Array]:
    """The state a time later, and the transition (18, 18) of its error."""
    kept = math.exp(-dt / noise.memory_s)
    back = turned(np.eye(3), -dt * track.rate)
    centre = product(back, (track.centre - dt * track.velocity).reshape(3, 1))[:, 0].copy()
    velocity = product(back, track.velocity.copy().reshape(3, 1))[:, 0].copy()
    step = np.zeros((STATE, STATE))
    step[:3, :3] = step[3:6, 3:6] = step[6:9, 6:9] = back
    step[:3, 6:9], step[:3, 9:12] = -dt * back, dt * skew(centre)
    step[6:9, 9:12] = dt * skew(velocity)
    for i in range(3):
        step[3 + i, 9 + i], step[9 + i, 9 + i] = dt, 1.0
    for i in range(12, STATE):
        step[i, i] = kept
    out = sandwich(step, track.covariance)
    # White accelerations: of the velocity, and of the turn rate, which moves all that is seen.
    spread = np.zeros((STATE, 6))
    spread[:3, :3] = -np.eye(3)
    spread[:3, 3:], spread[6:9, 3:] = skew(centre), skew(velocity)
    fast, slow = np.zeros((STATE, 6)), np.zeros((STATE, 6))
    for i in range(3):
        fast[6 + i, i] = fast[9 + i, 3 + i] = slow[3 + i, 3 + i] = 1.0
    slow[:3] = spread[:3]
    slow[6:9, 3:] = fast[6:9, 3:] = spread[6:9, 3:]
    slow[6:9, 3:] = 0.0
    fast[6:9, 3:] = 0.0
    density = np.zeros((6, 6))
    for i in range(3):
        density[i, i], density[3 + i, 3 + i] = noise.acceleration, noise.turning
    cross = product(product(fast, density), slow.T.copy())
    out += dt**3 / 3 * sandwich(slow, density) + dt * sandwich(fast, density)
    out += dt**2 / 2 * (cross + cross.T)
    for i in range(12, STATE):
        out[i, i] += 1 - kept * kept
    rotation = turned(track.rotation, dt * track.rate)
    return Track(centre, rotation, velocity, track.rate, kept * track.lasting, out), step


@fast_jit
def sighted(
    track: Track, centre: Array, rotation: Array, seen: Array, noise: Noise, doubt: float
) -> Sight:
    """What a frame's pose says beside the predicted state.

    Parameters
    ----------
    centre, rotation, seen
        As of `begun`.
    doubt : float
        By which the part of the frame's error that does not last is multiplied.
    """
    size = STATE + SHAKE
    before = np.zeros((size, size))
    before[:STATE, :STATE] = track.covariance
    for i in range(STATE, size):
        before[i, i] = noise.shake
    low = lower_root(seen)
    observed = np.zeros((6, size))
    observed[:3, STATE:], observed[3:, STATE:] = skew(track.centre), np.eye(3)
    innovation = np.zeros(6)
    innovation[:3] = centre - track.centre
    innovation[3:] = rotation_vector(track.rotation, rotation)
    for i in range(6):
        observed[i, i] = 1.0
        for j in range(6):
            observed[i, 12 + j] = math.sqrt(noise.share) * low[i, j]
            innovation[i] -= observed[i, 12 + j] * track.lasting[j]
    own = doubt * (1 - noise.share) * seen
    cross = product(observed, before)
    total = own + product(cross, observed.T.copy())
    gain = solved(lower_root(total), cross).T.copy()
    return Sight(
        innovation,
        gain,
        observed,
        own,
        before,
        squared_distance(total, innovation),
        squared_distance(total[:3, :3].copy(), innovation[:3].copy()),
    )


@fast_jit
def squared_distance(covariance: Array, innovation: Array) -> float:
    """Mahalanobis distance, squared."""
    likely = solved(lower_root(covariance), innovation.reshape(len(innovation), 1))
    distance = 0.0
    for i in range(len(innovation)):
        distance += innovation[i] * likely[i, 0]
    return distance


@fast_jit
def corrected(track: Track, sight: Sight) -> tuple[Track, Array, Array]:
    """State, shaking (3,) and their joint covariance (21, 21) with a frame (Joseph's form)."""
    size = STATE + SHAKE
    change = product(sight.gain, sight.innovation.copy().reshape(6, 1))[:, 0]
    left = np.eye(size) - product(sight.gain, sight.observed)
    joint = sandwich(left, sight.before) + sandwich(sight.gain, sight.noise)
    return moved_by(track, change, joint[:STATE, :STATE].copy()), change[STATE:].copy(), joint


@fast_jit
def moved_by(track: Track, change: Array, covariance: Array) -> Track:
    """A state with a change (18,) of its error."""
    return Track(
        track.centre + change[:3],
        turned(track.rotation, change[3:6]),
        track.velocity + change[6:9],
        track.rate + change[9:12],
        track.lasting + change[12:18],
        covariance,
    )


@fast_jit
def shaken(track: Track, shake: Array, joint: Array) -> tuple[Array, Array, Array]:
    """What the shaken camera sees: centre (3,), rotation (3, 3) and the covariance of both."""
    pick = np.zeros((6, STATE + SHAKE))
    for i in range(6):
        pick[i, i] = 1.0
    back = turned(np.eye(3), -shake)
    centre = product(back, track.centre.copy().reshape(3, 1))[:, 0].copy()
    pick[:3, STATE:], pick[3:, STATE:] = skew(centre), np.eye(3)
    return centre, turned(track.rotation, shake), sandwich(pick, joint)


@fast_jit
def stepped_back(
    kept: Track, joint: Array, shake: Array, step: Array, ahead: Track, later: Track
) -> tuple[Track, Array, Array]:
    """A smoothed state from the smoothed one after it (Rauch, Tung, Striebel).

    Parameters
    ----------
    kept, joint, shake
        The state after its frame, as of `corrected`.
    step, ahead
        The transition to the next frame and the state predicted there.
    later : Track
        The smoothed state there.

    Returns
    -------
    track : Track
    shake : (3,) float64
    joint : (21, 21) float64
        Of both.
    """
    size = STATE + SHAKE
    onward = np.zeros((STATE, size))
    onward[:, :STATE] = step
    cross = product(onward, joint)
    gain = solved(lower_root(ahead.covariance), cross).T.copy()
    error = np.zeros((STATE, 1))
    error[:3, 0] = later.centre - ahead.centre
    error[3:6, 0] = rotation_vector(ahead.rotation, later.rotation)
    error[6:9, 0] = later.velocity - ahead.velocity
    error[9:12, 0] = later.rate - ahead.rate
    error[12:, 0] = later.lasting - ahead.lasting
    change = product(gain, error)[:, 0]
    out = joint + sandwich(gain, later.covariance - ahead.covariance)
    back = moved_by(kept, change, out[:STATE, :STATE].copy())
    return back, shake + change[STATE:], out
