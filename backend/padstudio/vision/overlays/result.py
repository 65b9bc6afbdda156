"""The picture of a frame with all that was found in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from padstudio.arrays import Array, Image
from padstudio.vision.dense.answer import Choice
from padstudio.vision.dense.whole_pad import WholeSign
from padstudio.vision.overlays import baseline
from padstudio.vision.overlays.canvas import MAX_WIDTH, Canvas, fit
from padstudio.vision.refine.results import RefinedPose
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Trace

Posed = TypeVar("Posed", WholeSign, RefinedPose)


def result_picture(trace: Trace, found: Sequence[Detection]) -> Image:
    """The frame with each pad's lattice, decoded cells and axes over it, BGR.

    Where only range and bearing of a pad are known, its centre is marked instead of its axes.

    Parameters
    ----------
    trace : Trace
    found : sequence of Detection
        The trace's, one for each pad that was found.
    """
    posed = trace.get("pose")
    if posed is not None and type(posed.output) in baseline.PAINTERS:
        return baseline.PAINTERS[type(posed.output)](trace, posed.output, None)
    picture = fit(trace.image, MAX_WIDTH)
    canvas = Canvas(picture, trace.image.shape[1] / picture.shape[1])
    for detection in found:
        if detection.pose is not None:
            _draw(canvas, trace, detection)
    return canvas.picture


def _draw(canvas: Canvas, trace: Trace, detection: Detection) -> None:
    sign = _posed(trace, WholeSign, detection)
    if detection.layer == "outline" and sign is not None:
        canvas.cells(sign.read.cells, sign.read.expected)
        canvas.quad(sign.outline.corners_xy)
        sigma_mm, range_mm = detection.range_sigma_mm, detection.range_mm
        if detection.quality == "bearing" and range_mm is not None and sigma_mm is not None:
            canvas.way_to(_crossing(sign.outline.corners_xy), range_mm, sigma_mm)
        return
    choice = _choice(trace, detection)
    if choice is None:
        return
    canvas.grid(choice.read.cells)
    canvas.cells(choice.read.cells, choice.read.expected)
    refined = _posed(trace, RefinedPose, detection)
    if refined is not None:
        canvas.axes(refined)


def _posed(trace: Trace, kind: type[Posed], detection: Detection) -> Posed | None:
    """The last output of a kind that has a detection's pose."""
    assert detection.pose is not None
    for record in reversed(trace.records):
        output = record.output
        if isinstance(output, kind) and np.array_equal(
            output.fit.pose.pose.position_mm, detection.pose.position_mm
        ):
            return output
    return None


def _choice(trace: Trace, detection: Detection) -> Choice | None:
    """The choice that a detection rests on."""
    rests_on = detection.layer, detection.cells_read, detection.log10_false_alarm
    for record in reversed(trace.records):
        output = record.output
        if isinstance(output, Choice):
            evidence = output.evidence
            made = output.read.layer.channel, evidence.read, evidence.log10_false_alarm
            if made == rests_on:
                return output
    return None


def _crossing(corners_xy: Array) -> Array:
    """Where the diagonals of four corners (4, 2) cross: a sign's centre, in any perspective."""
    a, b, c, d = np.column_stack([corners_xy, np.ones(4)])
    x, y, w = np.cross(np.cross(a, c), np.cross(b, d))
    return np.array([x / w, y / w])
