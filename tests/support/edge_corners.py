"""Corners of a checkerboard from the light that its edges divide.

Exact for area-sampled pictures, where `cv2.cornerSubPix` is off by up to 0.1 px, because edges are
sharper than a pixel.
"""

import numpy as np

REACH, NEAR, FAR = 5, 8, 16


def measured_corner(image, corner, along, across):
    """Where the curves of two edges through a corner cross.

    ``image`` (H, W) float; ``corner`` (2,) the expected place; ``along`` and ``across`` (2,) the
    directions of its edges.
    """
    first, second = (_curve(image, corner, direction) for direction in (along, across))
    x, y = corner
    for _ in range(20):
        for axis, coefficients in (first, second):
            if axis == 1:
                x = corner[0] + np.polyval(coefficients, y - corner[1])
            else:
                y = corner[1] + np.polyval(coefficients, x - corner[0])
    return np.array([x, y])


def _curve(image, corner, direction):
    """The edge's sideways place as a cubic of its lengthwise one, and its lengthwise axis."""
    axis = int(abs(direction[1]) > abs(direction[0]))
    rows = image if axis == 1 else image.T
    side, length = corner[1 - axis], corner[axis]
    slope = direction[1 - axis] / direction[axis]
    steps, places = [], []
    for offset in (*range(-FAR, -NEAR + 1), *range(NEAR, FAR + 1)):
        row = round(length) + offset
        middle = round(side + slope * (row - length))
        values = rows[row, middle - REACH : middle + REACH + 1]
        left, right = values[0], values[-1]
        share = (values - right).sum() / (left - right)
        steps.append(row - length)
        places.append(middle - REACH - 0.5 + share - side)
    return axis, np.polyfit(steps, places, 3)
