"""What a budget is asked for, and the cases that are simulated for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from padstudio.errors import LimitError, SpecError, shown
from padstudio.experiments.budget.conditions import SOURCES, Conditions, SourceName
from padstudio.geometry.camera import Camera
from padstudio.geometry.presets import load_camera
from padstudio.pad.spec import Pad
from padstudio.simulate.trajectories import MAX_HEIGHT_MM
from padstudio.simulate.video_writer import Codec

#: Fewer frames say nothing of how much they scatter; more take longer than anybody waits.
FEWEST_FRAMES, MOST_FRAMES = 4, 64
#: A multiple of the design of signs, so that systematic sources keep apart.
USUAL_FRAMES = 8
#: The simulator's own limit is higher; here a frame is rendered some fifteen times.
MOST_PIXELS = 13_000_000
_OPTIONS = ("codec", "frames", "seed", "fits_bends", "is_checked")


@dataclass(frozen=True, kw_only=True)
class BudgetOrder:
    """A budget that is asked for.

    Attributes
    ----------
    pad : Pad
        With the true size of its print.
    camera : Camera
        The true one.
    height_mm : float
        Of the camera's centre over the pad.
    conditions : Conditions
    codec : {"h264", "h265"}
    frames : int
        In each case; `FEWEST_FRAMES` … `MOST_FRAMES`.
    seed : int
    fits_bends : bool
        The detector asks whether the paper is bent, as it does in stills and not in videos.
    is_checked : bool
        All sources are simulated once more after the best change.

    Raises
    ------
    SpecError, LimitError
        If a figure is out of range.
    """

    pad: Pad
    camera: Camera
    height_mm: float
    conditions: Conditions = field(default_factory=Conditions)
    codec: Codec = "h264"
    frames: int = USUAL_FRAMES
    seed: int = 1
    fits_bends: bool = False
    is_checked: bool = False

    def __post_init__(self) -> None:
        if not 10 <= self.height_mm <= MAX_HEIGHT_MM:
            raise SpecError(
                f"height_mm is {self.height_mm:g}; a height lies within 10 … {MAX_HEIGHT_MM:g} mm"
            )
        if self.codec not in ("h264", "h265"):
            raise SpecError(f"no codec {shown(self.codec)}; use h264 or h265")
        if not FEWEST_FRAMES <= self.frames <= MOST_FRAMES:
            raise SpecError(
                f"{self.frames} frames are asked for; give {FEWEST_FRAMES} … {MOST_FRAMES}"
            )
        if not 0 <= self.seed < 2**63:
            raise SpecError(f"seed is {shown(self.seed)}; give 0 … 2^63 - 1")
        if self.camera.width * self.camera.height > MOST_PIXELS:
            raise LimitError(
                f"the camera has {self.camera.width} x {self.camera.height} pixels; a budget takes "
                f"{MOST_PIXELS / 1e6:g} million at most, scale its calibration down",
                code="frame_too_large",
            )

    @classmethod
    def from_plain(cls, order: Mapping[str, Any]) -> BudgetOrder:
        """The order in plain values.

        Parameters
        ----------
        order : mapping
            ``pad`` and ``camera`` are contents of their files or, of the camera, a preset's id;
            ``conditions`` are those of `Conditions` that are not the defaults; the rest are named
            as here.

        Raises
        ------
        SpecError, LimitError, PadFormatError, CameraFormatError
        """
        camera = order["camera"]
        loaded = load_camera(camera) if "\n" not in camera else Camera.loads(camera)
        rest = {name: order[name] for name in _OPTIONS if name in order}
        return cls(
            pad=Pad.loads(order["pad"]),
            camera=loaded,
            height_mm=order["height_mm"],
            conditions=Conditions.of(loaded, order.get("conditions")),
            **rest,
        )


@dataclass(frozen=True, kw_only=True)
class Case:
    """What is simulated: which sources are on, and how large they are.

    Attributes
    ----------
    on : frozenset of SourceName
        Pixels and noise are always on.
    conditions : Conditions
    sharper : float
        So many times the pixels along each side.
    larger : float
        So many times the side of each cell, of as many cells.
    is_told_global : bool
        The detector knows that the shutter does not roll.
    """

    on: frozenset[SourceName]
    conditions: Conditions
    sharper: float = 1.0
    larger: float = 1.0
    is_told_global: bool = False


def floor_case(conditions: Conditions) -> Case:
    """Pixels and noise alone."""
    return Case(on=frozenset(), conditions=conditions)


def source_case(conditions: Conditions, source: SourceName) -> Case:
    """One source on top of pixels and noise."""
    return Case(on=frozenset({source}) - {"pixels"}, conditions=conditions)


def whole_case(conditions: Conditions) -> Case:
    """All sources together."""
    return Case(on=frozenset(SOURCES), conditions=conditions)
