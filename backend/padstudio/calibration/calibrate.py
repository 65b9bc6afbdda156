"""Calibrates a camera from pictures of a pad: the one door to this folder.

1.  The pad is found through guessed cameras (`first_views`).
2.  Patches about each pose (`patches`), those of the coarse layer first, lead to a focal length
    and one coefficient of the lens (`solve`); with these more of each picture is explained, and so
    on until all that a picture shows of the pad is.
3.  The finest layer that can be read gives the patches that count, and the whole camera.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from padstudio.arrays import Image
from padstudio.calibration.certainty import lens_sigma
from padstudio.calibration.first_views import COUNT_OF_GUESSES, ROUGHLY, best_guess, look
from padstudio.calibration.planes import PadPlanes
from padstudio.calibration.results import Calibration, CalibrationView
from padstudio.calibration.search import MOST_STEPS, CalibrationSearch
from padstudio.calibration.solve import Solution
from padstudio.errors import CalibrationError
from padstudio.geometry.camera_files.parts.fields import LensModel
from padstudio.pad.spec import Pad
from padstudio.vision.detector import Detector
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.stage.trace import StageFailure

#: Fewer pictures tell no camera; more than these add time rather than certainty.
LEAST_PICTURES, MOST_PICTURES = 3, 60

# So many found by a guessed camera will do: the camera that they tell finds others.
_LEAST_FIRST = 2
# Pictures with fewer patches than this share of the others' are looked at again.
_FEW = 0.35

#: Takes how many steps are done, of how many.
Progress = Callable[[int, int], None]


def calibrate(
    pad: Pad,
    pictures: Sequence[Image],
    *,
    models: Sequence[LensModel] = ("radtan", "fisheye"),
    progress: Progress = lambda done, total: None,
) -> Calibration:
    """Find a camera's intrinsics and lens from pictures of a flat pad.

    Parameters
    ----------
    pad : Pad
    pictures : sequence of (H, W, 3) uint8
        BGR, of one size, by a camera at one zoom and focus, held still; the pad large in them, from
        many sides, and in every part of the picture at least once. Each is asked for several times,
        so that not all need be in memory.
    models : sequence of {"radtan", "fisheye"}
        Of several the one that explains the pictures best.
    progress : callable

    Returns
    -------
    Calibration

    Raises
    ------
    CalibrationError
        If pictures differ in size, or the pad is found in too few of them to tell a camera.
    """
    check_pictures([(picture.shape[1], picture.shape[0]) for picture in pictures])
    total = COUNT_OF_GUESSES + len(pictures) + MOST_STEPS
    done = 0

    def step() -> None:
        nonlocal done
        done = min(done + 1, total - 1)
        progress(done, total)

    guess = best_guess(pictures, pad, models, step)
    first = look(pictures, pad, guess, step)
    _need(first.failures, sum(pose is not None for pose in first.poses), _LEAST_FIRST)
    planes: list[Pyramid] = [PadPlanes(picture, pad) for picture in pictures]
    search = CalibrationSearch(pad, planes, list(first.poses), guess, step)
    search.approach()
    failures = _look_again(search, pictures, first.failures)
    step()
    solution = search.settle(models)
    _need(failures, len(search.patches), LEAST_PICTURES)
    progress(total, total)
    return _calibration(search, solution, failures)


def check_pictures(sizes: Sequence[tuple[int, int]]) -> None:
    """Refuse pictures that cannot be of one camera, or are too few or too many.

    Parameters
    ----------
    sizes : sequence of (width, height)

    Raises
    ------
    CalibrationError
    """
    check_count(len(sizes))
    for number, size in enumerate(sizes):
        if size != sizes[0]:
            raise CalibrationError(
                f"picture {number + 1} is {size[0]} x {size[1]}, the first one "
                f"{sizes[0][0]} x {sizes[0][1]}; give pictures of one camera in one mode"
            )


def check_count(count: int) -> None:
    """Refuse too few or too many pictures; raises as `check_pictures`."""
    if not LEAST_PICTURES <= count <= MOST_PICTURES:
        raise CalibrationError(
            f"{count} picture{'' if count == 1 else 's'}; give {LEAST_PICTURES} … {MOST_PICTURES}, "
            "best a dozen or two"
        )


def _look_again(
    search: CalibrationSearch, pictures: Sequence[Image], failures: Sequence[StageFailure | None]
) -> list[StageFailure | None]:
    """Look with a camera that is nearly right at pictures that told little; why some still do."""
    counts = [len(patches) for patches in search.patches.values()]
    few = _FEW * float(np.median(counts))
    detector = Detector(search.pad, search.camera, params=ROUGHLY)
    out = list(failures)
    for number, picture in enumerate(pictures):
        if len(search.patches.get(number, ())) < few:
            found = detector.detect(picture)
            search.poses[number] = found.pose or search.poses[number]
            out[number] = None if search.poses[number] is not None else found.failure
    return out


def _need(failures: Sequence[StageFailure | None], found: int, least: int) -> None:
    if found < least:
        reasons = [failure.detail for failure in failures if failure is not None]
        why = f" ({max(set(reasons), key=reasons.count)})" if reasons else ""
        raise CalibrationError(
            f"the pad was read in {found} of {len(failures)} pictures, a camera needs "
            f"{LEAST_PICTURES}{why}; choose the pad that was printed, and show it large and sharp"
        )


def _calibration(
    search: CalibrationSearch, solution: Solution, failures: Sequence[StageFailure | None]
) -> Calibration:
    used = dict(
        zip(search.patches, zip(solution.poses, solution.residuals, strict=True), strict=True)
    )
    views = []
    for number, failure in enumerate(failures):
        if number in used:
            pose, residuals = used[number]
            patches = search.patches[number]
            views.append(CalibrationView(pose, None, patches, residuals, is_used=True))
        else:
            views.append(CalibrationView(search.poses[number], failure))
    sigma = lens_sigma(list(search.patches.values()), solution.camera, solution.poses)
    return Calibration(solution.camera, sigma, views)
