"""Latencies against the times that went in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.live.latency import LatencyMeter, StageTimes
from padstudio.live.reports.frame import LiveFrame
from padstudio.live.reports.report import LiveReport
from padstudio.vision.stage.detection import Detection

times = st.lists(st.floats(0.01, 5e4), min_size=1, max_size=60)


@given(times, st.sampled_from([50, 95]))
def test_percentiles_of_the_window_are_exact_and_those_of_all_true_to_a_percent(times, percent):
    stage = StageTimes(window=10)
    for elapsed in times:
        stage.add(elapsed)
    assert stage.recent_ms(percent) == pytest.approx(np.percentile(times[-10:], percent))
    # The histogram gives one of the times, as a percentile without interpolation does.
    exact = np.percentile(times, percent, method="inverted_cdf")
    assert stage.all_ms(percent) == pytest.approx(exact, rel=0.011)
    assert stage.count == len(times)


def test_nothing_has_no_percentiles_and_clocks_that_disagree_count_as_nought():
    stage = StageTimes()
    assert stage.recent_ms(50) is None
    assert stage.all_ms(50) is None
    stage.add(-3.0)
    assert stage.recent_ms(50) == 0.0
    stage.add(1e12)
    assert stage.count == 2


def test_stages_go_from_moment_to_moment():
    meter = LatencyMeter()
    picture = np.zeros((16, 16, 3), np.uint8)
    for number, captured_s in enumerate((None, 9.9)):
        frame = LiveFrame(number, picture, 0.0, 10.0, 10.002, captured_s)
        meter.add(LiveReport(frame, Detection(None), 10.010), 10.011)
    found = {name: stage["median_ms"] for name, stage in meter.to_dict().items()}
    assert found == pytest.approx(
        {
            "captured_to_arrived": 100.0,
            "captured_to_sent": 111.0,
            "arrived_to_decoded": 2.0,
            "decoded_to_posed": 8.0,
            "posed_to_sent": 1.0,
            "decoded_to_sent": 9.0,
            "arrived_to_sent": 11.0,
        },
        abs=1e-3,
    )
    assert meter.to_dict()["captured_to_arrived"]["frames"] == 1
