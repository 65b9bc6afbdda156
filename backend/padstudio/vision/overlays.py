"""Turns stage outputs into pictures; the stages themselves never draw."""

from __future__ import annotations

from padstudio.pad.spec import Channel
from padstudio.vision.types import Detection, Image, Trace


def stage_picture(trace: Trace, name: str, channel: Channel | None = None) -> Image | None:
    """A stage's output as a picture.

    Parameters
    ----------
    trace : Trace
    name : str
        One of `padstudio.vision.types.STAGES`.
    channel : {"red", "green", "blue"} or None

    Returns
    -------
    (h, w, 3) uint8 or None
        BGR, of the frame's aspect; None where the stage did not run.
    """
    raise NotImplementedError


def result_picture(trace: Trace, detection: Detection) -> Image:
    """The frame with the lattice, the decoded cells and the pose axes over it, BGR."""
    raise NotImplementedError
