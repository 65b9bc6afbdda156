"""All parameters of the detector: frozen, keyword-only, checked where they are made.

`padstudio.vision.stage.parameter.parameters_of` lists them; docs/detection.md holds the table.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from padstudio.vision.stage.parameter import Scope, check, parameter, switch


def _both(*stages: str) -> Scope:
    return Scope(stages)


def _dense(*stages: str) -> Scope:
    return Scope(stages, ("dense",))


def _paper(*stages: str) -> Scope:
    return Scope(stages, ("paper",))


_FOLLOWED = Scope(("pose",), ("dense",), followed=True)


class Group:
    """Parameters that are held to their ranges as soon as they are made."""

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, kw_only=True)
class PrepareParams(Group):
    """Stages `denoise` and `unmix`."""

    impulse_share: float = parameter(
        0.005, 0.0, 1.0, "share",
        "The 3 × 3 median is taken where a larger share of pixels is salt and pepper; it costs "
        "time and fine detail.",
        _both("denoise"),
    )  # fmt: skip
    unmix: bool = switch(
        True,
        "Take the colours apart by the pad's crosstalk, where the pad has one.",
        _both("unmix"),
    )


@dataclass(frozen=True, kw_only=True)
class SearchParams(Group):
    """Where and at which scales the dense method looks for a lattice."""

    coarsest_px: int = parameter(
        90, 32, 4096, "px",
        "A region is first looked at where its longer side is about so long; larger leaves out "
        "the scales that show near pads soonest.",
        _dense("channel"),
    )  # fmt: skip
    finest_px: int = parameter(
        900, "coarsest_px", 65536, "px",
        "A region is last looked at as a whole where its longer side is below this, finer only "
        "its middle of this side; larger finds smaller cells, and takes longer over frames without "
        "a pad; smaller thins the edges of many small cells less.",
        _dense("channel"),
    )  # fmt: skip
    least_edges: int = parameter(
        40, 16, 100_000, "",
        "Fewer edge points than this are not searched for lines; less reaches fewer cells in "
        "view.",
        _dense("edges"),
    )  # fmt: skip
    least_order: float = parameter(
        0.5, 0.3, 1.0, "share",
        "A lattice is compared with the pad where at least this share of edge points lies on its "
        "lines; less reaches blurred and covered pads, and compares more in vain.",
        _dense("grid"),
    )  # fmt: skip
    least_step: float = parameter(
        0.6, 0.1, 50.0, "grey/px",
        "An edge point's brightness changes by more than this, after the stretch; less reaches "
        "faint print, and lets noise through.",
        _dense("edges"),
    )  # fmt: skip
    most_edges: int = parameter(
        16_000, 1000, 1_000_000, "",
        "More edge points than this are thinned evenly; fewer are faster, and lose small cells.",
        _dense("edges"),
    )  # fmt: skip
    most_tries: int = parameter(
        6, 1, 1000, "",
        "So many looks of much promise are searched for a lattice at once, and as many of the rest "
        "in the end; more reach worse frames, and take longer over frames without a pad.",
        _dense("lines"),
    )  # fmt: skip
    most_unsure: int = parameter(
        6, 0, 1000, "",
        "Of the lattices with much clutter between their lines so many are compared with the pad; "
        "more reach worse frames, and take longer over frames without a pad.",
        _dense("decode"),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class OutlineParams(Group):
    """The four sides of the whole pad."""

    largest_px: int = parameter(
        800, 32, 65536, "px",
        "The dense method looks for four sides where a region's longer side is at most this, "
        "before any lattice; smaller misses far pads, and is slower.",
        _dense("outline"),
    )  # fmt: skip
    least_side_px: float = parameter(
        30.0, 8.0, 10_000.0, "px",
        "A pad with a shorter side in the frame has no outline; less reaches farther, and errs "
        "more often.",
        _both("outline"),
    )  # fmt: skip
    most_profiles: int = parameter(
        240, 8, 10_000, "",
        "So many short profiles across a side at the most; more are slower and surer.",
        _both("outline"),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class RefineParams(Group):
    """How the pose is fitted to the borders of cells."""

    most_borders: int = parameter(
        3000, 50, 1_000_000, "",
        "In a still, more borders of a layer than this are thinned evenly; more are slower and "
        "surer.",
        _dense("pose", "outline"),
    )  # fmt: skip
    followed_borders: int = parameter(
        1000, 50, 1_000_000, "",
        "The same where the last frame's pose is followed; `most_borders` bounds it, too.",
        _FOLLOWED,
    )  # fmt: skip
    few_borders: int = parameter(
        300, 50, "most_borders", "",
        "So many borders bring the pose near enough for the rest; fewer are faster and miss more "
        "starts.",
        _dense("pose", "outline"),
    )  # fmt: skip
    least_cell_px: float = parameter(
        3.2, 2.0, 100.0, "px",
        "Layers whose cells are smaller than this in the frame are not fitted.",
        _dense("pose", "outline"),
    )  # fmt: skip
    align_below_px: float = parameter(
        5.0, 0.0, 100.0, "px",
        "Where the pad's finest cells are smaller than this, the pattern is matched as a whole "
        "rather than border by border.",
        _dense("pose", "outline"),
    )  # fmt: skip
    most_pixels: int = parameter(
        16_000, 500, 10_000_000, "",
        "In a still, the pattern as a whole is matched by at most so many pixels; more are slower "
        "and surer.",
        _dense("pose", "outline"),
    )  # fmt: skip
    followed_pixels: int = parameter(
        8000, 500, 10_000_000, "",
        "The same where the last frame's pose is followed; `most_pixels` bounds it, too.",
        _FOLLOWED,
    )  # fmt: skip
    reach_px: float = parameter(
        6.0, 2.0, 50.0, "px",
        "Half length of the profiles across borders, at the scale where cells are about 9 px "
        "wide; longer forgive a worse start, shorter ones are less exact.",
        _dense("pose", "outline"),
    )  # fmt: skip
    most_residual_cells: float = parameter(
        0.12, 0.02, 1.0, "cells",
        "A pose is refused where borders lie farther off than this and a pixel, root mean "
        "square; larger bears with bent pads and poor camera files.",
        _dense("pose", "outline"),
    )  # fmt: skip
    log10_followed: float = parameter(
        -3.0, -300.0, -1.0, "log10",
        "Where the pad is followed, this stands for `log10_false_alarm`: the frame before has "
        "borne it out, and only places near the expected one compete; higher follows closer to "
        "the pad.",
        _FOLLOWED,
    )  # fmt: skip
    log10_sure: float = parameter(
        -30.0, -300.0, -6.0, "log10",
        "Where the last frame's pose is followed, every layer is read unless the fitted one "
        "alone leaves a chance below this power of ten; lower is slower.",
        _FOLLOWED,
    )  # fmt: skip
    motion: bool = switch(
        True,
        "Let the pose change within a frame where the residuals ask for it (rolling shutter); "
        "off for a global shutter, where the camera file does not say `readout_ms: 0`.",
        _dense("pose", "outline"),
    )
    at_rest: bool = switch(
        False,
        "The camera stands still, as on a tripod: nothing moves while the shutter rolls or is "
        "open, so that a frame is as sure as its borders; wrong for a camera that moves.",
        _dense("pose", "outline"),
    )
    bend: bool = switch(
        True,
        "In a still, ask whether the paper is bent or its sheets lie off their places, and fit "
        "that with the pose; off takes it for flat, and saves up to a second where it is not.",
        _dense("pose"),
    )


@dataclass(frozen=True, kw_only=True)
class PaperParams(Group):
    """The paper's method."""

    coarsest_px: int = parameter(
        700, 64, 65536, "px",
        "The pad's part of the frame is first looked at where its longer side is at most this.",
        _paper("channel"),
    )  # fmt: skip
    finest_px: int = parameter(
        1400, "coarsest_px", 65536, "px",
        "It is last looked at where its longer side is at most this; larger finds smaller cells, "
        "and takes longer.",
        _paper("channel"),
    )  # fmt: skip
    blocks: int = parameter(
        4, 1, 1000, "",
        "Blocks of the block mean along the longer side; more follow uneven light more closely, "
        "and blur large cells.",
        _paper("block_mean"),
    )  # fmt: skip
    speck_px: int = parameter(
        3, 1, 99, "px",
        "Erosion and dilation remove what cannot hold a square of this side.",
        _paper("clean"),
    )  # fmt: skip
    log10_false_alarm: float = parameter(
        -4.0, -300.0, -1.0, "log10",
        "A pose is given where the bound on the chance of a false match, over the cells of the "
        "lattice, is below this power of ten; one window alone reaches about −3.",
        _paper("decode"),
    )  # fmt: skip
    canny_low: float = parameter(
        40.0, 0.0, 1000.0, "grey values",
        "Canny's lower threshold, of a pad of more than two levels; less keeps fainter edges.",
        _paper("edges"),
    )  # fmt: skip
    canny_high: float = parameter(
        110.0, "canny_low", 1000.0, "grey values",
        "Canny's upper threshold, likewise; less begins more edges.",
        _paper("edges"),
    )  # fmt: skip
    hough_votes: int = parameter(
        20, 1, 10_000, "",
        "Edge pixels that a line must gather in the Hough transform; fewer find shorter lines, "
        "and more of them that are none.",
        _paper("lines"),
    )  # fmt: skip
    hough_length: float = parameter(
        0.035, 0.001, 0.5, "share of the picture's longer side",
        "A segment must be so long; less finds the lines of smaller cells, and takes longer.",
        _paper("lines"),
    )  # fmt: skip
    hough_gap: float = parameter(
        0.015, 0.0, 0.5, "share of the picture's longer side",
        "A segment may have gaps of this length: cells of equal level have no border between "
        "them.",
        _paper("lines"),
    )  # fmt: skip
    most_off_cells: float = parameter(
        0.35, 0.01, 1.0, "cells",
        "A pose from four corners is refused where it puts the lattice's other cells farther "
        "off than this, root mean square.",
        _paper("pose"),
    )  # fmt: skip
    most_position_share: float = parameter(
        0.03, 0.0, 1.0, "share of height",
        "A pose from four corners is refused where one standard deviation of its position is "
        "above this share of the height.",
        _paper("pose", "outline"),
    )  # fmt: skip
    most_attitude_deg: float = parameter(
        3.0, 0.0, 90.0, "degrees",
        "A pose from four corners is refused where one standard deviation of its attitude is "
        "above this angle.",
        _paper("pose", "outline"),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class DetectorParams(Group):
    """Parameters of the detector."""

    log10_false_alarm: float = parameter(
        -6.0, -300.0, -2.0, "log10",
        "A pose is given where the bound on the chance of a false match is below this power of "
        "ten; higher reaches fewer cells in view, and errs more often.",
        _both("choose", "decode", "pose", "outline"),
    )  # fmt: skip
    prepare: PrepareParams = field(default_factory=PrepareParams)
    search: SearchParams = field(default_factory=SearchParams)
    outline: OutlineParams = field(default_factory=OutlineParams)
    refine: RefineParams = field(default_factory=RefineParams)
    paper: PaperParams = field(default_factory=PaperParams)
