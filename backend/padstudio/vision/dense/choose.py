"""Stage `choose`: which layer the result rests on."""

from __future__ import annotations

from dataclasses import dataclass

from padstudio.pad.spec import Layer
from padstudio.vision.pose.results import LayerRead
from padstudio.vision.stage.trace import Reason, StageFailure


@dataclass(frozen=True, eq=False)
class Choice:
    """The layer that the result rests on.

    Attributes
    ----------
    read : LayerRead
        The chosen layer's cells and their evidence.
    reads : tuple of LayerRead
        All layers that lie in view.
    """

    read: LayerRead
    reads: tuple[LayerRead, ...]


def choose(
    reads: list[LayerRead], measured: Layer, log10_false_alarm: float
) -> Choice | StageFailure:
    """The measured layer where its cells suffice, else the one with the best evidence.

    Parameters
    ----------
    reads : list of LayerRead
        Layers read with the final pose.
    measured : Layer
        The finest layer whose borders the pose rests on.
    log10_false_alarm : float
        The bound that evidence must keep.
    """
    if not reads:
        return StageFailure("choose", Reason.TOO_FEW_CELLS, "no cell of the pad lies in view")
    good = [read for read in reads if read.evidence.suffices(log10_false_alarm)]
    if not good:
        best = min(reads, key=lambda read: read.evidence.log10_false_alarm)
        return StageFailure(
            "choose",
            Reason.UNKNOWN_CODE,
            f"with the refined pose {best.evidence.wrong} of {best.evidence.read} "
            f"{best.layer.channel} cells differ from the pad (chance of such a match "
            f"10^{best.evidence.log10_false_alarm:.1f}, 10^{log10_false_alarm:.0f} is needed)",
        )
    for read in good:
        if read.layer is measured:
            return Choice(read, tuple(reads))
    return Choice(min(good, key=lambda read: read.evidence.log10_false_alarm), tuple(reads))
