"""The dense method's search: from a frame without any hint to a place on the pad.

Regions of pad colour, scales from coarse to fine, channels: the first lattice whose cells agree
with the pad beyond chance ends the search, so that near pads cost little more than a thumbnail.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Channel
from padstudio.vision.cells.correlation import LayerIndex, Placement
from padstudio.vision.cells.sampling import CellGrid, read_cells
from padstudio.vision.frame.prepare import Stretch, take_channel
from padstudio.vision.frame.pyramid import Plane, Pyramid
from padstudio.vision.frame.regions import Region
from padstudio.vision.search.edges import EdgeSet, find_edges
from padstudio.vision.search.lattice import Lattice, find_lattice
from padstudio.vision.search.line_spacing import find_lines
from padstudio.vision.search.plane_normals import find_axes
from padstudio.vision.stage.params import DetectorParams, SearchParams
from padstudio.vision.stage.trace import Reason, Recorder, StageFailure


@dataclass(frozen=True, eq=False)
class Sighting:
    """A lattice in the picture and the place on the pad that its cells show."""

    lattice: Lattice
    placement: Placement
    region: Region


@dataclass(frozen=True)
class Search:
    """What a search needs to know of its frame; `indices` stand coarse layer first.

    `lattices` gathers what was tried against the pad: each try weakens the evidence of the next;
    `edges` what was found of a region, at a level and in a channel, for the next round.
    """

    pyramid: Pyramid
    camera: Camera
    stretch: Stretch
    indices: dict[Channel, LayerIndex]
    params: DetectorParams
    recorder: Recorder
    lattices: list[Lattice] = field(default_factory=list)
    edges: dict[tuple[Region, int, Channel], EdgeSet] = field(default_factory=dict)


@dataclass(frozen=True)
class Miss:
    """The attempt that came nearest to an answer, and where it failed."""

    failure: StageFailure
    region: Region
    level: int
    cells: int = 0
    match: float = 0.0


def sightings(frame: Search, regions: list[Region]) -> Iterator[Sighting | Miss]:
    """Look for the pad in regions of a frame, at every scale, in every layer's channel.

    Yields
    ------
    Sighting
        Lattices whose cells agree with the pad, as they are found: those with most inliers of a
        round first, then the others, the round of steep planes last.
    Miss
        At the end: what came nearest, for the diagnosis.
    """
    nothing = StageFailure("edges", Reason.NO_EDGES, "no edges stand out in any channel")
    nearest = Miss(nothing, regions[0], 0)
    # Both rounds see the same regions, and none is cut out before it is looked at.
    first, second = itertools.tee(_looks(regions, frame.params.search))
    for steep, looks in ((False, first), (True, second)):
        unsure: list[tuple[Lattice, Region]] = []
        for region, level in looks:
            for channel in frame.indices:
                lattice = find(frame, region, level, channel, steep=steep)
                if isinstance(lattice, StageFailure):
                    nearest = _nearer(nearest, Miss(lattice, region, level))
                    continue
                if lattice.inlier_share < _CLEAR_SHARE:
                    unsure.append((lattice, region))
                    continue
                placed = place(frame, lattice, region)
                if isinstance(placed, Sighting):
                    yield placed
                else:
                    nearest = _nearer(nearest, placed)
        unsure.sort(key=lambda item: -item[0].inlier_share)
        for lattice, region in unsure[: frame.params.search.most_unsure]:
            placed = place(frame, lattice, region)
            if isinstance(placed, Sighting):
                yield placed
            else:
                nearest = _nearer(nearest, placed)
    yield nearest


def _nearer(a: Miss, b: Miss) -> Miss:
    """The failure of the later stage; of two, the better match, then the one of more cells."""
    return max(a, b, key=lambda miss: (miss.failure.progress, miss.match, miss.cells))


def _looks(regions: list[Region], params: SearchParams) -> Iterator[tuple[Region, int]]:
    """Regions at the scales that suit them; at finer ones their middle, where it pays."""
    for region in regions:
        coarsest = max(0, math.floor(math.log2(max(region.box.side / params.coarsest_px, 1))))
        finest = max(0, math.ceil(math.log2(max(region.box.side / params.finest_px, 1))))
        for level in range(max(coarsest, finest), finest - 1, -1):
            yield region, level
        if region.mask is not None:
            for level in range(finest - 1, -1, -1):
                yield region.middle(params.finest_px << level), level


# Lattices of a smaller share of inliers are tried only when a round has found no better one; 0.7
# and 0.95 find the same stills of the score.
_CLEAR_SHARE = 0.85
# Axes that edges agree with so little are not worth a look; 0.06 and 0.24 find the same stills.
_LEAST_COHERENCE = 0.12
# These two pick a sentence. Cells of such a kappa, but too few to be sure, are a matter of number.
_ALIKE = 0.8
# More cells than these do not agree by the number that is missing.
_FEW_CELLS = 100


def find(
    frame: Search, region: Region, level: int, channel: Channel, *, steep: bool
) -> Lattice | StageFailure:
    """Look for a lattice in one channel of one region at one scale."""
    look = (region, level, channel)
    if look not in frame.edges:
        frame.edges[look] = _find_edges(frame, *look)
    edges = frame.edges[look]
    if len(edges.xy) < frame.params.search.least_edges:
        return StageFailure(
            "edges", Reason.NO_EDGES, f"only {len(edges.xy)} edge points in {channel}"
        )
    return _lattice(frame, edges, channel, steep=steep)


def _find_edges(frame: Search, region: Region, level: int, channel: Channel) -> EdgeSet:
    recorder = frame.recorder
    plane = recorder.run(
        "channel", channel, take_channel, frame.pyramid, frame.stretch, channel, level, region.box
    )
    return recorder.run("edges", channel, _edges_in, plane, frame, region)


def _edges_in(plane: Plane, frame: Search, region: Region) -> EdgeSet:
    edges = find_edges(plane, frame.camera, frame.params.search)
    return edges.take(region.holds(edges.xy)) if region.mask is not None else edges


def _lattice(
    frame: Search, edges: EdgeSet, channel: Channel, *, steep: bool
) -> Lattice | StageFailure:
    """The lattice of most inliers over the candidate axes."""
    recorder = frame.recorder
    best: Lattice | None = None
    coherence = 0.0
    for score, axes in recorder.run("lines", channel, find_axes, edges, steep=steep):
        coherence = max(coherence, score)
        if score < _LEAST_COHERENCE:
            break
        families = recorder.run("lines", channel, find_lines, edges, score, axes)
        if families is None:
            continue
        lattice = recorder.run("grid", channel, find_lattice, families)
        if lattice is not None and (best is None or lattice.inlier_share > best.inlier_share):
            best = lattice
        if best is not None and best.inlier_share > 0.9:
            break
    if best is None:
        return StageFailure(
            "lines",
            Reason.TOO_FEW_LINES,
            f"{len(edges.xy)} edge points in {channel} show no two directions at right angles "
            f"(agreement {coherence:.2f} of 1)",
        )
    if best.inlier_share < frame.params.search.least_order:
        return StageFailure(
            "grid",
            Reason.NO_LATTICE,
            f"{100 * best.inlier_share:.0f} % of the edge points in {channel} lie on an even grid, "
            f"{100 * frame.params.search.least_order:.0f} % are needed; chance gives 28 %",
        )
    recorder.note("grid", channel, best)
    return best


def place(frame: Search, lattice: Lattice, region: Region) -> Sighting | Miss:
    """Read a lattice's cells in every layer's channel, and look for their place on the pad.

    Where they agree but are too few, the lattice is carried on over the picture: close to the
    ground a region of one colour may hold a few cells of many.
    """
    found = _compared(frame, lattice, region)
    if isinstance(found, Sighting) or found.failure.reason is not Reason.TOO_FEW_CELLS:
        return found
    if not 0 < found.cells <= _FEW_CELLS:
        return found
    wider = _compared(frame, lattice.widened(), region)
    return wider if isinstance(wider, Sighting) else found


def _compared(frame: Search, lattice: Lattice, region: Region) -> Sighting | Miss:
    best: Placement | None = None
    frame.lattices.append(lattice)
    attempts = len(frame.lattices) * len(frame.indices)
    for channel, index in frame.indices.items():
        cells = frame.recorder.run("decode", channel, read_lattice, frame, lattice, channel)
        if cells is None:
            continue
        placement = frame.recorder.run("decode", channel, index.locate, cells, attempts)
        if placement is None:
            continue
        if placement.evidence.suffices(frame.params.log10_false_alarm):
            return Sighting(lattice, placement, region)
        if best is None or placement.evidence.kappa > best.evidence.kappa:
            best = placement
    level = lattice.families.edges.plane.level
    if best is None:
        failure = StageFailure("decode", Reason.TOO_FEW_CELLS, "no cell of the grid lies in view")
        return Miss(failure, region, level)
    evidence = best.evidence
    failure = StageFailure(
        "decode",
        Reason.TOO_FEW_CELLS if evidence.kappa > _ALIKE else Reason.UNKNOWN_CODE,
        f"read {evidence.read} cells; at the best place of this pad {evidence.wrong} differ "
        f"({evidence.compared_with(frame.params.log10_false_alarm)})",
    )
    return Miss(failure, region, level, evidence.read, -evidence.log10_false_alarm)


def read_lattice(frame: Search, lattice: Lattice, channel: Channel) -> CellGrid | None:
    """The cells of a lattice as one channel shows them, those at its rim too."""

    def to_pixels(coordinates: Array) -> Array:
        return frame.camera.denormalize(lattice.to_rays(coordinates))

    # Beyond the last line in view lie cells that are cut by the frame's edge.
    columns = (lattice.columns[0] - 1, lattice.columns[1] + 1)
    rows = (lattice.rows[0] - 1, lattice.rows[1] + 1)
    return read_cells(frame.pyramid, channel, to_pixels, columns, rows)
