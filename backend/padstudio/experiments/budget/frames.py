"""Renders and reads one frame of a budget in all its cases."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from padstudio.arrays import Image
from padstudio.experiments.budget.draws import believed_camera, believed_pad, draw
from padstudio.experiments.budget.order import BudgetOrder, Case
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.spec import Pad
from padstudio.simulate.lay.relief import Relief
from padstudio.simulate.motion import Motion, poses_at
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.video_stream import Clip
from padstudio.vision.detector import Detector
from padstudio.vision.stage.params import DetectorParams

# Pictures of a stream before the one that is read: the key frame that it rests on.
_BEFORE = 1


@dataclass(frozen=True)
class Reading:
    """What the detector said of a frame.

    Attributes
    ----------
    state : {"full", "bearing", "none"}
        A pose; one of which range and bearing alone can be used; none.
    error_mm : (x, y, z)
        Position read less the true one, pad frame.
    turn_deg : (x, y, z)
        Rotation vector from the true attitude to the one read, camera frame.
    mbit_s : float or None
        What the picture's stream took.
    """

    state: str
    error_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mbit_s: float | None = None


def read_frame(
    order: BudgetOrder, number: int, cases: Sequence[Case], step: Callable[[], None]
) -> list[Reading]:
    """Render and read a frame in each of the cases.

    Cases that show the same share the picture, so that what a wrong belief of the detector changes
    is seen in the same noise.

    Parameters
    ----------
    order : BudgetOrder
    number : int
        Of the frame, from 0.
    cases : sequence of Case
    step : callable
        Called after each case; it may raise to end the work.

    Raises
    ------
    SpecError, LimitError
        As `padstudio.simulate.render.render`.
    """
    studio = _Studio(order, number)
    out = []
    for case in cases:
        out.append(studio.read(case))
        step()
    return out


@dataclass(frozen=True)
class _View:
    """What a picture before compression rests on, but for the frame's number."""

    camera_scale: float
    cell_scale: float
    exposure_ms: float
    readout_ms: float
    motion: Motion
    relief: Relief | None


@dataclass(eq=False)
class _Studio:
    """Pictures of one frame, each rendered once."""

    order: BudgetOrder
    number: int
    _pictures: dict[tuple[_View, int], Image] = field(default_factory=dict)
    _clips: dict[_View, Clip] = field(default_factory=dict)

    def read(self, case: Case) -> Reading:
        conditions, drawn = case.conditions, draw(self.order, case.conditions, self.number)
        blurs, rolls = "blur" in case.on, "rolling_shutter" in case.on
        moves = "compression" in case.on or blurs or rolls
        view = _View(
            camera_scale=case.sharper,
            cell_scale=case.larger,
            exposure_ms=conditions.exposure_ms if blurs else 0.0,
            readout_ms=conditions.readout_ms if rolls else 0.0,
            motion=drawn.motion if moves else Motion(),
            relief=drawn.relief if "flatness" in case.on else None,
        )
        mbit_s = None
        if "compression" in case.on and conditions.mbit_s:
            streamed = self._clip(view, drawn.pose, conditions.fps).at(conditions.mbit_s)
            picture, mbit_s = streamed.image, streamed.mbit_s
        else:
            picture = self._picture(view, drawn.pose, 0, conditions.fps)
        detection = self._detector(case).detect(picture)
        if detection.pose is None:
            return Reading("none", mbit_s=mbit_s)
        away = drawn.pose.step_to(detection.pose)
        away[3:] = np.degrees(away[3:])
        x, y, z, *turn = (float(value) for value in away)
        return Reading(detection.quality or "full", (x, y, z), (turn[0], turn[1], turn[2]), mbit_s)

    def _detector(self, case: Case) -> Detector:
        """The detector with all that it believes."""
        pad, camera = self._seen(case.sharper, case.larger)
        if "print_scale" in case.on:
            pad = believed_pad(pad, case.conditions, self.number)
        if "calibration" in case.on:
            camera = believed_camera(camera, case.conditions, self.number)
        if case.is_told_global:
            camera = replace(camera, readout_ms=0.0)
        params = DetectorParams()
        bend = replace(params.refine, bend=self.order.fits_bends)
        return Detector(pad, camera, params=replace(params, refine=bend))

    def _seen(self, camera_scale: float, cell_scale: float) -> tuple[Pad, Camera]:
        """The true pad and camera."""
        pad, camera = self.order.pad, self.order.camera
        if cell_scale != 1:
            layers = (replace(x, cell_mm=x.cell_mm * cell_scale) for x in pad.layers)
            pad = replace(pad, layers=tuple(layers))
        width, height = round(camera.width * camera_scale), round(camera.height * camera_scale)
        return pad, camera.for_frame(width, height)

    def _clip(self, view: _View, pose: Pose, fps: float) -> Clip:
        if view not in self._clips:
            numbers = range(_BEFORE, -1, -1)
            pictures = [self._picture(view, pose, before, fps) for before in numbers]
            self._clips[view] = Clip(pictures, self.order.codec, fps)
        return self._clips[view]

    def _picture(self, view: _View, pose: Pose, before: int, fps: float) -> Image:
        """The picture so many frames before the one that counts."""
        if not (view.exposure_ms or view.readout_ms or before):
            # What a camera in motion sees in an instant.
            view = replace(view, motion=Motion())
        if before:
            # The encoder follows what waves of the paper shift; rendering them takes long.
            view = replace(view, relief=None)
        key = (view, before)
        if key not in self._pictures:
            time_s = -before / fps
            rotation, position = poses_at(pose, view.motion, np.array(time_s))
            shaken = tuple(each.later(time_s) for each in view.motion.vibrations)
            pad, camera = self._seen(view.camera_scale, view.cell_scale)
            scene = Scene(pad=pad, lay=view.relief, ground_seed=self.order.seed % 2**32)
            self._pictures[key] = render(
                scene,
                camera,
                Pose(position, rotation),
                self._imaging(view),
                _noise_seed(self.order.seed, self.number, before),
                motion=replace(view.motion, vibrations=shaken),
            ).image
        return self._pictures[key]

    def _imaging(self, view: _View) -> Imaging:
        told = self.order.conditions
        return Imaging(
            exposure_ms=view.exposure_ms,
            readout_ms=view.readout_ms,
            full_well_e=told.full_well_e,
            read_noise_e=told.read_noise_e,
            jpeg_quality=None,
        )


def _noise_seed(seed: int, number: int, before: int) -> int:
    sequence = np.random.SeedSequence([seed, number, before, *b"noise"])
    return int(sequence.generate_state(1, np.uint64)[0])
