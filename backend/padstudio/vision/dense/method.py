"""The dense method: uses everything in the picture.

search → first pose → refinement on all borders → judgement on all cells. Each step stands in a
file of its own; this one knows their order.
"""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Image, YuvFrame
from padstudio.geometry.camera import Camera
from padstudio.geometry.planar_pnp import planar_pose
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.cells.correlation import LayerIndex
from padstudio.vision.cells.evidence import Evidence
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.cells.visible import to_pad
from padstudio.vision.dense.answer import choose, of_measurement, of_whole_sign, unfit
from padstudio.vision.dense.explain import explain
from padstudio.vision.dense.tracker import Expectation
from padstudio.vision.dense.whole_pad import (
    WholeSign,
    find_whole_sign,
    outline_in,
    readable_poses,
)
from padstudio.vision.frame.diagnosis import Suspect, diagnose
from padstudio.vision.frame.prepare import find_stretch, prepare
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import Region, find_regions
from padstudio.vision.pose.refiner import Refiner
from padstudio.vision.pose.results import Measurement, Rung
from padstudio.vision.search.search import Miss, Search, Sighting, sightings
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.params import DetectorParams
from padstudio.vision.stage.trace import Reason, Recorder, StageFailure

# Below this ratio of the two planar poses' errors the first one is beyond doubt.
_CLEAR = 0.15
# A start whose few borders fit this much better than the other's needs no comparison to the end.
_BETTER = 0.85
# So, too, where the whole pattern is compared.
_BETTER_MATCH = 0.97
# A sign larger than this in the frame shows cells that a lattice reads, if anything does.
_FAR_SIDE_PX = 800
# While following, layers with cells of this width and number must agree.
_READABLE_PX, _ENOUGH = 5.0, 30
# Where so many cells of the measured layer agree, a lock cannot have slipped.
_SURE_BOUND, _SURE_SKILL = -30.0, 0.8


class Dense:
    """The dense method for one pad and one camera.

    Parameters
    ----------
    pad : Pad
    camera : Camera
    params : DetectorParams
    """

    def __init__(self, pad: Pad, camera: Camera, params: DetectorParams) -> None:
        self.pad = pad
        self.camera = camera
        self.params = params
        layers = sorted(pad.layers, key=lambda layer: -layer.cell_mm)
        self.indices: dict[Channel, LayerIndex] = {
            layer.channel: LayerIndex(pad, layer) for layer in layers
        }

    def detect(self, bgr: Image, recorder: Recorder) -> Detection:
        """Find the pad in one still, without any hint."""
        pyramid, camera = self._prepare(bgr, recorder)
        stretch = recorder.run("stretch", None, find_stretch, pyramid)
        regions = recorder.run("clean", None, find_regions, pyramid, self.pad)
        frame = Search(pyramid, camera, stretch, self.indices, self.params, recorder)
        small = self._by_outline(frame, regions)
        if small is not None:
            return small
        failure: StageFailure | None = None
        for found in sightings(frame, regions):
            if isinstance(found, Miss):
                failure = failure or found.failure
                break
            detection, reads = self._pose(frame, found)
            if detection.ok:
                if recorder.keep:
                    recorder.append(explain(frame, found.region, reads, None))
                return detection
            failure = detection.failure
        return self._from_afar(frame, regions) or self._miss(frame, regions, found, failure)

    def _by_outline(self, frame: Search, regions: list[Region]) -> Detection | None:
        """The pose of a pad that is small in the frame, from where its colour ends; or None.

        Four sides cost less than a lattice of cells that are a few pixels wide.
        """
        recorder = frame.recorder
        refiner = Refiner(frame.pyramid, frame.camera, self.pad, self.params, 1)
        for region in regions[:-1]:
            if region.box.side > _FAR_SIDE_PX:
                continue
            outline = recorder.run("outline", None, outline_in, refiner, region, 1)
            if isinstance(outline, StageFailure):
                continue
            starts = recorder.run("pose", None, readable_poses, outline, refiner)
            measurement = recorder.run("pose", None, _best_of, refiner, starts, np.inf)
            detection, reads = self._judge(refiner, measurement, recorder)
            if detection.ok:
                if recorder.keep:
                    recorder.append(explain(frame, region, reads, None))
                return detection
        return None

    def _from_afar(self, frame: Search, regions: list[Region]) -> Detection | None:
        """The pose of a pad too far away for lattices, or None."""
        recorder = frame.recorder
        refiner = Refiner(frame.pyramid, frame.camera, self.pad, self.params, 1)
        for region in regions[:-1]:
            if region.box.side > _FAR_SIDE_PX:
                continue
            found = recorder.run("outline", None, find_whole_sign, refiner, region)
            if isinstance(found, WholeSign):
                if recorder.keep:
                    recorder.append(explain(frame, region, [found.read], None))
                return of_whole_sign(found, frame.camera.focal_px)
        return None

    def _miss(
        self,
        frame: Search,
        regions: list[Region],
        found: Sighting | Miss,
        failure: StageFailure | None,
    ) -> Detection:
        """No pose, and why."""
        assert failure is not None
        if frame.recorder.keep:
            level = found.level if isinstance(found, Miss) else None
            frame.recorder.append(explain(frame, found.region, [], level))
        suspect = Suspect(frame.pyramid, frame.camera, self.pad, frame.stretch, regions)
        return Detection(None, diagnose(suspect, failure))

    def _pose(self, frame: Search, found: Sighting) -> tuple[Detection, list[LayerRead]]:
        """The pose of a sighting, and every layer's cells read with it."""
        recorder = frame.recorder
        starts = recorder.run("pose", None, self._first_poses, found)
        attempts = len(frame.lattices) * len(self.indices)
        refiner = Refiner(frame.pyramid, frame.camera, self.pad, self.params, attempts)
        good_mm = found.placement.layer.cell_mm
        measurement = recorder.run(
            "pose", None, _best_of, refiner, [MovingPose(p) for p in starts], good_mm
        )
        return self._judge(refiner, measurement, recorder)

    def follow(
        self, frame: Image | YuvFrame, expected: Expectation, recorder: Recorder
    ) -> Detection:
        """Find the pad near an expected pose; fails where the picture does not bear it out.

        A near miss must not pass for a lock, so every layer that can be read has to agree.
        """
        pyramid, camera = self._prepare(frame, recorder)
        refiner = Refiner(pyramid, camera, self.pad, self.params, 0, expected.motion)
        miss_px = expected.miss * camera.focal_px
        measurement = recorder.run("pose", None, refiner.follow, expected.pose, miss_px)
        if measurement is None:
            measurement = recorder.run("pose", None, _best_of, refiner, [expected.pose], np.inf)
        detection, reads = self._judge(refiner, measurement, recorder)
        for read in reads:
            readable = read.cells.cell_px >= _READABLE_PX and read.evidence.read >= _ENOUGH
            if detection.ok and readable and not read.evidence.suffices(0.0):
                failure = StageFailure(
                    "pose",
                    Reason.POSE_REJECTED,
                    f"near the last pose {read.wrong_cells} differ from the pad",
                )
                return Detection(None, failure)
        return detection

    def _prepare(self, frame: Image | YuvFrame, recorder: Recorder) -> tuple[Pyramid, Camera]:
        camera = self.camera.for_frame(frame.shape[1], frame.shape[0])
        return prepare(frame, self.pad, self.params.prepare, recorder), camera

    def _first_poses(self, sighting: Sighting) -> list[Pose]:
        """The pose of the sighted lattice; both planar answers where they are near each other."""
        lattice, placement = sighting.lattice, sighting.placement
        columns, rows = np.linspace(*lattice.columns, 5), np.linspace(*lattice.rows, 5)
        here = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
        there = np.column_stack([here, np.ones(len(here))]) @ placement.pad_from_lattice.T
        points = to_pad(self.pad, placement.layer, there)
        first = planar_pose(points, lattice.to_rays(here))
        if first is None:
            return []
        if first.other is None or first.ambiguity < _CLEAR:
            return [first.pose]
        return [first.pose, first.other]

    def _judge(
        self, refiner: Refiner, measurement: Measurement | None, recorder: Recorder
    ) -> tuple[Detection, list[LayerRead]]:
        """Read cells with the refined pose; give it only where they agree with the pad.

        Layers besides the measured one are read where that leaves a doubt.
        """
        failure = unfit(measurement)
        if failure is not None or measurement is None:
            recorder.note("pose", None, failure)
            return Detection(None, failure), []
        reads = [measurement.read]
        sure = self._is_sure(refiner, measurement.read.evidence) and not recorder.keep
        for layer in [] if sure else self.pad.layers:
            if layer is measurement.layer:
                continue
            read = recorder.run("decode", layer.channel, refiner.read, layer, measurement.fit.pose)
            if read is not None:
                reads.append(read)
        choice = recorder.run(
            "choose", None, choose, reads, measurement.layer, self.params.log10_false_alarm
        )
        if isinstance(choice, StageFailure):
            return Detection(None, choice), reads
        return of_measurement(measurement, choice), reads

    def _is_sure(self, refiner: Refiner, evidence: Evidence) -> bool:
        """True where the measured layer's cells need no other's to bear them out."""
        bound = self.params.log10_false_alarm
        if refiner.attempts:
            return evidence.suffices(bound)
        return evidence.suffices(min(bound, _SURE_BOUND), least_skill=_SURE_SKILL)


def _best_of(refiner: Refiner, starts: list[MovingPose], good_mm: float) -> Measurement | None:
    """Refine from the start whose few borders fit best."""
    settled = [rungs for rungs in (refiner.settle(start, good_mm) for start in starts) if rungs]
    settled.sort(key=lambda rungs: (rungs[-1].layer.cell_mm, rungs[-1].rms_px))
    if len(settled) > 1:
        settled = _likely(refiner, settled)
    polished = [refiner.polish(rungs) for rungs in settled]
    found = [item for item in polished if item is not None]
    return min(found, key=lambda item: (item.layer.cell_mm, item.fit.rms_px), default=None)


def _likely(refiner: Refiner, settled: list[list[Rung]]) -> list[list[Rung]]:
    """The starts that may be right: the best one, and others that a look does not set apart."""
    margin = _BETTER
    if any(refiner.is_far(rungs[-1]) for rungs in settled):
        settled, margin = [refiner.matched(rungs) for rungs in settled], _BETTER_MATCH
    settled = sorted(settled, key=lambda rungs: rungs[-1].rms_px)
    kept = settled[:1]
    for rungs in settled[1:]:
        doubtful = rungs[-1].rms_px * margin <= kept[0][-1].rms_px
        if doubtful and not any(rungs[-1].pose.near(other[-1].pose) for other in kept):
            kept.append(rungs)
    return kept
