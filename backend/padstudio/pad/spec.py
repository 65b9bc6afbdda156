"""The pad and its layers: the objects that every other part works on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from padstudio import text
from padstudio.arrays import Array
from padstudio.errors import PadFormatError, shown
from padstudio.pad import files
from padstudio.pad.crosstalk import Matrix, check_matrix

Channel = Literal["red", "green", "blue"]
# Whether each layer has a field of its own, or coarse ones begin as the fine one does.
LayerFields = Literal["independent", "paper"]
CHANNELS: tuple[Channel, ...] = get_args(Channel)

# As many as there are base-36 digits.
MAX_LEVELS = 36
# Beyond, windows are so many that no pad needs them.
MAX_WINDOW = 16
# A side of a layer: 16 million cells, a pad file of 16 MB.
MAX_CELLS = 4000
#: Side of a cell: from less than a printer can place to more than any pad needs.
MIN_CELL_MM, MAX_CELL_MM = 0.01, 10_000.0


@dataclass(frozen=True, eq=False)
class Layer:
    """One grid of cells in one colour channel.

    Attributes
    ----------
    channel : {"red", "green", "blue"}
    cell_mm : float
        Side of a cell, mm.
    field : (rows, cols) uint8
        Levels, 0 (dark) … Y−1 (full); row 0, column 0 is the page's top left. Read-only.
    """

    channel: Channel
    cell_mm: float
    field: NDArray[np.uint8]

    def __post_init__(self) -> None:
        if self.channel not in CHANNELS:
            raise PadFormatError(
                f"unknown channel {shown(self.channel)}; use {', '.join(CHANNELS)}"
            )
        if not MIN_CELL_MM <= self.cell_mm <= MAX_CELL_MM:
            raise PadFormatError(
                f"{self.channel} layer: cell_mm is {shown(self.cell_mm)}; give a side of "
                f"{MIN_CELL_MM} … {MAX_CELL_MM:g} mm"
            )
        field = np.array(self.field, dtype=np.uint8, order="C")
        if field.ndim != 2 or not field.size:
            raise PadFormatError(f"{self.channel} layer: the field must have rows and columns")
        if max(field.shape) > MAX_CELLS:
            raise PadFormatError(
                f"{self.channel} layer: {field.shape[0]} x {field.shape[1]} cells; the limit is "
                f"{MAX_CELLS} a side"
            )
        field.setflags(write=False)
        object.__setattr__(self, "field", field)

    @property
    def rows(self) -> int:
        """Number of rows of cells."""
        return int(self.field.shape[0])

    @property
    def cols(self) -> int:
        """Number of columns of cells."""
        return int(self.field.shape[1])

    @property
    def width_mm(self) -> float:
        """Width on paper, mm."""
        return self.cols * self.cell_mm

    @property
    def height_mm(self) -> float:
        """Height on paper, mm."""
        return self.rows * self.cell_mm


@dataclass(frozen=True, eq=False)
class Pad:
    """A whole printed landing sign.

    Attributes
    ----------
    layers : tuple of Layer
        One a channel, sharing the top-left corner.
    window : int
        b: every b × b window of a layer is there once.
    levels : int
        Y: the number of levels of a cell.
    quiet_mm : float
        White margin round the pad, mm.
    name : str
    seed : int or None
        What the field was grown from; None for imported fields.
    method : str or None
        The generator's method.
    unique : {"rotation", "plain"} or None
        The uniqueness that the pad was generated for; None where unknown.
    distance : int or None
        The least Hamming distance of two windows that it was generated for; None where unknown.
    layer_fields : {"independent", "paper"} or None
        How its layers' fields were made to differ; None where unknown, and where there is one.
    visible_lines : bool
        Whether it was generated for a level change across each inner grid line of every window.
    scale : (x, y)
        Measured size of the print over its nominal size; 1.0 until somebody measured.
    crosstalk : 3 rows of 3 numbers, or None
        How printer and camera mix the colours (`padstudio.pad.crosstalk`); frames are un-mixed by
        it. None until somebody photographed the test strip.
    """

    layers: tuple[Layer, ...]
    window: int = 5
    levels: int = 2
    quiet_mm: float = 0.0
    name: str = "pad"
    seed: int | None = None
    method: str | None = None
    unique: Literal["rotation", "plain"] | None = None
    distance: int | None = None
    visible_lines: bool = False
    layer_fields: LayerFields | None = None
    scale: tuple[float, float] = field(default=(1.0, 1.0))
    crosstalk: Matrix | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", tuple(self.layers))
        if not self.layers:
            raise PadFormatError("the pad has no layers; give at least one")
        channels = [layer.channel for layer in self.layers]
        if len(set(channels)) != len(channels):
            raise PadFormatError("two layers share a channel; each channel holds one layer")
        if not 2 <= self.window <= MAX_WINDOW:
            raise PadFormatError(f"window is {shown(self.window)}; it must be 2 … {MAX_WINDOW}")
        if not 2 <= self.levels <= MAX_LEVELS:
            raise PadFormatError(f"levels is {shown(self.levels)}; it must be 2 … {MAX_LEVELS}")
        for key, value, most in (("seed", self.seed, 10**30), ("distance", self.distance, 2**16)):
            if value is not None and not 0 <= value <= most:
                raise PadFormatError(f"{key} is {shown(value)}; it must be 0 … {most}")
        if not (np.isfinite(self.quiet_mm) and 0 <= self.quiet_mm <= 10_000):
            raise PadFormatError(f"quiet_mm is {shown(self.quiet_mm)}; it must be 0 … 10000")
        if not all(np.isfinite(s) and 0.5 <= s <= 2.0 for s in self.scale):
            raise PadFormatError(f"scale is {self.scale}; it must lie within 0.5 … 2 in x and y")
        object.__setattr__(self, "name", self._plain("name", self.name))
        if self.method is not None:
            self._plain("method", self.method)
        if self.crosstalk is not None:
            object.__setattr__(self, "crosstalk", check_matrix(self.crosstalk))
        for layer in self.layers:
            self._check_layer(layer)

    @staticmethod
    def _plain(key: str, value: str) -> str:
        try:
            return text.plain(value)
        except ValueError as error:
            raise PadFormatError(f"{key}: {error}") from error

    def _check_layer(self, layer: Layer) -> None:
        if min(layer.field.shape) < self.window:
            raise PadFormatError(
                f"{layer.channel} layer: {layer.rows} x {layer.cols} cells hold no "
                f"{self.window} x {self.window} window"
            )
        if int(layer.field.max()) >= self.levels:
            row, col = np.argwhere(layer.field >= self.levels)[0]
            raise PadFormatError(
                f"{layer.channel} layer, row {row}, column {col}: level {layer.field[row, col]} "
                f"is not below levels = {self.levels}"
            )

    @classmethod
    def load(cls, path: str | Path) -> Pad:
        """Read a pad file (docs/conventions.md, "Pad file").

        Raises
        ------
        PadFormatError
            If the file is ill-formed, with the place and the reason.
        """
        return cls.loads(files.read(Path(path)))

    @classmethod
    def loads(cls, content: str | bytes) -> Pad:
        """The pad in the text of a pad file; raises as `load`."""
        return cls.from_dict(files.parse(content))

    @classmethod
    def from_dict(cls, data: Any) -> Pad:
        """The pad in the JSON object of a pad file; raises as `load`."""
        fields = files.from_dict(data)
        layers = tuple(Layer(**layer._asdict()) for layer in fields.layers)
        return cls(**fields._asdict() | {"layers": layers})

    def save(self, path: str | Path) -> None:
        """Write the pad as a pad file."""
        Path(path).write_text(self.dumps(), encoding="utf-8")

    def dumps(self) -> str:
        """The text of the pad's file; equal pads give equal texts."""
        return files.to_text(self._fields())

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of the pad's file."""
        return files.to_dict(self._fields())

    def _fields(self) -> files.PadFields:
        layers = tuple(files.LayerFields(x.channel, x.cell_mm, x.field) for x in self.layers)
        rest = {key: getattr(self, key) for key in files.PadFields._fields if key != "layers"}
        return files.PadFields(layers, **rest)

    def with_crosstalk(self, matrix: Sequence[Sequence[float]] | Array | None) -> Pad:
        """The pad with the mixture by which its frames are un-mixed; None forgets it.

        Raises
        ------
        PadFormatError
            As `padstudio.pad.crosstalk.check_matrix`.
        """
        return replace(self, crosstalk=None if matrix is None else check_matrix(matrix))

    def layer(self, channel: Channel) -> Layer | None:
        """The layer in a channel, or None."""
        return next((layer for layer in self.layers if layer.channel == channel), None)

    @cached_property
    def width_mm(self) -> float:
        """Nominal width without the quiet margin, mm."""
        return max(layer.width_mm for layer in self.layers)

    @cached_property
    def height_mm(self) -> float:
        """Nominal height without the quiet margin, mm."""
        return max(layer.height_mm for layer in self.layers)

    @cached_property
    def size_mm(self) -> tuple[float, float]:
        """Measured width and height without the quiet margin, mm: nominal times `scale`."""
        return self.width_mm * self.scale[0], self.height_mm * self.scale[1]
