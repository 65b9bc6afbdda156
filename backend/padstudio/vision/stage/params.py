"""All parameters of the detector: frozen, keyword-only, checked where they are made."""

from __future__ import annotations

from dataclasses import dataclass, field

from padstudio.errors import SpecError


@dataclass(frozen=True, kw_only=True)
class PrepareParams:
    """Stages `denoise` and `unmix`.

    Attributes
    ----------
    impulse_share : float
        Share of salt and pepper from which the 3 × 3 median is taken.
    unmix : bool
        Un-mix frames by the pad's crosstalk where it has one.
    """

    impulse_share: float = 0.005
    unmix: bool = True

    def __post_init__(self) -> None:
        _within("impulse_share", self.impulse_share, 0.0, 1.0)


@dataclass(frozen=True, kw_only=True)
class SearchParams:
    """Where and at which scales the dense method looks.

    Attributes
    ----------
    coarsest_px, finest_px : int
        A region is looked at from the scale where its longer side is about `coarsest_px` to the
        one where it is below `finest_px`.
    least_edges : int
        Fewer edges than this are not worth a look.
    least_order : float
        Share of edges on grid lines from which a lattice is tried against the pad.
    """

    coarsest_px: int = 90
    finest_px: int = 900
    least_edges: int = 40
    least_order: float = 0.5

    def __post_init__(self) -> None:
        _within("coarsest_px", self.coarsest_px, 32, 4096)
        _within("finest_px", self.finest_px, self.coarsest_px, 65536)
        _within("least_edges", self.least_edges, 16, 100_000)
        _within("least_order", self.least_order, 0.3, 1.0)


@dataclass(frozen=True, kw_only=True)
class RefineParams:
    """How the pose is measured on the borders of cells.

    Attributes
    ----------
    most_borders : int
        More borders of a layer than this are thinned evenly, in a still.
    followed_borders : int
        The same where the last frame's pose is followed; `most_borders` bounds it, too.
    few_borders : int
        How many of them bring the pose near enough for the rest.
    least_cell_px : float
        Layers whose cells are smaller than this in the frame are not measured.
    align_below_px : float
        Where the pad's finest cells are smaller than this, the pattern is matched as a whole
        rather than border by border.
    motion : bool
        Let the pose change within a frame where the residuals ask for it (rolling shutter).
    """

    most_borders: int = 3000
    followed_borders: int = 1000
    few_borders: int = 300
    least_cell_px: float = 3.2
    align_below_px: float = 5.0
    motion: bool = True

    def __post_init__(self) -> None:
        _within("most_borders", self.most_borders, 50, 1_000_000)
        _within("followed_borders", self.followed_borders, 50, 1_000_000)
        _within("few_borders", self.few_borders, 50, self.most_borders)
        _within("least_cell_px", self.least_cell_px, 2.0, 100.0)
        _within("align_below_px", self.align_below_px, 0.0, 100.0)


@dataclass(frozen=True, kw_only=True)
class PaperParams:
    """The paper's method.

    Attributes
    ----------
    coarsest_px, finest_px : int
        The pad's part of the frame is looked at from the scale where its longer side is at most
        `coarsest_px` to the one where it is at most `finest_px`.
    blocks : int
        Blocks of the block mean along the longer side.
    speck_px : int
        Erosion and dilation remove what cannot hold a square of this side.
    log10_false_alarm : float
        As of `DetectorParams`, over the cells of the lattice; one window alone reaches about −3.
    most_position_share, most_attitude_deg : float
        A pose from four corners is refused where one standard deviation of the position is above
        this share of the height, or that of the attitude above this angle.
    """

    coarsest_px: int = 700
    finest_px: int = 1400
    blocks: int = 4
    speck_px: int = 3
    log10_false_alarm: float = -4.0
    most_position_share: float = 0.03
    most_attitude_deg: float = 3.0

    def __post_init__(self) -> None:
        _within("coarsest_px", self.coarsest_px, 64, 65536)
        _within("finest_px", self.finest_px, self.coarsest_px, 65536)
        _within("blocks", self.blocks, 1, 1000)
        _within("speck_px", self.speck_px, 1, 99)
        _within("log10_false_alarm", self.log10_false_alarm, -300, -1)
        _within("most_position_share", self.most_position_share, 0.0, 1.0)
        _within("most_attitude_deg", self.most_attitude_deg, 0.0, 90.0)


@dataclass(frozen=True, kw_only=True)
class DetectorParams:
    """Parameters of the whole pipeline.

    Attributes
    ----------
    log10_false_alarm : float
        A pose is given only where the bound on the chance of a false match is below this power
        of ten.
    prepare : PrepareParams
    search : SearchParams
    refine : RefineParams
    paper : PaperParams
    """

    log10_false_alarm: float = -6.0
    prepare: PrepareParams = field(default_factory=PrepareParams)
    search: SearchParams = field(default_factory=SearchParams)
    refine: RefineParams = field(default_factory=RefineParams)
    paper: PaperParams = field(default_factory=PaperParams)

    def __post_init__(self) -> None:
        _within("log10_false_alarm", self.log10_false_alarm, -300, -2)


def _within(name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise SpecError(f"{name} is {value}; it must lie within {low} … {high}")
