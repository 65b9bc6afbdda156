from __future__ import annotations

import math

import numpy as np
import pytest

from padstudio.autopilot.vehicle import VehicleTrack
from padstudio.errors import SpecError
from padstudio.media.telemetry.vehicle_table import COLUMNS

HEADER = ",".join(COLUMNS)


def test_a_track_between_its_poses() -> None:
    turned = [math.cos(0.05), 0, 0, math.sin(0.05)]
    rows = [[0, 0, 0, -2, 1, 0, 0, 0], [0.2, 1, 2, -4, *[-value for value in turned]]]
    lines = [HEADER, "# notes", *(",".join(map(str, row)) for row in rows)]
    track = VehicleTrack.from_csv(lines)
    found = track.at(0.1)
    assert found is not None
    position, rotation = found
    assert position == pytest.approx([0.5, 1, -3])
    assert math.atan2(rotation[1, 0], rotation[0, 0]) == pytest.approx(0.05, abs=1e-9)
    assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=1e-12)
    assert track.at(0.0) is not None
    assert track.at(0.2) is not None
    assert track.at(-0.01) is None
    assert track.at(0.21) is None


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (["time_s,north_m,east_m,down_m,qw,qx,qy"], "lacks the columns qz"),
        ([], "lacks the columns"),
        ([HEADER, "0,0,0,0,1,0,0,0"], "two poses or more"),
        ([HEADER, "0,0,0,0,1,0,0,0", "0,0,0,0,1,0,0,0"], "rising times"),
        ([HEADER, "0,0,0,0,1,0,0,0", "1,0,0,0,0,0,0,0"], "unit"),
        ([HEADER, "0,0,0,nan,1,0,0,0", "1,0,0,0,1,0,0,0"], "finite"),
        ([HEADER, "0,0,0,x,1,0,0,0"], "line 2 .* no number"),
        ([HEADER, "0,0,0"], "line 2 .* no number"),
    ],
)
def test_ill_formed_tracks_are_refused(lines: list[str], said: str) -> None:
    with pytest.raises(SpecError, match=said) as caught:
        VehicleTrack.from_csv(lines)
    assert caught.value.error_code == "invalid_vehicle_track"
