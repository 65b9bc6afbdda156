"""The frames of a shoot-out: where the camera is, the same over every board."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from padstudio.experiments.shootout.boards.sheets import Page
from padstudio.geometry.pose import Pose
from padstudio.simulate.motion import Motion
from padstudio.simulate.trajectories import FLIGHT_KINDS, VIDEO_KINDS, FlightSpec, plan

#: Flights of the simulator, and stills over the board's edge.
KINDS: tuple[str, ...] = (*FLIGHT_KINDS, "edge")


@dataclass(frozen=True, eq=False)
class View:
    """One frame to be taken over every board.

    Attributes
    ----------
    pose : Pose
    motion : Motion
    """

    pose: Pose
    motion: Motion

    @property
    def height_mm(self) -> float:
        """Of the camera over the ground."""
        return float(self.pose.position_mm[2])

    @property
    def distance_mm(self) -> float:
        """From the camera to the ground along the optical axis; the height where it meets none."""
        down = -float(self.pose.rotation[2, 2])
        return self.height_mm / down if down > 0 else self.height_mm


def is_movement(kind: str) -> bool:
    """Whether the frames of a flight follow one another in time."""
    return kind in VIDEO_KINDS


def views(spec: FlightSpec, edge_of: Page | None = None) -> list[View]:
    """The frames of a flight.

    Parameters
    ----------
    spec : FlightSpec
    edge_of : Page or None
        Move each frame so that the optical axis meets the edge of this page: in turn a corner, and
        the middle of a side, about the whole page.

    Returns
    -------
    list of View
    """
    flight = plan(spec)
    poses = list(flight.poses)
    if edge_of is not None:
        places = _rim(edge_of)
        poses = [_moved(pose, places[k % len(places)]) for k, pose in enumerate(poses)]
    return [View(pose, motion) for pose, motion in zip(poses, flight.motions, strict=True)]


def _rim(page: Page) -> list[tuple[float, float]]:
    """Corners and middles of sides in turn, clockwise, pad frame, mm."""
    x, y = page.width_mm / 2, page.height_mm / 2
    return [(x, y), (x, 0), (x, -y), (0, -y), (-x, -y), (-x, 0), (-x, y), (0, y)]


def _moved(pose: Pose, place_mm: tuple[float, float]) -> Pose:
    """A pose moved level until its optical axis meets a place of the ground."""
    forward = pose.rotation[:, 2]
    x, y = np.array(place_mm) - forward[:2] / forward[2] * -pose.position_mm[2]
    return Pose(np.array([x, y, pose.position_mm[2]]), pose.rotation)
