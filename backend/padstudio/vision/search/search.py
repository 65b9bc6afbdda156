"""The dense method's search: from a frame without any hint to a place on a pad.

Regions, scales from coarse to fine, channels: the first lattice whose cells agree with the pad
beyond chance ends the search, so that near pads cost little more than a thumbnail. Without a pad
the tries are bounded: only so many looks are followed up.
Several pads share all of it but the comparison of cells.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import tee, zip_longest

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Channel
from padstudio.vision.cells.correlation import Placement
from padstudio.vision.cells.sampling import CellGrid, read_cells
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import Region
from padstudio.vision.search.edges import EdgeSet
from padstudio.vision.search.foreign import is_foreign
from padstudio.vision.search.known_pads import KnownPad
from padstudio.vision.search.lattice import Lattice, find_lattice
from padstudio.vision.search.line_spacing import find_lines
from padstudio.vision.search.looks import Look, Search
from padstudio.vision.search.periodic_axes import find_periodic_axes
from padstudio.vision.search.plane_normals import find_axes
from padstudio.vision.stage.trace import Reason, StageFailure


@dataclass(frozen=True, eq=False)
class Sighting:
    """A lattice in the picture and the place on a pad that its cells show."""

    known: KnownPad
    lattice: Lattice
    placement: Placement
    region: Region


@dataclass(frozen=True)
class Miss:
    """The attempt that came nearest to an answer, and where it failed."""

    failure: StageFailure
    region: Region
    level: int
    cells: int = 0
    match: float = 0.0


def sightings(frame: Search, regions: Iterable[Region]) -> Iterator[Sighting | Miss]:
    """Look for pads in regions of a frame, at every scale, in every layer's channel.

    Looks of much promise are searched for a lattice at once, in their order; in the end those that
    promise most of the rest, and of steep planes. Both times so many are searched at the most,
    whatever the picture holds. When a pad was found (`Search.found`), the rest is looked at again
    without it; looks that do not show it are not searched twice.

    Yields
    ------
    Sighting
        Lattices whose cells agree with a pad, as they are found, those of much clutter last.
    Miss
        At the end: what came nearest, for the diagnosis.
    """
    tries = _Tries(frame)
    regions, again = tee(regions)
    while True:
        before = len(frame.found)
        for sighting in _round(tries, regions):
            yield sighting
            if len(frame.found) > before:
                break
        else:
            break
        regions, again = tee(again)
    yield tries.nearest


def _round(tries: _Tries, regions: Iterable[Region]) -> Iterator[Sighting]:
    """All looks once that were not searched before."""
    frame = tries.frame
    looks: list[Look] = []
    waiting: list[tuple[float, Look, bool]] = []
    most = left = frame.params.search.most_tries
    for region, level in frame.places(regions):
        for channel in frame.looked_at:
            look = frame.look(region, level, channel)
            if not tries.worth_while(look):
                continue
            looks.append(look)
            if tries.is_new(look, steep=False):
                if look.promise > _PROMISING and left:
                    left -= 1
                    yield from tries.search(look, steep=False)
                else:
                    waiting.append((look.promise, look, False))
    new = [look for look in looks if tries.is_new(look, steep=True)]
    waiting += [(look.steep_promise, look, True) for look in new]
    waiting = [item for item in waiting if item[0] >= _LEAST_PROMISE]
    for _, look, steep in _in_turns(waiting)[:most]:
        # A look further up may have told all about this one.
        if tries.is_new(look, steep=steep):
            yield from tries.search(look, steep=steep)
    if frame.stretch.veiled:
        yield from tries.periodic(looks)
    yield from tries.cluttered()


def _in_turns(waiting: list[tuple[float, Look, bool]]) -> list[tuple[float, Look, bool]]:
    """Looks at parts of the frame and at all of it in turns, those first that promise most."""

    def weight(item: tuple[float, Look, bool]) -> float:
        edges = len(item[1].steps.xy)
        return -item[0] * edges / (edges + _FEW_EDGES)

    waiting.sort(key=weight)
    parts = [item for item in waiting if item[1].region.mask is not None]
    wholes = [item for item in waiting if item[1].region.mask is None]
    pairs = zip_longest(parts, wholes)
    return [item for pair in pairs for item in pair if item is not None]


class _Tries:
    """Lattices as they are found and compared with the pads, and what came nearest to one."""

    def __init__(self, frame: Search) -> None:
        nothing = StageFailure("edges", Reason.NO_EDGES, "no edges stand out in any channel")
        self.nearest = Miss(nothing, Region(frame.pyramid.box, None, 0), 0)
        self.frame = frame
        self._cluttered: list[tuple[Lattice, Region]] = []
        self._missed: list[Lattice] = []
        self._searched: set[tuple[Look, bool]] = set()

    def worth_while(self, look: Look) -> bool:
        """True where a look has edges enough to be searched."""
        failure = _too_few(self.frame, look)
        if failure is not None:
            self._failed(look, failure)
        return failure is None

    def is_new(self, look: Look, *, steep: bool) -> bool:
        """True where a look was not searched yet; what a pattern leaves over is not a steep one."""
        return (look, steep) not in self._searched and not (steep and look.is_rest)

    def search(self, look: Look, *, steep: bool) -> Iterator[Sighting]:
        """Find a look's lattice and compare it; one of much clutter waits."""
        self._searched.add((look, steep))
        rest = self.frame.look(look.region, look.level, look.channel)
        if rest is not look:
            # Since the look was taken, a pattern was found in it that is no pad's.
            if steep or not self.worth_while(rest) or rest.promise < _LEAST_PROMISE:
                return
            look = rest
        lattice = find(self.frame, look, steep=steep)
        if not isinstance(lattice, StageFailure) and lattice.is_beyond_doubt:
            self._searched.add((look, True))
        if isinstance(lattice, StageFailure):
            self._failed(look, lattice)
        elif lattice.inlier_share < _CLEAR_SHARE:
            self._cluttered.append((lattice, look.region))
        else:
            yield from self._compare(lattice, look.region)

    def periodic(self, looks: list[Look]) -> Iterator[Sighting]:
        """Compare lattices whose axes are those of the clearest spacing, in looks at all."""
        wholes = [look for look in looks if look.region.mask is None][:_MOST_PERIODIC]
        run = self.frame.recorder.run
        for look in wholes:
            found = run("lines", look.channel, find_periodic_axes, look.edges)
            lattice = _lattice_of(self.frame, look.edges, look.channel, *found)
            if lattice is not None and lattice.inlier_share > self.frame.params.search.least_order:
                yield from self._compare(lattice, look.region)

    def cluttered(self) -> Iterator[Sighting]:
        """Compare the lattices that waited, those with most of their edges on lines first."""
        self._cluttered.sort(key=lambda item: -item[0].inlier_share)
        for _ in range(min(len(self._cluttered), self.frame.params.search.most_unsure)):
            yield from self._compare(*self._cluttered.pop(0))

    def _compare(self, lattice: Lattice, region: Region) -> Iterator[Sighting]:
        """Compare a lattice, unless its cells were compared in vain before."""
        if any(missed.holds(lattice) for missed in self._missed):
            return
        placed = place(self.frame, lattice, region)
        if isinstance(placed, Sighting):
            yield placed
        else:
            self._missed.append(lattice)
            self.nearest = _nearer(self.nearest, placed)

    def _failed(self, look: Look, failure: StageFailure) -> None:
        self.nearest = _nearer(self.nearest, Miss(failure, look.region, look.level))


def _nearer(a: Miss, b: Miss) -> Miss:
    """The failure of the later stage; of two, the better match, then the one of more cells."""
    return max(a, b, key=lambda miss: (miss.failure.progress, miss.match, miss.cells))


# Lattices of a smaller share of inliers are tried only when a round has found no better one; 0.7
# and 0.95 find the same stills of the score.
_CLEAR_SHARE = 0.85
# Looks of more promise are searched at once; of less than the least, not at all: ground of no
# order promises some 0.1 or less.
_PROMISING, _LEAST_PROMISE = 0.35, 0.15
# So many looks at all of a veiled frame, coarse ones first, are searched for even spacing.
_MOST_PERIODIC = 4
# What so few edges promise counts half.
_FEW_EDGES = 300
# Axes that edges agree with so little are not worth a look; 0.06 and 0.24 find the same stills.
_LEAST_COHERENCE = 0.12
# Cells of one layer that agree beyond chance, though by no more than this kappa, lead to a pose
# that other layers' cells may bear out; none rests on them.
_LEAST_KAPPA = 0.25
# These two pick a sentence. Cells of such a kappa, but too few to be sure, are a matter of number.
_ALIKE = 0.8
# More cells than these do not agree by the number that is missing.
_FEW_CELLS = 100


def find(frame: Search, look: Look, *, steep: bool) -> Lattice | StageFailure:
    """Look for a lattice in one channel of one region at one scale."""
    return _too_few(frame, look) or _lattice(frame, look.edges, look.channel, steep=steep)


def _too_few(frame: Search, look: Look) -> StageFailure | None:
    count = len(look.steps.xy)
    if count >= frame.params.search.least_edges:
        return None
    return StageFailure("edges", Reason.NO_EDGES, f"only {count} edge points in {look.channel}")


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
        lattice = _lattice_of(frame, edges, channel, score, axes)
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


def _lattice_of(
    frame: Search, edges: EdgeSet, channel: Channel, score: float, axes: Array
) -> Lattice | None:
    families = frame.recorder.run("lines", channel, find_lines, edges, score, axes)
    if families is None:
        return None
    return frame.recorder.run("grid", channel, find_lattice, families)


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
    bound, foreign = frame.params.log10_false_alarm, False
    for channel in frame.channels:
        seen = frame.pyramid, frame.camera
        cells = frame.recorder.run("decode", channel, read_lattice, *seen, lattice, channel)
        if cells is None:
            continue
        sure: list[Sighting] = []
        agrees = False
        for known, index in frame.at(channel):
            placement = frame.recorder.run("decode", channel, index.locate, cells, frame.attempts)
            if placement is None:
                continue
            if placement.evidence.suffices(bound, least_kappa=_LEAST_KAPPA):
                sure.append(Sighting(known, lattice, placement, region))
            elif best is None or placement.evidence.kappa > best.evidence.kappa:
                best = placement
            agrees = agrees or not is_foreign(lattice, placement, known.pad.levels)
        if sure:
            return min(sure, key=lambda item: item.placement.evidence.log10_false_alarm)
        foreign = foreign or not agrees
    if foreign and best is not None:
        frame.foreign.append(lattice)
    level = lattice.families.edges.plane.level
    if best is None:
        failure = StageFailure("decode", Reason.TOO_FEW_CELLS, "no cell of the grid lies in view")
        return Miss(failure, region, level)
    evidence = best.evidence
    failure = StageFailure(
        "decode",
        Reason.TOO_FEW_CELLS if evidence.kappa > _ALIKE else Reason.UNKNOWN_CODE,
        f"read {evidence.read} cells; at the best place of {_named(frame)} {evidence.wrong} differ "
        f"({evidence.compared_with(frame.params.log10_false_alarm)})",
    )
    return Miss(failure, region, level, evidence.read, -evidence.log10_false_alarm)


def _named(frame: Search) -> str:
    return "this pad" if len(frame.known) == 1 else f"these {len(frame.known)} pads"


def read_lattice(
    pyramid: Pyramid, camera: Camera, lattice: Lattice, channel: Channel
) -> CellGrid | None:
    """The cells of a lattice as one channel shows them, those at its rim too."""

    def to_pixels(coordinates: Array) -> Array:
        return camera.denormalize(lattice.to_rays(coordinates))

    # Beyond the last line in view lie cells that are cut by the frame's edge.
    columns = (lattice.columns[0] - 1, lattice.columns[1] + 1)
    rows = (lattice.rows[0] - 1, lattice.rows[1] + 1)
    return read_cells(pyramid, channel, to_pixels, columns, rows)
