"""A camera and the poses of its pictures, nearer with each step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from padstudio.calibration.certainty import grid_pixels
from padstudio.calibration.first_views import guessed
from padstudio.calibration.patches import Patches, measure
from padstudio.calibration.solve import UNTOLD, Freedom, Solution, rms_px, solve
from padstudio.errors import CalibrationError
from padstudio.geometry.camera import Camera
from padstudio.geometry.camera_files.parts.fields import LensModel
from padstudio.geometry.pose import Pose
from padstudio.pad.spec import Pad
from padstudio.vision.frame.pyramid import Pyramid

# A picture with fewer patches says nothing that the others do not.
_LEAST_PATCHES = 8
# Steps by coarse cells; then by fine ones, at most so many until the lens stays within so many
# pixels.
_COARSE: tuple[Freedom, ...] = ("focal", "focal", "centred", "centred")
_MOST_FINE, _SETTLED_PX = 8, 0.01
# Patches beyond so many scatters, and pictures whose patches scatter so much more than those of
# the others and by so many pixels, are left out.
_FAR, _ODD, _ODD_PX = 5.0, 3.0, 0.15
# Patches less sure than this many times the usual only weigh on the sure ones.
_UNSURE = 3.0
# Another model is taken where residuals are smaller by this share.
_BETTER = 0.97
#: Steps that a search takes at the most.
MOST_STEPS = len(_COARSE) + 1 + 2 * _MOST_FINE


@dataclass(eq=False)
class CalibrationSearch:
    """The state of a calibration.

    Attributes
    ----------
    pad : Pad
    pyramids : list of Pyramid
        Of the pictures.
    poses : list of Pose or None
    camera : Camera
    stepped : callable
        Called after each step.
    patches : dict
        Of the pictures that tell enough, by their number.
    """

    pad: Pad
    pyramids: list[Pyramid]
    poses: list[Pose | None]
    camera: Camera
    stepped: Callable[[], None]
    patches: dict[int, Patches] = field(default_factory=dict)

    def approach(self) -> None:
        """From a guessed camera to one that shows fine cells where they are."""
        for freedom in _COARSE:
            self.step(freedom, fine=False)
        self.step("centred", fine=True)

    def settle(self, models: Sequence[LensModel]) -> Solution:
        """The best camera of some models, by fine cells."""
        solution = self._settled()
        for model in models:
            if model == self.camera.model:
                continue
            try:
                other = self._of_model(model)
            except CalibrationError:
                # What no camera of that model explains, one of this does.
                continue
            # The usual model is taken where both explain the pictures alike.
            share = _BETTER if model == "fisheye" else 1 / _BETTER
            if other.rms_px < share * solution.rms_px:
                self._take(other)
                solution = self._settled()
        return self._without_strangers(solution)

    def step(self, freedom: Freedom, *, fine: bool) -> Solution:
        """Measure all pictures anew, and fit the camera to them."""
        settled = fine and freedom == "full"
        found = {
            number: patches
            for number, pose in enumerate(self.poses)
            if pose is not None and (patches := self._measure(number, pose, fine, settled))
        }
        if not found:
            raise CalibrationError(UNTOLD)
        usual = float(np.median([np.median(each.sigma_px) for each in found.values()]))
        self.patches = {n: each.take(each.sigma_px < _UNSURE * usual) for n, each in found.items()}
        solution = solve(list(self.patches.values()), self.camera, freedom)
        self._take(solution)
        self.stepped()
        return solution

    def _measure(self, number: int, pose: Pose, fine: bool, settled: bool) -> Patches | None:
        """Patches of the layer that tells most, or of the coarsest that tells enough."""
        told = []
        for layer in sorted(self.pad.layers, key=lambda each: -each.cell_mm):
            pyramid = self.pyramids[number]
            found = measure(pyramid, self.pad, layer, self.camera, pose, settled=settled)
            if found is None or len(found) < _LEAST_PATCHES:
                continue
            if not fine:
                return found
            told.append(found)
        return max(told, key=lambda each: float(np.sum(each.sigma_px**-2.0)), default=None)

    def _take(self, solution: Solution) -> None:
        self.camera = solution.camera
        for number, pose in zip(self.patches, solution.poses, strict=True):
            self.poses[number] = pose

    def _settled(self) -> Solution:
        for _ in range(_MOST_FINE):
            before = self.camera
            solution = self.step("full", fine=True)
            if _apart_px(before, self.camera) < _SETTLED_PX:
                break
        return solution

    def _of_model(self, model: LensModel) -> Solution:
        """The best camera of another model, by the patches at hand."""
        here, views = self.camera, list(self.patches.values())
        widths = here.focal_px / max(here.width, here.height)
        camera = guessed(here.width, here.height, model, widths, (0.0, 0.0))
        freedoms: tuple[Freedom, ...] = ("focal", "centred", "full")
        for freedom in freedoms:
            solution = solve(views, camera, freedom)
            camera = solution.camera
        return solution

    def _without_strangers(self, solution: Solution) -> Solution:
        """Fit without patches and pictures that contradict the rest."""
        rms = {n: rms_px(each) for n, each in zip(self.patches, solution.residuals, strict=True)}
        usual = float(np.median(list(rms.values())))
        kept = {}
        for number, residuals in zip(self.patches, solution.residuals, strict=True):
            if rms[number] > max(_ODD * usual, _ODD_PX):
                continue
            length = np.hypot(*residuals.T)
            near = length < _FAR * np.median(length) + _SETTLED_PX
            kept[number] = self.patches[number].take(near)
        self.patches = kept
        solution = solve(list(kept.values()), self.camera, "full")
        self._take(solution)
        return solution


def _apart_px(a: Camera, b: Camera) -> float:
    """By how much two cameras differ in where they show directions, pixels."""
    pixels = grid_pixels(a)
    rays = a.normalize(pixels)
    seen = a.has_ray(pixels, rays)
    return float(np.abs(b.denormalize(rays[seen]) - pixels[seen]).max(initial=0.0))
