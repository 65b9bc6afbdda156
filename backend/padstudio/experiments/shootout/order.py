"""What a user orders: pad, camera, flight, disturbances and the boards that take part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from padstudio.errors import LimitError, SpecError, shown
from padstudio.experiments.shootout.boards.catalogue import BOARDS, USUAL
from padstudio.experiments.shootout.boards.sheets import Page, page_of
from padstudio.experiments.shootout.views import KINDS, View, views
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad
from padstudio.simulate.disturbances import vibrations_of
from padstudio.simulate.looks import dress
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.trajectories import Flight, FlightSpec, Setup, check_flight

#: Frames of a flight: each is rendered and read once a board.
MAX_FRAMES = 200


@dataclass(frozen=True, kw_only=True)
class Shootout:
    """An order, checked.

    Attributes
    ----------
    pad : Pad
    camera : Camera
    flight : str
        One of `padstudio.experiments.shootout.views.KINDS`.
    frames : int
        At most `MAX_FRAMES`.
    from_mm, to_mm : float
        Heights, mm; of tilts the distance is ``from_mm``.
    sway : float
        Scales how much the camera wanders and leans.
    look : str
        Conditions, as of `padstudio.simulate.looks`.
    disturbances : tuple of str
        As of `padstudio.simulate.disturbances`.
    ground : str
    boards : tuple of str
        Names of `padstudio.experiments.shootout.boards.catalogue.BOARDS`.
    seed : int

    Raises
    ------
    SpecError, LimitError
        If anything is out of range, or cannot be simulated.
    """

    pad: Pad
    camera: Camera
    flight: str = "descent"
    frames: int = 24
    from_mm: float = 16_000.0
    to_mm: float = 60.0
    sway: float = 1.0
    look: str = "clear"
    disturbances: tuple[str, ...] = ()
    ground: str = "grass"
    boards: tuple[str, ...] = USUAL
    seed: int = 1

    def __post_init__(self) -> None:
        if self.flight not in KINDS:
            raise SpecError(f"no flight {shown(self.flight)}; choose one of {', '.join(KINDS)}")
        if self.frames > MAX_FRAMES:
            raise LimitError(
                f"{self.frames} frames are asked for; a shoot-out takes at most {MAX_FRAMES}, as "
                "each is rendered once a board",
                code="too_many_frames",
                detail={"frames": self.frames, "limit": MAX_FRAMES},
            )
        for name in self.boards:
            if name not in BOARDS:
                raise SpecError(f"no board {shown(name)}; choose of {', '.join(BOARDS)}")
        if len(set(self.boards)) != len(self.boards):
            raise SpecError("a board is named twice; name each once")
        if any(word.strip().startswith("copy=") for word in self.disturbances):
            raise SpecError("copy is of pads alone; a shoot-out lays one board at a time")
        planned = self.views
        setup = self.setup(self.pad, 0)
        flight = Flight(
            self.flight,
            None,
            tuple(view.pose for view in planned),
            tuple(view.motion for view in planned),
            (self.flight,) * len(planned),
        )
        check_flight(flight, setup)

    @classmethod
    def of(cls, order: Mapping[str, Any]) -> Shootout:
        """From plain values: ``pad`` and ``camera`` are the contents of files.

        Raises
        ------
        StudioError
            As the constructor, and where a file is ill-formed.
        """
        known = {field.name for field in fields(cls)}
        given = {name: value for name, value in order.items() if name in known}
        given["pad"], given["camera"] = Pad.loads(given["pad"]), Camera.loads(given["camera"])
        for name in ("boards", "disturbances"):
            given[name] = tuple(given[name]) if given.get(name) is not None else getattr(cls, name)
        return cls(**given)

    @property
    def by_tilt(self) -> bool:
        """Whether the frames differ in tilt rather than in height."""
        return self.flight == "tilts"

    @property
    def page(self) -> Page:
        """The size at which all boards are printed."""
        return page_of(self.pad)

    @property
    def views(self) -> list[View]:
        """The frames to be taken of every board."""
        spec = FlightSpec(
            kind="descent" if self.flight == "edge" else self.flight,  # type: ignore[arg-type]
            frames=self.frames,
            from_mm=self.from_mm,
            to_mm=self.to_mm,
            seed=self.seed,
            sway=self.sway,
            vibrations=vibrations_of(self.disturbances, seed=self.seed),
        )
        return views(spec, self.page if self.flight == "edge" else None)

    def setup(self, print_: Any, number: int) -> Setup:
        """What a frame is taken of and with; ``print_`` is the pad, a sheet, or None."""
        is_pad = isinstance(print_, Pad)
        scene = Scene(
            pad=print_ if is_pad else None,
            sheet=None if is_pad else print_,
            ground=self.ground,  # type: ignore[arg-type]  # Scene names the choices itself
            ground_seed=self.seed,
        )
        dressed, imaging = dress(scene, self.look, seed=self.seed, words=self.disturbances)
        return Setup(scene=dressed, camera=self.camera, imaging=imaging, seed=self.seed + number)
