"""What a memo gives is what would be computed, whatever parameter changed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from paper_frames import frame_of, sample_pad, small_camera

from padstudio.flights.tasks.detectors import params_from
from padstudio.geometry.pose import look_at_pad
from padstudio.vision.detector import Detector
from padstudio.vision.stage.memo import Memo, key_of
from padstudio.vision.stage.parameter import Parameter, parameters_of
from padstudio.vision.stage.params import DetectorParams, SearchParams
from padstudio.vision.stage.trace import Recorder

FRAME = frame_of(look_at_pad(700.0, tilt_deg=12, heading_deg=40), camera=small_camera())


def changed(item: Parameter) -> DetectorParams:
    """The parameters with one moved far off its default."""
    value = (
        not item.default
        if item.kind == "bool"
        else item.low
        if item.default > (item.low + item.high) / 2
        else item.default * 1.7 + 0.1
    )
    *group, name = item.name.split(".")
    values = {name: int(value) if item.kind == "int" else value}
    return params_from({group[0]: values} if group else values)


@pytest.mark.parametrize("method", ["dense", "paper"])
def test_each_parameter_has_its_effect(method):
    usual = Detector(sample_pad(), small_camera(), method=method)
    memo = Memo()
    usual.detect(FRAME, trace=True, memo=memo)
    for item in parameters_of(DetectorParams()):
        if method not in item.scope.methods:
            continue
        detector = usual.with_params(changed(item))
        found, fresh = (detector.detect(FRAME, trace=True, memo=m) for m in (memo, None))
        assert [(r.name, r.channel, type(r.output)) for r in found.trace.records] == [
            (r.name, r.channel, type(r.output)) for r in fresh.trace.records
        ], item.name
        assert found.failure == fresh.failure, item.name
        assert found.cells_read == fresh.cells_read, item.name
        if fresh.pose is not None:
            assert np.allclose(found.pose.position_mm, fresh.pose.position_mm), item.name


def test_a_stage_runs_again_only_where_its_inputs_changed():
    calls = []

    def stage(values, params):
        calls.append(params)
        return values.sum()

    memo, large = Memo(), np.ones(5000)
    for params in (SearchParams(), SearchParams(least_order=0.9), SearchParams(least_step=2.0)):
        memo.begin()
        recorder = Recorder(keep=True, memo=memo)
        assert recorder.run("edges", "red", stage, large, params) == 5000
        assert len(recorder.trace(FRAME).records) == 1
    assert [params.least_step for params in calls] == [0.6, 2.0]


def test_large_inputs_are_known_by_identity_and_small_ones_by_value():
    small, large = np.arange(3), np.ones(5000)
    assert key_of("edges", len, (small,)) == key_of("edges", len, (small.copy(),))
    assert key_of("edges", len, (large,)) != key_of("edges", len, (large.copy(),))


def test_what_the_last_runs_did_not_ask_for_is_dropped():
    @dataclass(frozen=True)
    class Input:
        number: int

    memo = Memo()
    for number in (1, 2, 2, 2, 2, 2):
        memo.begin()
        Recorder(keep=False, memo=memo).run("edges", None, id, Input(number))
    assert memo.find(key_of("edges", id, ((Input(2),), {}))) is not None
    assert memo.find(key_of("edges", id, ((Input(1),), {}))) is None
