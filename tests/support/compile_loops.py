"""Compiles loops that tests need beside those that an installation compiles ahead.

Each of the suite's processes would otherwise compile them when it first meets them, side by side.
"""

from __future__ import annotations

import numpy as np
from places import FOOTAGE

from padstudio import Camera, Detector, Pad
from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render

CAMERA = Camera(640, 480, np.array([[440.0, 0, 319.5], [0, 440.0, 239.5], [0, 0, 1]]))


def main() -> None:
    pad = Pad.load(FOOTAGE / "pad_a.json")
    seen = render(Scene(pad=pad, ground="asphalt"), CAMERA, look_at_pad(900.0), seed=1).image
    unknown = np.random.default_rng(1).integers(0, 255, seen.shape).astype(np.uint8)
    for method in ("dense", "paper"):
        detector = Detector(pad, CAMERA, method=method)
        for frame in (seen, unknown, seen[::-1].copy()):
            detector.detect(frame)


if __name__ == "__main__":
    main()
