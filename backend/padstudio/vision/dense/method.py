"""The dense method: everything in the picture counts.

The recipe, with the time of each step on samples/height_1300mm.jpg (1360 × 765; one core, all
loops compiled, the median of fifty runs). `Detector.detect` takes steps 1 to 8, and 9 only
where they find nothing; `Detector.track` takes 1, 7 and 8.

1.  `denoise`, `stretch`: median filter only against salt and pepper; grey values. 0.6 ms
2.  `clean`: regions of the pad's colour (`padstudio.vision.frame.regions`). 1.1 ms
3.  `outline`, for a region that is small and whole: its four sides give a pose for each quarter
    turn (IPPE), coarse cells tell which; then step 7. Not here; on height_3500mm.jpg 6 ms, and
    18 ms for step 7
4.  `channel`, `edges`: edge points of a region at one scale, coarse scales first. 0.7 ms
5.  `lines`, `grid`: the plane's normal by both line families at once, the spacing, and a
    projective map to numbered lines. 2.5 ms
6.  `decode`: all cells correlated with the pad at every place and quarter turn. 0.5 ms
7.  `pose`: IPPE on the lattice, then few borders of the coarse layer to all of the finest one
    (IRLS); from afar the whole pattern (Lucas-Kanade). 4.3 ms
8.  `choose`: the a-contrario test of all cells, read with that pose (below 0.1 ms); and, for a
    still, whether the pose explains every channel (`scales`, `cells.mixture`). 0.4 ms
9.  `outline`, the last resort: the whole pattern matched from the four sides. Not here
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from padstudio.arrays import Image, YuvFrame
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.bend.bent_sheet import flattened
from padstudio.vision.cells.correlation import LayerIndex
from padstudio.vision.cells.evidence import Evidence
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.dense.answer import choose, of_refined, of_whole_sign, unfit
from padstudio.vision.dense.explain import explain
from padstudio.vision.dense.misreadings import find_misreading
from padstudio.vision.dense.scales import borne_out, contradiction
from padstudio.vision.dense.starts import first_poses, refine_best
from padstudio.vision.dense.tracker import Expectation
from padstudio.vision.dense.whole_pad import (
    WholeSign,
    find_whole_sign,
    outline_in,
    readable_poses,
)
from padstudio.vision.frame.diagnosis import diagnose, examine
from padstudio.vision.frame.prepare import prepare
from padstudio.vision.frame.regions import Region
from padstudio.vision.pose.refiner import Refiner
from padstudio.vision.pose.results import RefinedPose
from padstudio.vision.search.looks import Search
from padstudio.vision.search.search import Miss, Sighting, sightings
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.params import DetectorParams
from padstudio.vision.stage.trace import Reason, Recorder, StageFailure

# While following, layers with cells of this width and number must agree.
_READABLE_PX, _ENOUGH = 5.0, 30
# Where so many cells of the fitted layer agree, a lock cannot have slipped.
_SURE_KAPPA = 0.8


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
        frame = examine(bgr, self.pad, self.camera, self.params.prepare, recorder)
        pyramid, camera, stretch = frame.pyramid, frame.camera, frame.stretch
        search = Search(pyramid, camera, stretch, self.indices, self.params, recorder)
        # A small pad's sides cost less than its cells; where they do not tell, they come last.
        first = self._small(frame.clear or frame.faint)
        found = self._by_outline(search, first)
        if found is not None:
            return found
        found, last = self._by_lattice(search, frame.in_order())
        if found.failure is None or found.failure.reason is Reason.CHANNELS_SWAPPED:
            return found
        faint = self._small(frame.faint) if frame.clear else []
        far = self._by_outline(search, faint) or self._from_afar(search, first + faint)
        if far is not None:
            return far
        level = last.level if isinstance(last, Miss) else None
        explain(search, last.region, [], level)
        return Detection(None, find_misreading(search) or diagnose(frame, found.failure))

    def _small(self, regions: list[Region]) -> list[Region]:
        """Of some regions those that may show the whole pad."""
        return [item for item in regions if item.box.side <= self.params.outline.largest_px]

    def follow(
        self, frame: Image | YuvFrame, expected: Expectation, recorder: Recorder
    ) -> Detection:
        """Find the pad near an expected pose; fails where the picture does not bear it out.

        A near miss must not pass for a lock, so every layer that can be read has to agree.
        """
        camera = self.camera.for_frame(frame.shape[1], frame.shape[0])
        pyramid = prepare(frame, self.pad, self.params.prepare, recorder)
        refiner = Refiner(pyramid, camera, self.pad, self.params, 0, expected.motion)
        miss_px = expected.miss * camera.focal_px
        refined = recorder.run("pose", None, refiner.follow, expected.pose, miss_px)
        if refined is None:
            refined = recorder.run("pose", None, refine_best, refiner, [expected.pose], np.inf)
        detection, reads = self._judge(refiner, refined, recorder)
        for read in reads:
            readable = read.cells.cell_px >= _READABLE_PX and read.evidence.read >= _ENOUGH
            if detection.ok and readable and not read.evidence.suffices(0.0):
                detail = f"near the last pose {read.wrong_cells} differ from the pad"
                return Detection(None, StageFailure("pose", Reason.POSE_REJECTED, detail))
        return detection

    def _by_outline(self, search: Search, small: list[Region]) -> Detection | None:
        """The pose of a pad that is small in the frame, from where its colour ends; or None.

        Four sides cost less than a lattice of cells that are a few pixels wide.
        """
        recorder, refiner = search.recorder, self._refiner(search, 1)
        for region in small:
            outline = recorder.run("outline", None, outline_in, refiner, region, 1)
            if isinstance(outline, StageFailure):
                continue
            starts = recorder.run("pose", None, readable_poses, outline, refiner)
            refined = recorder.run("pose", None, refine_best, refiner, starts, np.inf)
            detection, reads = self._judge(refiner, refined, recorder)
            if detection.ok:
                explain(search, region, reads)
                return detection
        return None

    def _by_lattice(
        self, search: Search, regions: Iterable[Region]
    ) -> tuple[Detection, Sighting | Miss]:
        """The pose of the first lattice that bears one, or why there is none; and what was last."""
        failure: StageFailure | None = None
        for found in sightings(search, regions):
            if isinstance(found, Miss):
                return Detection(None, failure or found.failure), found
            detection, reads = self._pose(search, found)
            if detection.ok:
                explain(search, found.region, reads)
                return detection, found
            failure = detection.failure
            if failure is not None and failure.reason is Reason.CHANNELS_SWAPPED:
                return detection, found
        raise AssertionError("a search ends with a miss")

    def _from_afar(self, search: Search, small: list[Region]) -> Detection | None:
        """The pose of a pad too far away for lattices, or None."""
        refiner = self._refiner(search, 1)
        for region in small:
            found = search.recorder.run("outline", None, find_whole_sign, refiner, region)
            if not isinstance(found, WholeSign):
                continue
            pose = found.fit.pose
            fault = search.recorder.run("pose", None, contradiction, refiner, pose, found.read)
            if fault is None:
                explain(search, region, [found.read])
                return of_whole_sign(found, search.camera.focal_px)
            if fault.reason is Reason.CHANNELS_SWAPPED:
                return Detection(None, fault)
        return None

    def _pose(self, search: Search, found: Sighting) -> tuple[Detection, list[LayerRead]]:
        """The pose of a sighting, and every layer's cells read with it."""
        recorder = search.recorder
        starts = recorder.run("pose", None, first_poses, self.pad, found)
        refiner = self._refiner(search, len(search.lattices) * len(self.indices))
        good_mm = found.placement.layer.cell_mm
        refined = recorder.run("pose", None, refine_best, refiner, starts, good_mm)
        return self._judge(refiner, refined, recorder)

    def _refiner(self, search: Search, attempts: int) -> Refiner:
        return Refiner(search.pyramid, search.camera, self.pad, self.params, attempts)

    def _judge(
        self, refiner: Refiner, refined: RefinedPose | None, recorder: Recorder
    ) -> tuple[Detection, list[LayerRead]]:
        """Read cells with the refined pose; give it only where they agree with the pad.

        Layers besides the fitted one are read where that leaves a doubt.
        """
        failure = unfit(refined, self.params.refine)
        if failure is not None or refined is None:
            recorder.note("pose", None, failure)
            return Detection(None, failure), []
        reads = [refined.read]
        sure = self._is_sure(refiner, refined.read.evidence) and not recorder.keep
        for layer in [] if sure else self.pad.layers:
            if layer is refined.layer:
                continue
            read = recorder.run("decode", layer.channel, refiner.read, layer, refined.fit.pose)
            if read is not None:
                reads.append(read)
        bound = self._bound(refiner)
        choice = recorder.run("choose", None, choose, reads, refined.layer, bound)
        if isinstance(choice, StageFailure):
            return Detection(None, choice), reads
        if refiner.attempts:
            settled = recorder.run("pose", None, borne_out, refiner, refined)
            if isinstance(settled, StageFailure):
                return Detection(None, settled), reads
            if settled is not refined:
                return self._judge(refiner, settled, recorder)
            refined = recorder.run("pose", None, flattened, refiner, refined)
        return of_refined(refined, choice), reads

    def _is_sure(self, refiner: Refiner, evidence: Evidence) -> bool:
        """True where the fitted layer's cells need no other's to bear them out."""
        bound = self._bound(refiner)
        if refiner.attempts:
            return evidence.suffices(bound)
        bound = min(bound, self.params.refine.log10_sure)
        return evidence.suffices(bound, least_kappa=_SURE_KAPPA)

    def _bound(self, refiner: Refiner) -> float:
        """The chance that evidence must stay below, log10."""
        bound = self.params.log10_false_alarm
        return bound if refiner.attempts else max(bound, self.params.refine.log10_followed)
