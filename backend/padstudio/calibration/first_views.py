"""The pad found in pictures of a camera of which nothing is known: cameras are guessed.

A window of cells is found whatever the lens, and a pose that a guessed camera gives is right about
there; the rest of the picture follows when the camera does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Image
from padstudio.geometry.camera import Camera
from padstudio.geometry.camera_files.parts.fields import LensModel
from padstudio.geometry.pose import Pose
from padstudio.pad.spec import Pad
from padstudio.vision.detector import Detector
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.params import DetectorParams, RefineParams
from padstudio.vision.stage.trace import StageFailure

# Focal lengths in widths of the picture and the lens's first two coefficients, the likeliest first:
# drones and phones, which correct their pictures; wide lenses; fisheyes; longer lenses.
_GUESSES: tuple[tuple[LensModel, float, tuple[float, float]], ...] = (
    ("radtan", 0.7, (0.0, 0.0)),
    ("radtan", 0.6, (-0.25, 0.06)),
    ("fisheye", 0.5, (0.0, 0.0)),
    ("radtan", 1.0, (0.0, 0.0)),
    ("fisheye", 0.33, (0.0, 0.0)),
    ("radtan", 1.4, (0.0, 0.0)),
    ("radtan", 2.0, (0.0, 0.0)),
    ("radtan", 3.0, (0.0, 0.0)),
)
#: Steps that `best_guess` takes at the most.
COUNT_OF_GUESSES = len(_GUESSES)
# Guesses are compared on so many pictures; the first that reads so large a share of their cells,
# with few of them wrong, is taken.
_TRIED, _GOOD = 4, 0.7
#: For cameras that are wrong yet. Through a wrong lens borders lie off their places, and flat paper
#: looks bent; so few borders tell a pose but no bend, whose search took nine tenths of the time.
ROUGHLY = DetectorParams(
    refine=RefineParams(most_borders=140, few_borders=140, most_residual_cells=0.25)
)


@dataclass(frozen=True, eq=False)
class FirstViews:
    """What a camera reads of some pictures.

    Attributes
    ----------
    camera : Camera
    poses : list of Pose or None
    failures : list of StageFailure or None
        Why there is no pose.
    """

    camera: Camera
    poses: list[Pose | None]
    failures: list[StageFailure | None]


def guessed(
    width: int, height: int, model: LensModel, widths: float, bend: tuple[float, float]
) -> Camera:
    """A camera of a focal length in widths of the picture and two coefficients."""
    centre = (width - 1) / 2, (height - 1) / 2
    focal = widths * max(width, height)
    matrix = np.array([[focal, 0, centre[0]], [0, focal, centre[1]], [0, 0, 1.0]])
    lens = np.zeros(4 if model == "fisheye" else 5)
    lens[:2] = bend
    return Camera(width, height, matrix, lens, model, name="calibrated", readout_ms=0.0)


def look(
    pictures: Sequence[Image], pad: Pad, camera: Camera, looked: Callable[[], None]
) -> FirstViews:
    """Read some pictures through a camera."""
    detector = Detector(pad, camera, params=ROUGHLY)
    found = []
    for picture in pictures:
        found.append(detector.detect(picture))
        looked()
    return FirstViews(camera, [each.pose for each in found], [each.failure for each in found])


def best_guess(
    pictures: Sequence[Image], pad: Pad, models: Sequence[LensModel], looked: Callable[[], None]
) -> Camera:
    """The guess that reads most of some pictures."""
    height, width = pictures[0].shape[:2]
    some = [pictures[k] for k in _spread(len(pictures), _TRIED)]
    scores: list[tuple[float, Camera]] = []
    for model, widths, bend in _GUESSES:
        if model not in models:
            continue
        camera = guessed(width, height, model, widths, bend)
        detector = Detector(pad, camera, params=ROUGHLY)
        score = float(np.mean([_share(detector.detect(picture)) for picture in some]))
        looked()
        scores.append((score, camera))
        if score >= _GOOD:
            break
    return max(scores, key=lambda item: item[0])[1]


def _share(detection: Detection) -> float:
    """The share of cells that are right beyond those that chance gives; 0 without a pose."""
    if not detection.ok or not detection.cells_read:
        return 0.0
    return max(0.0, 1 - 2 * detection.cells_wrong / detection.cells_read)


def _spread(count: int, most: int) -> list[int]:
    return sorted({round(k) for k in np.linspace(0, count - 1, min(count, most))})
