"""Why a frame has no pose: every suspicion that holds, the likeliest first, with its figures.

The stage that failed knows only what it did not find. Here each cause is measured by what it alone
does to a picture: light by grey values; a pad that is small, cut off, covered or absent by where
its colours are; blur by the widths of the steepest steps; another pad by cells that lie on a clear
lattice and fit nowhere.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

from padstudio.vision.reasons.clues import CLEAR_ORDER, Clues, Reading
from padstudio.vision.stage.trace import Finding, Reason, StageFailure

# Grey values: brightest below which a frame is too dark, and smoothed structure below which there
# is nothing but noise.
_DARK_TOP, _NO_RELIEF = 24.0, 0.5
# Share of burnt-out pixels that a pad alone does not explain; and from which nothing else is asked.
_BURNT, _ALL_BURNT = 0.2, 0.5
#: Mean difference of channels that compression leaves in a grey picture.
GREY = 1.0
# Coarse cells narrower than this can no longer be read, pixels.
_LEAST_CELL_PX = 2.0
# A pad of which so little is left at the frame's rim is cut off.
_CUT_SHARE, _WHOLE = 0.12, 0.5
# So few cells across, where the pad takes so much of the frame, are too few.
_FEW_ACROSS, _CLOSE_SHARE = 7.0, 0.25
# A pad's colours fill less of their outline than this where something hides it.
_HIDDEN_FILL = 0.45
# Cells that agree beyond chance, but so little, are those of a pad that is partly hidden.
_LOG10_THERE, _HALF = -6.0, 0.6
# Steps of a sharp picture take up to 6 pixels here; flattened in one direction by this ratio.
_SOFT_PX, _ONE_WAY = 8.0, 1.5
#: Correlation of two channels that are coded apart, from which they are taken to be mixed.
MOST_ALIKE = 0.8
# A pad of less of the frame does not tell it.
_ENOUGH = 0.02
# So many cells of a clear lattice tell another pad.
_TELLING_CELLS = 40

Findings = Iterator[Finding]


def in_full(clues: Clues, failure: StageFailure) -> StageFailure:
    """A failure with all that a second look finds.

    Parameters
    ----------
    clues : Clues
    failure : StageFailure
        What the stage that came nearest to an answer says; or a misreading, which is certain.

    Returns
    -------
    StageFailure
        Of the same stage, and unchanged where nothing is found.
    """
    found = list(_all(clues))
    if failure.reason in CERTAIN:
        kept = tuple(item for item in found if item.reason in _OF_LIGHT)
        return replace(failure, also=kept)
    if not found:
        return failure
    first, *others = found
    return replace(
        failure,
        reason=first.reason,
        detail=f"{first.detail}; {failure.detail}",
        advice=first.advice,
        also=tuple(others),
    )


def _all(clues: Clues) -> Findings:
    light = list(_light(clues))
    yield from light
    if any(item.reason in _BLINDING for item in light) or clues.light.bright > _ALL_BURNT:
        return
    count = len(light)
    for check in _CHECKS:
        for finding in check(clues):
            count += 1
            yield finding
            if finding.reason in _ENDING:
                return
    if not count:
        yield from _last(clues)


def _light(clues: Clues) -> Findings:
    light, top = clues.light, clues.top
    if top < _DARK_TOP and clues.relief < _NO_RELIEF:
        yield Finding(
            Reason.BLACK_FRAME,
            f"black: the brightest parts reach {top:.0f} of 255, and all there is is noise "
            f"({clues.relief:.1f} grey values once smoothed)",
            "take the cap off the lens, and check that the camera gives a picture",
        )
    elif top < _DARK_TOP:
        yield Finding(
            Reason.UNDEREXPOSED,
            f"underexposed: the brightest parts reach {top:.0f} of 255",
            "raise exposure or gain, or light the pad",
        )
    if light.bright > _BURNT:
        yield Finding(
            Reason.OVEREXPOSED,
            f"overexposed: {100 * light.bright:.0f} % of the picture is burnt out",
            "lower the exposure by one or two stops, or shade the pad from glare",
        )
    elif clues.color < GREY and top >= _DARK_TOP:
        yield monochrome(clues.color)


def crosstalk(likeness: float) -> Finding:
    """Layers that are seen in each other's channel."""
    return Finding(
        Reason.CROSSTALK,
        f"the layers' channels are {100 * likeness:.0f} % alike",
        "un-mix by a photo of the test strip, or reprint with purer inks",
    )


def monochrome(color: float) -> Finding:
    """A picture without colours."""
    return Finding(
        Reason.MONOCHROME,
        f"no colours: the channels differ by {color:.1f} of 255, so that all layers are seen at "
        "once",
        "use a colour camera, or a pad of one layer; check that the picture was not made grey",
    )


def _size(clues: Clues) -> Findings:
    """The pad too small, cut off, or not there at all."""
    parts, frame = clues.parts, clues.frame
    if parts is None or not clues.pad_is_seen:
        if clues.color >= GREY:
            yield _no_pad(clues)
        return
    coarse = max(layer.cell_mm for layer in frame.pad.layers)
    cell_px = parts.longest_px * coarse / math.hypot(*frame.pad.size_mm)
    if parts.fill < _WHOLE:
        return
    if parts.sides and parts.share < _CUT_SHARE:
        yield Finding(
            Reason.CUT_OFF,
            f"the pad is cut off: its colours take {100 * parts.share:.1f} % of the picture, at "
            "its rim",
            "move so that more of the pad is in the picture, or fly higher",
        )
    elif not parts.sides and cell_px < _LEAST_CELL_PX:
        height_m = frame.camera.focal_px * coarse / _LEAST_CELL_PX / 1000
        yield Finding(
            Reason.CELLS_TOO_SMALL,
            f"too far: the largest cells are about {cell_px:.1f} px wide here, "
            f"{_LEAST_CELL_PX:.0f} are needed",
            f"fly below about {height_m:.1f} m with this camera, or print larger cells",
        )


def _no_pad(clues: Clues) -> Finding:
    depth = 0.0 if clues.parts is None else clues.parts.depth
    return Finding(
        Reason.NO_PAD,
        f"no part of the picture has the pad's colours (they differ from the rest by "
        f"{100 * max(depth, 0.0):.0f} % of the light; a pad by 5 % or more)",
        "check that the pad is in view, and printed in the colours of its layers",
    )


def _near(clues: Clues) -> Findings:
    """Few cells across what is seen of the pad, which takes much of the frame.

    Borders of n x n cells of two levels, half of which differ, are n times as long as a side.
    """
    parts, pyramid = clues.parts, clues.frame.pyramid
    lengths = [item.length_px for item in clues.readings if item.order >= CLEAR_ORDER]
    if not lengths or parts is None or parts.share < _CLOSE_SHARE or not clues.pad_is_seen:
        return
    across = max(lengths) / math.sqrt(pyramid.width * pyramid.height * parts.share)
    if across < _FEW_ACROSS:
        yield Finding(
            Reason.CELLS_TOO_LARGE,
            f"too near: the pad takes {100 * parts.share:.0f} % of the picture or more, and about "
            f"{across:.0f} cells across are in view",
            "fly higher, or print a pad with finer cells",
        )


def _covered(clues: Clues) -> Findings:
    parts = clues.parts
    if parts is None or not clues.pad_is_seen:
        return
    there = _there(clues)
    if parts.fill < _HIDDEN_FILL and parts.depth > 0:
        detail = (
            f"covered: the pad's colours fill {100 * parts.fill:.0f} % of the outline that their "
            f"{parts.count} parts span"
        )
    elif there is not None and there.kappa < _HALF and clues.sharpness.most_px < _SOFT_PX:
        detail = (
            f"covered in part: {there.cells} cells agree with this pad by {100 * there.kappa:.0f} "
            f"% (chance 10^{there.log10_false_alarm:.0f}), and the others do not"
        )
    else:
        return
    yield Finding(Reason.COVERED, detail, "clear the pad of what lies on it")


def _there(clues: Clues) -> Reading | None:
    """Cells that agree with the pad beyond chance, as far as they go."""
    sure = [item for item in clues.readings if item.log10_false_alarm <= _LOG10_THERE]
    return min(sure, key=lambda item: item.log10_false_alarm, default=None)


def _defocus(clues: Clues) -> Findings:
    sharpness = clues.sharpness
    if sharpness.least_px >= _SOFT_PX and not _one_way(clues):
        yield Finding(
            Reason.DEFOCUS,
            f"out of focus: no step in the picture is narrower than {sharpness.least_px:.0f} px, "
            "in any direction",
            "focus at the height of flight, clean the lens, or close its aperture",
        )


def _motion(clues: Clues) -> Findings:
    sharpness = clues.sharpness
    if sharpness.most_px >= _SOFT_PX and _one_way(clues):
        yield Finding(
            Reason.MOTION_BLUR,
            f"motion blur along {sharpness.direction_deg}° in the picture: steps are "
            f"{sharpness.most_px:.0f} px wide there, {sharpness.least_px:.0f} px across",
            "shorten the exposure, add light, or fly slower",
        )


def _one_way(clues: Clues) -> bool:
    """True where steps of one direction are much flatter than those of another."""
    return clues.sharpness.most_px > _ONE_WAY * clues.sharpness.least_px


def _last(clues: Clues) -> Findings:
    """Where nothing else is wrong: channels alike, or cells that fit no place."""
    parts = clues.parts
    if parts is not None and parts.share > _ENOUGH and clues.likeness > MOST_ALIKE:
        yield crosstalk(clues.likeness)
    clear = [item for item in clues.readings if item.order >= CLEAR_ORDER]
    most = max(clear, key=lambda item: item.cells, default=None)
    if most is not None and most.cells >= _TELLING_CELLS and _there(clues) is None:
        yield Finding(
            Reason.ANOTHER_PAD,
            f"another pad: {most.cells} cells lie on a clear lattice, and at the best place of "
            f"this pad {100 * most.kappa:.0f} % agree beyond chance",
            "choose the file that this pad was printed from",
        )


#: Reasons that a misreading proves: its cells agree beyond chance once they are read another way.
CERTAIN = frozenset({Reason.CHANNELS_SWAPPED, Reason.MIRRORED, Reason.INVERTED})
_OF_LIGHT = frozenset(
    {Reason.BLACK_FRAME, Reason.UNDEREXPOSED, Reason.OVEREXPOSED, Reason.MONOCHROME}
)
# After these nothing else can be measured, or need be.
_BLINDING = frozenset({Reason.BLACK_FRAME, Reason.UNDEREXPOSED})
_ENDING = frozenset({Reason.NO_PAD, Reason.CELLS_TOO_SMALL, Reason.CELLS_TOO_LARGE})
_CHECKS: tuple[Callable[[Clues], Findings], ...] = (_size, _defocus, _near, _motion, _covered)
