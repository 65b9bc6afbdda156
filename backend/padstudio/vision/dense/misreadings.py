"""What a frame shows that is not the pad as it should be: channels exchanged, mirrored, inverted.

Cells of such a picture agree with no place of the pad, and with one at once when they are read the
other way. It is looked for only where a frame gave no pose.
"""

from __future__ import annotations

from dataclasses import replace

from padstudio.pad.spec import Channel
from padstudio.vision.cells.sampling import CellGrid
from padstudio.vision.dense.scales import swapped
from padstudio.vision.search.looks import Search
from padstudio.vision.search.search import read_lattice
from padstudio.vision.stage.trace import Reason, StageFailure

# The lattices with the most of their edges on lines are read again; others are seldom the pad's.
_MOST_LATTICES = 2


def find_misreading(search: Search) -> StageFailure | None:
    """The way in which the frame shows the pad wrongly, where one explains its cells.

    Parameters
    ----------
    search : Search
        Of a frame without a pose, with the lattices that were tried.
    """
    best = sorted(search.lattices, key=lambda lattice: -lattice.inlier_share)[:_MOST_LATTICES]
    for lattice in best:
        for channel in search.channels:
            cells = read_lattice(search.pyramid, search.camera, lattice, channel)
            failure = None if cells is None else _misread(search, channel, cells)
            if failure is not None:
                return failure
    return None


def _misread(search: Search, channel: Channel, cells: CellGrid) -> StageFailure | None:
    others = [other for other in search.channels if other != channel]
    if any(_agree(search, other, cells) for other in others):
        return swapped("decode")
    if _agree(search, channel, _mirrored(cells)):
        return StageFailure(
            "decode",
            Reason.MIRRORED,
            f"the {channel} cells are those of the pad's mirror image",
            "flip the picture back, or print the pad again without mirroring",
        )
    if _agree(search, channel, replace(cells, relative=-cells.relative)):
        return StageFailure(
            "decode",
            Reason.INVERTED,
            f"the {channel} cells are dark where the pad is full and full where it is dark",
            "print the pad again without inverting it, or undo the picture's inversion",
        )
    return None


def _agree(search: Search, channel: Channel, cells: CellGrid) -> bool:
    """True where cells are those of a layer's, however many lattices and ways were tried."""
    placements = [index.locate(cells, 3 * search.attempts) for _, index in search.at(channel)]
    bound = search.params.log10_false_alarm
    return any(found is not None and found.evidence.suffices(bound) for found in placements)


def _mirrored(cells: CellGrid) -> CellGrid:
    """The cells from the last column to the first."""
    return replace(
        cells,
        values=cells.values[:, ::-1],
        seen=cells.seen[:, ::-1],
        relative=cells.relative[:, ::-1],
        xy=cells.xy[:, ::-1],
    )
