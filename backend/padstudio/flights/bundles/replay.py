"""Makes a bundle of a frame, and reads a bundle's frame again."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from padstudio.arrays import Image, YuvFrame
from padstudio.flights.bundles.around import fused_again
from padstudio.flights.bundles.contents import Alone, Bundle, Reading, Record, versions
from padstudio.flights.bundles.members import BundleError
from padstudio.flights.tasks.detectors import Recipe
from padstudio.flights.tasks.frames import with_covariance
from padstudio.flights.tuning.bench import detector_of
from padstudio.vision.dense.tracker import Expectation
from padstudio.vision.stage.detection import Detection

# Times differ with every run; names of files and sizes of frames are no results.
_TIMES = ("elapsed_ms", "source", "frame", "time_s", "damaged", "covariance", "frame_px")
# Sums run in another order where memory lies otherwise: of figures that follow from the same frame
# 1e-8 was seen, by far less than they are good to.
_ROUNDING = 1e-6
# More are cut off: they say no more.
_MOST_DIFFERENCES = 200


def read_frame(
    recipe: Recipe, frame: Image | YuvFrame, reading: Reading, expected: Expectation | None
) -> tuple[Detection, list[Record]]:
    """Read a frame as a bundle says; with its stages, as a bundle's trace has them.

    A still is looked at in full, with all reasons of a failure; a run's frame as in a flight, and
    once more for its stages: a trace wants pictures, which are made otherwise of a video's planes,
    and the pose's last digits are others then.
    """
    detector = detector_of(recipe)
    if reading == "run":
        traced = detector.next_in_video(frame, expected, trace=True)
        return detector.next_in_video(frame, expected), _stages_of(traced)
    bgr = frame.bgr if isinstance(frame, YuvFrame) else frame
    found = detector.detect(bgr, trace=True, reasons=True)
    return found, _stages_of(found)


def _stages_of(detection: Detection) -> list[Record]:
    trace = detection.trace
    assert trace is not None
    return [
        {
            "name": record.name,
            "channel": record.channel,
            "elapsed_ms": round(record.elapsed_ms, 3),
            "failure": None
            if record.failure is None
            else {"reason": str(record.failure.reason), "detail": record.failure.detail},
        }
        for record in trace.records
    ]


def replay(bundle: Bundle) -> Record:
    """Read a bundle's frame again, and say what is otherwise.

    Returns
    -------
    dict
        ``same``: nothing is. ``differences`` (``field``, ``then``, ``now``) of the result and of
        the stages; ``recorded_differences``, of what the flight's run recorded;
        ``alone_differences``, of what the frame alone gave; ``versions`` (``name``, ``then``,
        ``now``) that differ; ``result``, ``recorded`` and ``alone`` (or None), as they are now.

    Raises
    ------
    BundleError
        If the frames around cannot be fused.
    """
    source = str(bundle.result.get("source", ""))
    found, stages = read_frame(bundle.recipe, bundle.frame, bundle.reading, bundle.expected)
    result = plain(found.to_record(source))
    then, now = _stage_fields(bundle.trace), _stage_fields(stages)
    differences = [*differing(bundle.result, result), *_differing(then, now, "stages")]
    recorded = None if bundle.recorded is None else _recorded_now(bundle, found, source)
    alone = None if bundle.alone is None else read_alone(bundle, bundle.alone, source)
    of_run = differing(bundle.recorded, recorded) if bundle.recorded and recorded else []
    by_itself = differing(bundle.alone.result, alone) if bundle.alone and alone else []
    return {
        "same": not (differences or of_run or by_itself),
        "differences": differences[:_MOST_DIFFERENCES],
        "recorded_differences": of_run[:_MOST_DIFFERENCES],
        "alone_differences": by_itself[:_MOST_DIFFERENCES],
        "versions": _other_versions(bundle.versions),
        "result": result,
        "recorded": recorded,
        "alone": alone,
    }


def _recorded_now(bundle: Bundle, found: Detection, source: str) -> Record:
    """What a run would record of the frame now: its own pose, or that fused with those around."""
    if bundle.around is None:
        return plain(found.to_record(source))
    try:
        return plain(fused_again(bundle.around, plain(with_covariance(found, source))))
    except (ValueError, ArithmeticError) as error:
        raise BundleError(
            f"the bundle's frames around cannot be fused ({error}); make the bundle again"
        ) from error


def read_alone(bundle: Bundle, alone: Alone, source: str) -> Record:
    """The record of a run's frame by itself, as the workbench reads it."""
    recipe = replace(bundle.recipe, method=alone.method, params=alone.params)
    found, _ = read_frame(recipe, bundle.frame, "still", None)
    return plain(found.to_record(source))


def _other_versions(then: Mapping[str, str]) -> list[Record]:
    here = versions()
    return [
        {"name": name, "then": then.get(name), "now": here.get(name)}
        for name in sorted({*here, *then})
        if then.get(name) != here.get(name)
    ]


def differing(then: Mapping[str, Any], now: Mapping[str, Any]) -> list[Record]:
    """Fields of two results that differ by more than rounding, times left out; with both values."""
    before, after = ({k: v for k, v in each.items() if k not in _TIMES} for each in (then, now))
    return list(_differing(before, after, ""))


def _differing(then: Any, now: Any, place: str) -> Iterator[Record]:
    if isinstance(then, dict) and isinstance(now, dict):
        for key in sorted({*then, *now}):
            name = f"{place}.{key}" if place else str(key)
            yield from _differing(then.get(key), now.get(key), name)
    elif isinstance(then, list) and isinstance(now, list) and len(then) == len(now):
        for i, pair in enumerate(zip(then, now, strict=True)):
            yield from _differing(*pair, f"{place}[{i}]")
    elif then != now and not _is_rounding(then, now):
        yield {"field": place, "then": then, "now": now}


def _is_rounding(then: Any, now: Any) -> bool:
    """Whether two figures are the same but for their last digits."""
    if not (isinstance(then, float) and isinstance(now, float)):
        return False
    return math.isclose(then, now, rel_tol=_ROUNDING, abs_tol=_ROUNDING)


def _stage_fields(stages: Sequence[Mapping[str, Any]]) -> Record:
    """How often each stage ran, and how it ended."""
    found: Record = {}
    for stage in stages:
        name = "-".join(filter(None, (stage.get("channel"), str(stage.get("name")))))
        runs = found.get(name, {"runs": 0})["runs"]
        found[name] = {"runs": runs + 1, "failure": stage.get("failure")}
    return found


def plain(record: Record) -> Record:
    """A record as it is after JSON, so that it compares with one that was written."""
    plain: Record = _without_nan(json.loads(json.dumps(record)))
    return plain


def _without_nan(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_nan(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_without_nan(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
