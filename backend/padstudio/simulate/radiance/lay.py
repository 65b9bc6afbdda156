"""How a print lies: bent paper, and prints of many sheets that are not laid exactly."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import SpecError
from padstudio.geometry.pose import Pose

#: Steeper paper could hide parts of itself, which the simulator does not look for.
STEEPEST = 0.5
# Nodes of a relief along each side: of a pad of 1.25 m one in 2.4 mm.
_NODES = 513


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
        x = np.linspace(-half_x, half_x, _NODES)[None, :]
        y = np.linspace(-half_y, half_y, _NODES)[:, None]
        out = np.zeros((_NODES, _NODES, 3))
        slopes = np.zeros((_NODES, _NODES, 2))
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


@dataclass(frozen=True, kw_only=True)
class Tiles:
    """A print of many sheets of equal size, laid side by side by hand.

    Attributes
    ----------
    columns, rows : int
        1 … 40 each.
    gap_mm : float
        Between neighbours, on the whole; below 0 they overlap.
    offset_mm : float
        Each sheet lies up to so much off its place, in x and in y.
    turn_deg : float
        Each sheet is turned by up to so much.
    swaps : int
        So many pairs of sheets are exchanged.
    seed : int
    """

    columns: int
    rows: int
    gap_mm: float = 0.0
    offset_mm: float = 0.0
    turn_deg: float = 0.0
    swaps: int = 0
    seed: int = 0

    def __post_init__(self) -> None:
        for name, low, high in _TILE_RANGES:
            value = getattr(self, name)
            if not low <= value <= high:
                raise SpecError(f"{name} is {value}; it must lie within {low} … {high}")
        if 2 * self.swaps > self.columns * self.rows:
            raise SpecError(
                f"{self.swaps} pairs of sheets are to be exchanged, of {self.columns * self.rows} "
                "sheets; give fewer"
            )

    def placed(self, half_x: float, half_y: float) -> Array:
        """Where the sheets of a print with these half sides lie.

        Returns
        -------
        (N, 8) float64
            Centre, cosine and sine of the turn, half sides, centre on the whole print; mm.
        """
        rng = np.random.default_rng([self.seed, *b"tiles"])
        side_x, side_y = half_x / self.columns, half_y / self.rows
        column, row = np.meshgrid(np.arange(self.columns), np.arange(self.rows))
        across = (column - (self.columns - 1) / 2).ravel()
        up = (row - (self.rows - 1) / 2).ravel()
        count = len(across)
        offset = rng.uniform(-self.offset_mm, self.offset_mm, (count, 2))
        turn = np.radians(rng.uniform(-self.turn_deg, self.turn_deg, count))
        shown = np.arange(count)
        pairs = rng.permutation(count)[: 2 * self.swaps].reshape(-1, 2)
        shown[pairs] = pairs[:, ::-1]
        return np.stack(
            [
                across * (2 * side_x + self.gap_mm) + offset[:, 0],
                up * (2 * side_y + self.gap_mm) + offset[:, 1],
                np.cos(turn),
                np.sin(turn),
                np.full(count, side_x),
                np.full(count, side_y),
                across[shown] * 2 * side_x,
                up[shown] * 2 * side_y,
            ],
            axis=1,
        )


_TILE_RANGES = (
    ("columns", 1, 40),
    ("rows", 1, 40),
    ("gap_mm", -20.0, 100.0),
    ("offset_mm", 0.0, 50.0),
    ("turn_deg", 0.0, 10.0),
    ("swaps", 0, 800),
)


def best_fit(lay: Relief | Tiles, half_mm: tuple[float, float], pose: Pose) -> Pose:
    """The pose relative to the plane that fits a print best, rather than to the nominal one.

    The rigid motion from the flat print to the print as it lies, by least squares over its whole
    area (Umeyama 1991, doi:10.1109/34.88573, without scale).

    Parameters
    ----------
    lay : Relief or Tiles
    half_mm : (x, y)
        Half sides of the print.
    pose : Pose
        Relative to the nominal plane.
    """
    flat, bent = _points(lay, half_mm)
    middle, there = flat.mean(axis=0), bent.mean(axis=0)
    u, _, vt = np.linalg.svd((bent - there).T @ (flat - middle))
    turn = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
    shift = there - turn @ middle
    return Pose(turn.T @ (pose.position_mm - shift), turn.T @ pose.rotation)


def laid(lay: Relief | Tiles, half_mm: tuple[float, float], points: Array) -> Array:
    """Where points of the flat print (N, 2) lie, (N, 3), mm, pad frame.

    Raises
    ------
    SpecError
        As `Relief.nodes`.
    """
    half = np.array(half_mm)
    if isinstance(lay, Relief):
        nodes = lay.nodes(*half_mm)
        at = np.clip((points / half + 1) / 2, 0, 1) * (_NODES - 1)
        first = np.minimum(at.astype(int), _NODES - 2)
        f, g = (at - first).T[:, :, None]
        c, r = first.T
        below = (1 - f) * nodes[r, c] + f * nodes[r, c + 1]
        above = (1 - f) * nodes[r + 1, c] + f * nodes[r + 1, c + 1]
        flat = np.column_stack([points, np.zeros(len(points))])
        return np.asarray(flat + (1 - g) * below + g * above, float)
    tiles = lay.placed(*half_mm)
    away = np.abs(points[:, None, :] - tiles[None, :, 6:8]) - tiles[None, :, 4:6]
    mine = tiles[np.argmin(away.max(axis=-1), axis=1)]
    u, v = (points - mine[:, 6:8]).T
    x = mine[:, 0] + mine[:, 2] * u - mine[:, 3] * v
    y = mine[:, 1] + mine[:, 3] * u + mine[:, 2] * v
    return np.stack([x, y, np.zeros(len(points))], axis=1)


def _points(lay: Relief | Tiles, half_mm: tuple[float, float]) -> tuple[Array, Array]:
    """(N, 3) points all over the flat print, and where they lie."""
    # Off the seams of any tiling.
    x, y = (half * (np.arange(81) - 40) / 40.37 for half in half_mm)
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return np.column_stack([points, np.zeros(len(points))]), laid(lay, half_mm, points)


def _check_slope(steepest: float) -> None:
    if not steepest <= STEEPEST:
        raise SpecError(
            f"the paper rises by {steepest:.2f} mm a mm; the simulator's limit is {STEEPEST}, give "
            "less height or more length",
            code="paper_too_steep",
            detail={"slope": steepest, "limit": STEEPEST},
        )
