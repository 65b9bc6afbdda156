"""For a trace: every channel through every stage, at the scale of its own layer.

The search ends at the first channel that answers. Whoever debugs wants to see the others as well,
so a trace runs the same stages once more for each channel; the result does not depend on it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from padstudio.pad.coverage.spans import METHOD_LIMITS
from padstudio.pad.spec import Channel
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.frame.block_mean import block_mean, clean
from padstudio.vision.frame.prepare import take_channel
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import Region
from padstudio.vision.search.known_pads import KnownPad
from padstudio.vision.search.looks import Search
from padstudio.vision.search.search import Miss, find, place
from padstudio.vision.stage.trace import Reason, Recorder, StageFailure

# A cell is this wide where its layer is shown, pixels of the plane.
_SHOWN_CELL_PX = 9.0
_BLOCKS = 12


def explain(
    frame: Search,
    pad: KnownPad,
    region: Region,
    reads: Sequence[LayerRead],
    level: int | None = None,
) -> None:
    """Run each layer's channel through the stages, where a trace is kept.

    Parameters
    ----------
    frame : Search
    pad : KnownPad
        The pad whose layers are shown.
    region : Region
        Where to look.
    reads : sequence of LayerRead
        Layers read with the final pose; empty where there is none.
    level : int or None
        Scale for channels of which no cells were read; None for a middling one.
    """
    if not frame.recorder.keep:
        return
    recorder = Recorder(keep=True, memo=frame.recorder.memo)
    local = Search(frame.pyramid, frame.camera, frame.stretch, (pad,), frame.params, recorder)
    widths = {read.layer.channel: read.cells.cell_px for read in reads}
    agreed = {read.layer.channel for read in reads if read.evidence.suffices(0.0)}
    expected = _too_far(pad, reads, agreed)
    only = None if recorder.memo is None else recorder.memo.channel
    for channel in [only] if only in local.channels else local.channels:
        shown = _level(frame.pyramid, widths.get(channel), level)
        seen = frame.pyramid, frame.stretch, channel, shown, region.box
        plane = recorder.make("channel", take_channel, *seen)
        binary = recorder.run("block_mean", channel, block_mean, plane, _BLOCKS)
        recorder.run("clean", channel, clean, binary, 2)
        _run(local, region, shown, channel, known=channel in agreed | expected.keys())
        if channel in expected:
            recorder.note("lines", channel, expected[channel])
    for read in reads:
        recorder.note("decode", read.layer.channel, read)
    frame.recorder.append(recorder)


def _run(frame: Search, region: Region, level: int, channel: Channel, *, known: bool) -> None:
    """The search in one channel; where its cells are known anyway, it need not find them."""
    found = find(frame, frame.look(region, level, channel), steep=False)
    if isinstance(found, StageFailure):
        if not known:
            frame.recorder.note(found.stage, channel, found)
        return
    placed = place(frame, found, region)
    if isinstance(placed, Miss) and not known:
        frame.recorder.note("decode", channel, placed.failure)


def _too_far(
    pad: KnownPad, reads: Sequence[LayerRead], agreed: set[Channel]
) -> dict[Channel, StageFailure]:
    """Layers whose cells are too small to be read from where the pose says the camera is."""
    known = next((read for read in reads if read.layer.channel in agreed), None)
    if known is None:
        return {}
    least, found = METHOD_LIMITS["dense"].cell_px, {}
    for index in pad.indices:
        channel = index.layer.channel
        cell_px = known.cells.cell_px * index.layer.cell_mm / known.layer.cell_mm
        if channel not in agreed and cell_px < least:
            detail = (
                f"its cells are {cell_px:.1f} px wide here, {least:g} are needed: expected from "
                f"this height, as the pose rests on the {known.layer.channel} layer"
            )
            found[channel] = StageFailure("lines", Reason.CELLS_TOO_SMALL, detail)
    return found


def _level(pyramid: Pyramid, cell_px: float | None, level: int | None) -> int:
    if cell_px is not None:
        return max(0, math.floor(math.log2(max(cell_px / _SHOWN_CELL_PX, 1.0))))
    if level is not None:
        return level
    return max(0, round(math.log2(max(pyramid.width / 700, 1.0))))
