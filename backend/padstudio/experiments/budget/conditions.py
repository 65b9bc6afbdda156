"""The physical quantities that a budget rests on: their sizes, units, limits and reasons."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Literal

from padstudio.errors import SpecError, shown
from padstudio.geometry.camera import Camera

SourceName = Literal[
    "pixels",
    "blur",
    "rolling_shutter",
    "print_scale",
    "flatness",
    "calibration",
    "compression",
]
Kind = Literal["random", "systematic"]


@dataclass(frozen=True)
class Source:
    """A source of error.

    Attributes
    ----------
    title : str
    kind : {"random", "systematic"}
        A systematic one is the same in all frames of a landing, so that their mean keeps it.
    """

    title: str
    kind: Kind


SOURCES: dict[SourceName, Source] = {
    "pixels": Source("Pixels and noise", "random"),
    "blur": Source("Exposure blur", "random"),
    "rolling_shutter": Source("Rolling shutter", "random"),
    "print_scale": Source("Print scale", "systematic"),
    "flatness": Source("Paper flatness", "systematic"),
    "calibration": Source("Calibration", "systematic"),
    "compression": Source("Stream compression", "random"),
}


@dataclass(frozen=True)
class Quantity:
    """What may be set of a source.

    Attributes
    ----------
    default : float
        Where neither the camera nor its file says otherwise.
    unit : str
    low, high : float
        The range that is taken.
    meaning : str
        What it is; one line for people.
    reason : str
        Why its default is what it is.
    """

    default: float
    unit: str
    low: float
    high: float
    meaning: str
    reason: str


def _quantity(
    default: float, unit: str, span: tuple[float, float], meaning: str, reason: str
) -> float:
    told = Quantity(default, unit, *span, meaning, reason)
    value: float = field(default=default, metadata={"quantity": told})
    return value


_FOUND = "found for recorded flights (docs/simulation.md)"
_PROPELLERS = "propellers of small drones turn at 50 … 150 Hz"
_FITTED = "fitted to pictures of a drone's camera (docs/simulation.md)"


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """Sizes of all sources. Those of systematic sources are one standard deviation.

    Raises
    ------
    SpecError
        If a size is out of its range.
    """

    tilt_deg: float = _quantity(
        5.0, "°", (0, 70), "lean of the camera's axis", "a multicopter that holds its place in wind"
    )
    full_well_e: float = _quantity(
        8000.0, "electrons", (50, 1e6), "electrons at which a pixel saturates", _FITTED
    )
    read_noise_e: float = _quantity(4.0, "electrons", (0, 1e4), "noise of reading a pixel", _FITTED)
    drift_mm_s: float = _quantity(
        300.0, "mm/s", (0, 1e4), "speed across, in any direction", "a landing's last metres in wind"
    )
    descent_mm_s: float = _quantity(
        500.0, "mm/s", (0, 1e4), "speed down", "ArduPilot's LAND_SPEED; PX4's MPC_LAND_SPEED is 700"
    )
    turn_deg_s: float = _quantity(
        9.0,
        "°/s",
        (0, 1000),
        "turn rate, about any axis",
        "root mean square of the simulator's landing",
    )
    vibration_hz: float = _quantity(90.0, "Hz", (0.1, 2000), "frequency of shaking", _PROPELLERS)
    vibration_deg: float = _quantity(
        0.02,
        "°",
        (0, 5),
        "amplitude of shaking about each axis",
        "a third of a pixel at a focal length of 940 px: a soft mount, no jello to be seen",
    )
    exposure_ms: float = _quantity(4.0, "ms", (0, 1000), "time each row gathers light", _FOUND)
    readout_ms: float = _quantity(
        12.0, "ms", (0, 1000), "first row to last; 0 is global", f"the camera file's, else {_FOUND}"
    )
    scale_percent: float = _quantity(
        0.2,
        "%",
        (0, 20),
        "error of the print's size",
        "0.4 mm in 200 mm: what measuring a print turns up (docs/printing.md)",
    )
    waves_mm: float = _quantity(
        1.0, "mm", (0, 100), "amplitude of the paper's waves", "paper taped to a board outdoors"
    )
    waves_length_mm: float = _quantity(
        300.0, "mm", (10, 1e5), "length of the paper's waves", "damp paper of large sheets"
    )
    focal_percent: float = _quantity(
        0.1, "%", (0, 20), "error of the focal length", "a good calibration; 2 of a data sheet"
    )
    principal_px: float = _quantity(
        1.0,
        "px",
        (0, 500),
        "error of the principal point in x and in y",
        "a good calibration; 1 % of the width of a data sheet",
    )
    distortion_px: float = _quantity(
        0.3,
        "px",
        (0, 100),
        "error of the distortion, at the picture's corner",
        "stated of a good calibration (docs/calibration.md); 0.5 % of the width of a data sheet",
    )
    mbit_s: float = _quantity(
        3.0,
        "Mbit/s",
        (0, 1000),
        "bit rate of the stream; 0 is a picture without compression",
        "0.1 bit a pixel and frame: 6 Mbit/s for 1920 × 1080 at 30 frames a second",
    )
    fps: float = _quantity(30.0, "1/s", (1, 1000), "frames a second of the stream", "usual")

    def __post_init__(self) -> None:
        for name, quantity in QUANTITIES.items():
            value = getattr(self, name)
            if not (math.isfinite(value) and quantity.low <= value <= quantity.high):
                raise SpecError(
                    f"{name} is {value:g} {quantity.unit}; it must lie within "
                    f"{quantity.low:g} … {quantity.high:g}",
                    detail={"name": name, "value": shown(value)},
                )

    @classmethod
    def of(cls, camera: Camera, given: Mapping[str, float] | None = None) -> Conditions:
        """The sizes for a camera: what is given, else what its file says, else the defaults.

        Raises
        ------
        SpecError
            If a name is not known, or a size out of its range.
        """
        given = given or {}
        for name in given:
            if name not in QUANTITIES:
                raise SpecError(f"no quantity {shown(name)}; choose of {', '.join(QUANTITIES)}")
        fps = given.get("fps", cls.fps)
        own: dict[str, Any] = {
            "mbit_s": round(_BITS_A_PIXEL * camera.width * camera.height * fps / 1e6, 2)
        }
        if camera.readout_ms is not None:
            own["readout_ms"] = camera.readout_ms
        if camera.nominal:
            own["focal_percent"] = 2.0
            own["principal_px"] = round(0.01 * camera.width, 1)
            own["distortion_px"] = round(0.005 * camera.width, 1)
        return cls(**own | {name: float(value) for name, value in given.items()})


_BITS_A_PIXEL = 0.1
#: Every quantity, in the order in which they are listed.
QUANTITIES: dict[str, Quantity] = {
    each.name: each.metadata["quantity"] for each in fields(Conditions)
}


def parsed(words: Sequence[str]) -> dict[str, float]:
    """Sizes as words that a person types: ``exposure_ms=2``.

    Raises
    ------
    SpecError
        If a word is ill-formed, not known, or there twice.
    """
    given: dict[str, float] = {}
    for word in words:
        name, equals, value = word.strip().partition("=")
        if name not in QUANTITIES:
            raise SpecError(f"no quantity {shown(name)}; choose of {', '.join(QUANTITIES)}")
        if name in given:
            raise SpecError(f"{name} is given twice")
        try:
            given[name] = float(value if equals else "")
        except ValueError:
            raise SpecError(f"{shown(word)} is ill-formed; give {name}=NUMBER") from None
    return given
