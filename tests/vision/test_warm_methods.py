"""After warming nothing is left to be made ready for a frame, whatever it shows."""

from pathlib import Path

import cv2
import pytest

from padstudio import Camera, Detector, Pad
from padstudio.compiled import watch_preparing
from padstudio.vision import warm


@pytest.mark.parametrize("method", ["dense", "paper"])
@pytest.mark.parametrize("name", ["height_450mm", "height_3500mm", "another_pad"])
def test_no_loop_is_left_to_be_made_ready(method: str, name: str) -> None:
    warm.warm_up()
    told: list[bool] = []
    watch_preparing(told.append)
    samples = Path(__file__).parents[2] / "samples"
    detector = Detector(
        Pad.load(samples / "pad.json"), Camera.load(samples / "camera.yaml"), method=method
    )
    detector.detect(cv2.imread(str(samples / f"{name}.jpg")))
    assert told == []
