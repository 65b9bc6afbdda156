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

import copy
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from padstudio.arrays import Image, YuvFrame
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.dense.answer import of_whole_sign
from padstudio.vision.dense.explain import explain
from padstudio.vision.dense.following import look_near
from padstudio.vision.dense.judge import judge
from padstudio.vision.dense.misreadings import find_misreading
from padstudio.vision.dense.scales import contradiction
from padstudio.vision.dense.starts import first_poses, refine_best
from padstudio.vision.dense.tracker import Expectation
from padstudio.vision.dense.whole_pad import (
    WholeSign,
    find_whole_sign,
    outline_in,
    readable_poses,
)
from padstudio.vision.frame.diagnosis import FrameEvidence, diagnose, examine
from padstudio.vision.frame.prepare import prepare
from padstudio.vision.frame.regions import Region
from padstudio.vision.outline.quadrilateral import Outline
from padstudio.vision.reasons.clues import Clues
from padstudio.vision.reasons.failed import in_full
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.search.known_pads import FoundPad, KnownPad, together
from padstudio.vision.search.looks import Search
from padstudio.vision.search.search import Miss, Sighting, sightings
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.params import DetectorParams
from padstudio.vision.stage.trace import Reason, Recorder, StageFailure


class Dense:
    """The dense method for one camera and one or more pads.

    Parameters
    ----------
    pads : sequence of Pad
        As of `check_apart`; in any order, on which results do not depend.
    camera : Camera
    params : DetectorParams

    """

    def __init__(self, pads: Sequence[Pad], camera: Camera, params: DetectorParams) -> None:
        self.known = sorted((KnownPad.of(pad) for pad in pads), key=lambda known: known.id)
        self.camera = camera
        self.params = params

    def with_params(self, params: DetectorParams) -> Dense:
        """The same under other parameters."""
        other = copy.copy(self)
        other.params = params
        return other

    def detect(
        self, bgr: Image, recorder: Recorder, *, one_suffices: bool = False
    ) -> list[Detection]:
        """Find the pads in one still, without any hint.

        Pads of the same channels and the same mixture of colours are looked for in one search.

        Parameters
        ----------
        bgr : (H, W, 3) uint8
        recorder : Recorder
        one_suffices : bool
            The search ends with the first pad whose pose can be used as a whole.

        Returns
        -------
        list of Detection
            One for each pad that was found, the best first; or one with the failure that came
            nearest to an answer.
        """
        found: list[FoundPad] = []
        failures: list[StageFailure] = []
        for known in together(self.known, unmix=self.params.prepare.unmix):
            search, frame = self._search_of(known, bgr, recorder, one_suffices)
            failure = self._search(search, frame)
            found += search.found
            if search.suffices:
                break
            failures += [] if search.found or failure is None else [failure]
        if found:
            return sorted((item.detection for item in found), key=_best_first)
        return [Detection(None, max(failures, key=lambda failure: failure.progress))]

    def _search_of(
        self, known: Sequence[KnownPad], bgr: Image, recorder: Recorder, one_suffices: bool
    ) -> tuple[Search, FrameEvidence]:
        """A search for pads that are read in the same planes, and what it looks at."""
        frame = examine(bgr, known[0].pad, self.camera, self.params.prepare, recorder, len(known))
        others = [pad for pad in self.known if pad not in known]
        search = Search(
            frame.pyramid, frame.camera, frame.stretch, tuple(known), self.params, recorder,
            elsewhere=sum(len(pad.indices) for pad in others), one_suffices=one_suffices,
        )  # fmt: skip
        return search, frame

    def _search(self, search: Search, frame: FrameEvidence) -> StageFailure | None:
        """Find pads until all are found or nothing is left to look at; the last failure."""
        # A small pad's sides cost less than its cells; where they do not tell, they come last.
        self._by_outline(search, frame.clear or frame.faint)
        if not search.wanted:
            return None
        failure, last = self._by_lattice(search, frame.in_order())
        if failure is None or failure.reason is Reason.CHANNELS_SWAPPED:
            return failure
        self._by_outline(search, frame.faint if frame.clear else [])
        swap = self._from_afar(search, frame.clear + frame.faint)
        if search.found or swap is not None:
            return swap
        level = last.level if isinstance(last, Miss) else None
        explain(search, search.known[0], last.region, [], level)
        misread = find_misreading(search)
        if not search.recorder.in_full:
            return misread or diagnose(frame, failure)
        explained = in_full(Clues(frame, search), misread or failure)
        return diagnose(frame, failure) if explained is failure else explained

    def follow(
        self,
        frame: Image | YuvFrame,
        expected: Expectation,
        recorder: Recorder,
        reach: float = math.inf,
    ) -> Detection:
        """Find a pad near its expected pose; fails where the picture denies it.

        Parameters
        ----------
        frame : (H, W, 3) uint8, BGR, or YuvFrame
        expected : Expectation
        recorder : Recorder
        reach : float
            As of `Detector.look_near`.
        """
        camera = self.camera.for_frame(frame.shape[1], frame.shape[0])
        known = next(pad for pad in self.known if expected.pad_id in (None, pad.id))
        pyramid = prepare(frame, known.pad, self.params.prepare, recorder)
        refiner = Refiner(pyramid, camera, known.pad, self.params, 0, expected.motion)
        found = look_near(refiner, expected, recorder, reach)
        return replace(found, pad_id=known.id) if found.ok else found

    def _by_outline(self, search: Search, regions: list[Region]) -> None:
        """Find pads that are small in the frame, from where their colour ends.

        Four sides cost less than a lattice of cells that are a few pixels wide.
        """
        for region, refiners in self._left(search, regions):
            outline = search.recorder.run("outline", None, outline_in, refiners[0][1], region, 1)
            if isinstance(outline, StageFailure):
                continue
            for known, refiner in refiners:
                detection, reads = self._within(outline, refiner, search.recorder)
                if detection.ok:
                    _keep(search, known, detection, region, reads)
                    break

    def _within(
        self, outline: Outline, refiner: Refiner, recorder: Recorder
    ) -> tuple[Detection, list[LayerRead]]:
        """The pose of a pad whose four sides those of an outline are."""
        starts = recorder.run("pose", None, readable_poses, outline, refiner)
        refined = recorder.run("pose", None, refine_best, refiner, starts, np.inf)
        return judge(refiner, refined, recorder)

    def _by_lattice(
        self, search: Search, regions: Iterable[Region]
    ) -> tuple[StageFailure | None, Sighting | Miss]:
        """Find pads by lattices; why there are no more, and what was seen last.

        The failure is None where none is left to be found.
        """
        failure: StageFailure | None = None
        for found in sightings(search, regions):
            if isinstance(found, Miss):
                return failure or found.failure, found
            detection, reads = self._pose(search, found)
            if detection.ok:
                _keep(search, found.known, detection, found.region, reads)
                if not search.wanted:
                    return None, found
                continue
            failure = detection.failure
            if failure is not None and failure.reason is Reason.CHANNELS_SWAPPED:
                return failure, found
        raise AssertionError("a search ends with a miss")

    def _from_afar(self, search: Search, regions: list[Region]) -> StageFailure | None:
        """Find pads too far away for lattices; a failure where channels are exchanged."""
        for region, refiners in self._left(search, regions):
            if search.shows_foreign(region):
                continue
            for known, refiner in refiners:
                found = search.recorder.run("outline", None, find_whole_sign, refiner, region)
                if not isinstance(found, WholeSign):
                    continue
                fault = search.recorder.run(
                    "pose", None, contradiction, refiner, found.fit.pose, found.read
                )
                if fault is None:
                    detection = of_whole_sign(found, search.camera.focal_px)
                    _keep(search, known, detection, region, [found.read])
                    break
                if fault.reason is Reason.CHANNELS_SWAPPED:
                    return fault
        return None

    def _pose(self, search: Search, found: Sighting) -> tuple[Detection, list[LayerRead]]:
        """The pose of a sighting, and every layer's cells read with it."""
        recorder, pad = search.recorder, found.known.pad
        starts = recorder.run("pose", None, first_poses, pad, found)
        refiner = self._refiner(search, pad, search.attempts)
        good_mm = found.placement.layer.cell_mm
        refined = recorder.run("pose", None, refine_best, refiner, starts, good_mm)
        return judge(refiner, refined, recorder)

    def _left(
        self, search: Search, regions: Iterable[Region]
    ) -> Iterator[tuple[Region, list[tuple[KnownPad, Refiner]]]]:
        """Parts of regions that may show a whole pad, and refiners of the pads it may be."""
        for part in chain.from_iterable(map(search.left_of, regions)):
            if search.wanted and part.box.side <= self.params.outline.largest_px:
                pads, tries = search.wanted, len(self.known)
                yield part, [(item, self._refiner(search, item.pad, tries)) for item in pads]

    def _refiner(self, search: Search, pad: Pad, attempts: int) -> Refiner:
        return Refiner(search.pyramid, search.camera, pad, self.params, attempts)


def _keep(
    search: Search,
    known: KnownPad,
    detection: Detection,
    region: Region,
    reads: Sequence[LayerRead],
) -> None:
    """Note a pad that was found, so that the rest of the search leaves it out."""
    explain(search, known, region, reads)
    named = replace(detection, pad_id=known.id)
    search.found.append(FoundPad(known, named, search.camera))


def _best_first(detection: Detection) -> tuple[bool, float, str]:
    """Poses that can be used as a whole, then by the bound on chance."""
    return detection.quality != "full", detection.log10_false_alarm, detection.pad_id or ""
