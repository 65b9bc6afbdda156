"""How a printer and a camera mix the pad's colours, as far as a pad keeps it.

The matrix comes from a photo of the test strip (`padstudio.vision.strip_photo`). Linear light in
camera channel i, as a share of what white paper gives, is ``matrix[i] @ nominal`` for nominal
channels 0 … 1 in RGB order, plus what black gives.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import PadFormatError

Row = tuple[float, float, float]
Matrix = tuple[Row, Row, Row]

#: Beyond this condition number un-mixing would blow noise up more than it takes apart.
MOST_CONDITION = 50.0
#: Below this share of white the cells of a layer hardly stand out in their channel.
LEAST_SEPARATION = 0.15
# Black, red, blue, magenta and white; red is full in the 2nd, 4th and 5th.
_COLORS = np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1]], float)


def check_matrix(matrix: Sequence[Sequence[float]] | NDArray[np.float64]) -> Matrix:
    """The matrix as tuples of plain numbers.

    Raises
    ------
    PadFormatError
        If it is not 3 x 3 finite numbers, or cannot be undone.
    """
    try:
        values = np.array(matrix, float)
    except (TypeError, ValueError, OverflowError) as error:
        raise PadFormatError("crosstalk must be three rows of three numbers") from error
    if values.shape != (3, 3) or not (np.abs(values) <= 10).all():
        raise PadFormatError("crosstalk must be three rows of three numbers within -10 … 10")
    # Un-mixing keeps white, so what gives white must be a light that can be.
    if np.linalg.cond(values) > MOST_CONDITION or np.linalg.inv(values).sum(axis=1).min() <= 0:
        raise PadFormatError(
            "crosstalk: these colours cannot be told apart well enough to un-mix them; photograph "
            "the test strip again, or use purer inks"
        )
    rows = values.tolist()
    return tuple(rows[0]), tuple(rows[1]), tuple(rows[2])


def separation(matrix: Matrix) -> tuple[float, float]:
    """By how much the red and the blue layer stand out, each in its own channel, of white.

    The darkest colour in which the channel is full, less the brightest in which it is dark.
    """
    seen = _COLORS @ np.array(matrix).T
    red, blue = (
        float(seen[_COLORS[:, k] == 1, k].min() - seen[_COLORS[:, k] == 0, k].max()) for k in (0, 2)
    )
    return red, blue


def separation_warnings(red: float, blue: float) -> list[str]:
    """What is wrong with two layers that stand out by so much, in plain words."""
    close = [
        f"the {name} layer stands out by {value:.0%} of white in its channel"
        for name, value in (("red", red), ("blue", blue))
        if value < LEAST_SEPARATION
    ]
    if not close:
        return []
    return [
        f"red and blue are too close: {' and '.join(close)}, and should by {LEAST_SEPARATION:.0%}; "
        "use purer inks"
    ]
