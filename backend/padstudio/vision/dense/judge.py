"""Whether a refined pose is given: its cells are read and have to agree with the pad."""

from __future__ import annotations

from padstudio.vision.bend.bent_sheet import as_it_lies
from padstudio.vision.cells.evidence import Evidence
from padstudio.vision.cells.layer_read import LayerRead
from padstudio.vision.dense.answer import choose, of_refined, unfit
from padstudio.vision.dense.misplaced import at_its_place
from padstudio.vision.dense.scales import borne_out
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.refine.results import RefinedPose
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Recorder, StageFailure

# Where so many cells of the fitted layer agree, a lock cannot have slipped.
_SURE_KAPPA = 0.8


def judge(
    refiner: Refiner, refined: RefinedPose | None, recorder: Recorder
) -> tuple[Detection, list[LayerRead]]:
    """Read cells with the refined pose; give it only where they agree with the pad.

    Layers besides the fitted one are read where that leaves a doubt.
    """
    failure = unfit(refined, refiner.params.refine)
    if failure is not None or refined is None:
        recorder.note("pose", None, failure)
        return Detection(None, failure), []
    reads = [refined.read]
    sure = _is_sure(refiner, refined.read.evidence) and not recorder.keep
    for layer in [] if sure else refiner.pad.layers:
        if layer is refined.layer:
            continue
        read = recorder.run("decode", layer.channel, refiner.read, layer, refined.fit.pose)
        if read is not None:
            reads.append(read)
    bound = _bound(refiner)
    choice = recorder.run("choose", None, choose, reads, refined.layer, bound)
    if isinstance(choice, StageFailure):
        return Detection(None, choice), reads
    if refiner.attempts:
        settled = recorder.run("pose", None, borne_out, refiner, refined)
        if settled is refined:
            settled = recorder.run("pose", None, at_its_place, refiner, refined)
        if isinstance(settled, StageFailure):
            return Detection(None, settled), reads
        if settled is not refined:
            return judge(refiner, settled, recorder)
        if refiner.params.refine.bend:
            refined = recorder.run("pose", None, as_it_lies, refiner, refined)
    return of_refined(refined, choice), reads


def _is_sure(refiner: Refiner, evidence: Evidence) -> bool:
    """True where the fitted layer's cells need no other's to bear them out."""
    bound = _bound(refiner)
    if refiner.attempts:
        return evidence.suffices(bound)
    bound = min(bound, refiner.params.refine.log10_sure)
    return evidence.suffices(bound, least_kappa=_SURE_KAPPA)


def _bound(refiner: Refiner) -> float:
    """The chance that evidence must stay below, log10."""
    bound = refiner.params.log10_false_alarm
    return bound if refiner.attempts else max(bound, refiner.params.refine.log10_followed)
