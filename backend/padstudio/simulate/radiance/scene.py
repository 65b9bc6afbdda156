"""What stands before the camera: the pad, its inks, the ground, the light and what lies about."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from padstudio.errors import SpecError, shown
from padstudio.geometry.pose import Pose, rotation_from_vector
from padstudio.pad.layout import Layout
from padstudio.pad.spec import Pad
from padstudio.simulate.lay.relief import Relief
from padstudio.simulate.lay.tiles import Tiles
from padstudio.simulate.radiance.fog import Fog
from padstudio.simulate.radiance.inks import Inks, Rgb
from padstudio.simulate.radiance.litter import Litter

GroundKind = Literal["grass", "gravel", "asphalt", "bricks", "concrete", "sand", "snow", "plain"]
GROUND_KINDS: tuple[GroundKind, ...] = get_args(GroundKind)


@dataclass(frozen=True, kw_only=True)
class Shadow:
    """A shadow on the ground with a soft edge.

    Attributes
    ----------
    x_mm, y_mm : float
        The centre of a disc; or a point of the straight edge. Pad frame.
    radius_mm : float or None
        Of the disc; None for a shadow that covers a half plane.
    toward_deg : float
        For a half plane: the compass direction (clockwise from +Y) in which it lies in shadow.
    softness_mm : float
        Width of the penumbra.
    density : float
        Share of the light that is missing, 0 … 1.
    """

    x_mm: float = 0.0
    y_mm: float = 0.0
    radius_mm: float | None = None
    toward_deg: float = 90.0
    softness_mm: float = 40.0
    density: float = 0.8

    def __post_init__(self) -> None:
        if not 0 <= self.density <= 1:
            raise SpecError(f"a shadow's density is {self.density}; it must lie within 0 … 1")
        if self.softness_mm < 0 or (self.radius_mm is not None and self.radius_mm <= 0):
            raise SpecError("a shadow's radius must be above 0 and its softness not below 0")


@dataclass(frozen=True, kw_only=True)
class Occluder:
    """A disc that lies on the pad: a leaf, a stone, a splash of mud.

    Attributes
    ----------
    x_mm, y_mm, radius_mm : float
        Pad frame.
    color : (r, g, b)
        sRGB 0 … 255 of a correctly exposed picture.
    """

    x_mm: float
    y_mm: float
    radius_mm: float
    color: Rgb = (120.0, 130.0, 90.0)

    def __post_init__(self) -> None:
        if not self.radius_mm > 0:
            raise SpecError(f"an occluder's radius is {self.radius_mm} mm; it must be above 0")


@dataclass(frozen=True, kw_only=True)
class Neighbour:
    """Another pad on the same ground, in the same inks and with the scene's margin.

    Attributes
    ----------
    pad : Pad
    x_mm, y_mm : float
        Where its centre lies, pad frame of the scene's own pad.
    turn_deg : float
        Its heading: where its +Y points, clockwise from +Y.
    """

    pad: Pad
    x_mm: float
    y_mm: float
    turn_deg: float = 0.0

    def __post_init__(self) -> None:
        if not all(math.isfinite(value) for value in (self.x_mm, self.y_mm, self.turn_deg)):
            raise SpecError("a neighbour's place and turn must be finite")

    def relative(self, pose: Pose) -> Pose:
        """A pose of the scene's pad frame in this pad's own."""
        turn = rotation_from_vector(np.array([0.0, 0.0, math.radians(self.turn_deg)]))
        away = pose.position_mm - np.array([self.x_mm, self.y_mm, 0.0])
        return Pose(turn @ away, turn @ pose.rotation)


@dataclass(frozen=True, kw_only=True)
class Light:
    """The light on the ground.

    Attributes
    ----------
    level : float
        Brightness at the pad's centre; 1.0 is what a correct exposure expects.
    gradient_per_m : (x, y)
        Relative change of brightness per metre along the pad's X and Y.
    cast : (r, g, b)
        Colour of the light that the white balance left over; (1, 1, 1) is none.
    shadows : tuple of Shadow
    """

    level: float = 1.0
    gradient_per_m: tuple[float, float] = (0.0, 0.0)
    cast: Rgb = (1.0, 1.0, 1.0)
    shadows: tuple[Shadow, ...] = ()

    def __post_init__(self) -> None:
        if not (math.isfinite(self.level) and 0 < self.level <= 100):
            raise SpecError(f"the light's level is {self.level}; it must lie within 0 … 100")
        if min(self.cast) < 0:
            raise SpecError(f"the light's cast is {self.cast}; no part may be below 0")


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A pad on the ground.

    Attributes
    ----------
    pad : Pad or None
        None leaves the ground bare: what a detector must stay silent on.
    sheet : Layout or None
        Another print that lies there instead of a pad, in the same inks: a foreign marker, say.
        Its page's middle is the origin; its margins are even.
    inks : Inks
    quiet_mm : float or None
        White margin round the pad; None takes the pad's own.
    ground : {"grass", "gravel", "asphalt", "bricks", "concrete", "sand", "snow", "plain"}
    ground_seed : int
        Another seed, another patch of the same ground.
    light : Light
    occluders : tuple of Occluder
    litter : Litter or None
        Leaves, snow or mud on the print.
    fog : Fog or None
    lay : Relief or Tiles or None
        Bent paper, or many sheets laid by hand; None lies flat and whole. Poses stay relative to
        the nominal plane.
    neighbours : tuple of Neighbour
        Other pads, or copies of the same; what overlaps them is the scene's own pad.
    """

    pad: Pad | None
    sheet: Layout | None = None
    inks: Inks = field(default_factory=Inks)
    quiet_mm: float | None = None
    ground: GroundKind = "grass"
    ground_seed: int = 1
    light: Light = field(default_factory=Light)
    occluders: tuple[Occluder, ...] = ()
    litter: Litter | None = None
    fog: Fog | None = None
    lay: Relief | Tiles | None = None
    neighbours: tuple[Neighbour, ...] = ()

    def __post_init__(self) -> None:
        if self.ground not in GROUND_KINDS:
            raise SpecError(
                f"no ground {shown(self.ground)}; choose one of {', '.join(GROUND_KINDS)}"
            )
        if self.pad is not None and self.sheet is not None:
            raise SpecError("a scene has a pad or another sheet, not both")
        if self.quiet_mm is not None and not 0 <= self.quiet_mm <= 10_000:
            raise SpecError(f"quiet_mm is {self.quiet_mm}; it must be 0 … 10000")
        if self.neighbours and (self.pad is None or isinstance(self.lay, Relief)):
            raise SpecError("pads may lie beside a pad that is flat, not beside bare or bent ones")

    @property
    def size_mm(self) -> tuple[float, float] | None:
        """Width and height of what is printed; None where the ground is bare."""
        if self.sheet is not None:
            return self.sheet.page_width_mm, self.sheet.page_height_mm
        return None if self.pad is None else self.pad.size_mm
