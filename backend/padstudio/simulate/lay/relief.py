"""Bent paper: a smooth height field over the nominal plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import SpecError

#: Steeper paper could hide parts of itself, which the simulator does not look for.
STEEPEST = 0.5
#: Nodes of a relief along each side: of a pad of 1.25 m one in 2.4 mm.
NODES = 513


@dataclass(frozen=True, kw_only=True)
class Wave:
    """Sinusoidal waves about the nominal plane, as damp paper has them.

    Attributes
    ----------
    amplitude_mm : float
    length_mm : float
        From crest to crest, along the paper.
    toward_deg : float
        Compass direction (clockwise from +Y) in which the waves follow each other.
    phase_deg : float
        At the pad's centre.
    """

    amplitude_mm: float
    length_mm: float
    toward_deg: float = 90.0
    phase_deg: float = 0.0

    def height(self, along: Array) -> Array:
        """Height, mm, at distances along the paper from the pad's centre."""
        swing = 2 * math.pi * along / self.length_mm + math.radians(self.phase_deg)
        return np.asarray(self.amplitude_mm * np.sin(swing), float)


@dataclass(frozen=True, kw_only=True)
class Fold:
    """A fold that was pressed flat and stands up again: a ridge, or a valley if below 0.

    Attributes
    ----------
    height_mm : float
        Of the ridge.
    reach_mm : float
        How far from the ridge the paper has come down to 37 % of it.
    toward_deg : float
        Compass direction across the ridge.
    offset_mm : float
        Distance of the ridge from the pad's centre.
    radius_mm : float
        Over which the ridge is round.
    """

    height_mm: float
    reach_mm: float
    toward_deg: float = 90.0
    offset_mm: float = 0.0
    radius_mm: float = 3.0

    def height(self, along: Array) -> Array:
        """As `Wave.height`."""
        away = np.sqrt((along - self.offset_mm) ** 2 + self.radius_mm**2) - self.radius_mm
        return np.asarray(self.height_mm * np.exp(-away / self.reach_mm), float)


@dataclass(frozen=True, kw_only=True)
class Lift:
    """A corner or side that the wind or its roll lifts: a parabola, then straight on.

    Attributes
    ----------
    height_mm : float
        At ``offset_mm + reach_mm``, from where its slope stays.
    reach_mm : float
    toward_deg : float
        Compass direction in which it rises; 45 is the upper right corner.
    offset_mm : float
        Distance from the pad's centre at which it leaves the ground.
    """

    height_mm: float
    reach_mm: float
    toward_deg: float = 45.0
    offset_mm: float = 300.0

    def height(self, along: Array) -> Array:
        """As `Wave.height`."""
        beyond = np.maximum(along - self.offset_mm, 0) / self.reach_mm
        bent = np.minimum(beyond, 1)
        return np.asarray(self.height_mm * (bent**2 + 2 * (beyond - bent)), float)


@dataclass(frozen=True)
class Relief:
    """A smooth height field over the nominal plane: the sum of bends, each along one direction.

    Paper does not stretch. A bend of height h(s), s along the paper, draws the paper in by
    ∫ (√(1 − h′²) − 1) ds along its direction, which is exact for one bend (a cylinder) and of
    second order in the slopes for several (do Carmo, Differential Geometry of Curves and
    Surfaces, 1976, section 4-2).

    Attributes
    ----------
    bends : tuple of Wave, Fold or Lift

    Raises
    ------
    SpecError
        If a length is not above 0; paper that is too steep is refused when it is rendered.
    """

    bends: tuple[Wave | Fold | Lift, ...]

    def __post_init__(self) -> None:
        for bend in self.bends:
            if not all(math.isfinite(value) for value in vars(bend).values()):
                raise SpecError(f"{type(bend).__name__.lower()}: every figure must be finite")
            lengths = {k: v for k, v in vars(bend).items() if k in ("length_mm", "reach_mm")}
            for name, value in lengths.items():
                if not value > 0:
                    raise SpecError(f"{name} is {value}; it must be above 0")
            if isinstance(bend, Fold) and not bend.radius_mm > 0:
                raise SpecError(f"radius_mm is {bend.radius_mm}; it must be above 0")

    def nodes(self, half_x: float, half_y: float) -> Array:
        """The paper of a sheet with these half sides, at evenly spaced nodes.

        Returns
        -------
        (513, 513, 3) float64
            How far each point lies east and north of its flat place, and its height, mm; rows go
            from −``half_y`` up, columns from −``half_x``.

        Raises
        ------
        SpecError
            If the paper is steeper than `STEEPEST` somewhere.
        """
        x = np.linspace(-half_x, half_x, NODES)[None, :]
        y = np.linspace(-half_y, half_y, NODES)[:, None]
        out = np.zeros((NODES, NODES, 3))
        slopes = np.zeros((NODES, NODES, 2))
        fine = np.linspace(-1.5, 1.5, 24_001) * math.hypot(half_x, half_y)
        for bend in self.bends:
            toward = math.radians(bend.toward_deg)
            east, north = math.sin(toward), math.cos(toward)
            along = east * x + north * y
            slope = np.gradient(bend.height(fine), fine)
            _check_slope(float(np.abs(np.interp(along, fine, slope)).max()))
            drawn = np.sqrt(np.maximum(1 - slope**2, 0)) - 1
            drawn_in = np.concatenate([[0], np.cumsum((drawn[1:] + drawn[:-1]) / 2)])
            drawn_in *= fine[1] - fine[0]
            shift = np.interp(along, fine, drawn_in - np.interp(0.0, fine, drawn_in))
            out += np.stack([east * shift, north * shift, bend.height(along)], axis=-1)
            slopes += np.interp(along, fine, slope)[..., None] * np.array([east, north])
        _check_slope(float(np.linalg.norm(slopes, axis=-1).max()))
        return out


def _check_slope(steepest: float) -> None:
    if not steepest <= STEEPEST:
        raise SpecError(
            f"the paper rises by {steepest:.2f} mm a mm; the simulator's limit is {STEEPEST}, give "
            "less height or more length",
            code="paper_too_steep",
            detail={"slope": steepest, "limit": STEEPEST},
        )
