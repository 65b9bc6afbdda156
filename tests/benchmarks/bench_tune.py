"""How soon a slider of the workbench has its effect: processor time in a worker.

For each slider a frame is read twenty times under values that lie close together, as a drag asks
for them: the detection with what earlier runs left, the picture of the stage that is looked at,
painted, encoded and written as JSON. The way to the page and back is not in it.

    make bench ARGS="tune --flight landing_2k7.mp4 --camera camera.yaml --pad pad.json"
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

import av
import cv2
import numpy as np

from padstudio.flights.tasks.detectors import Recipe
from padstudio.flights.tuning import bench, looks
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad

# Each beside the stage that is looked at while it is moved, and from where to where.
SLIDERS = {
    "dense": (
        ("search.least_step", "edges", 0.5, 1.0),
        ("search.least_order", "grid", 0.4, 0.6),
        ("search.most_tries", "lines", 4, 24),
        ("outline.least_side_px", "outline", 20, 60),
        ("refine.reach_px", "pose", 4.0, 9.0),
        ("refine.most_residual_cells", "pose", 0.1, 0.3),
        ("log10_false_alarm", "decode", -12, -3),
    ),
    "paper": (
        ("paper.blocks", "block_mean", 2, 22),
        ("paper.speck_px", "clean", 1, 21),
        ("paper.hough_votes", "lines", 10, 40),
        ("paper.most_off_cells", "pose", 0.2, 0.6),
    ),
}
_STEPS, _SCALE = 20, 0.45
FOOTAGE = Path(__file__).resolve().parents[1] / "footage"


def frame_of(video: Path, number: int) -> np.ndarray:
    """A frame of a video, BGR."""
    with av.open(str(video)) as container:
        for k, picture in enumerate(container.decode(video=0)):
            if k == number:
                return picture.to_ndarray(format="bgr24")
    raise SystemExit(f"{video} has no frame {number}")


def covered(frame: np.ndarray) -> np.ndarray:
    """The frame with most of the pad under coloured clutter: nothing is found."""
    height, width = frame.shape[:2]
    noise = np.random.default_rng(1).integers(
        0, 255, (height // 8 + 1, width // 8 + 1, 3), np.uint8
    )
    out = frame.copy()
    out[height // 6 :] = cv2.resize(noise, (width, height))[height // 6 :]
    return out


def drag(
    recipe: Recipe, subject: bench.Subject, slider: tuple[str, str, float, float]
) -> np.ndarray:
    """Processor times of the steps of one drag, ms, the first one left out."""
    name, stage, low, high = slider
    channel = None if stage in ("pose", "outline", "choose") else "red"
    view = looks.View(stage, channel, _SCALE, quick=True)
    times = []
    for value in np.linspace(low, high, _STEPS + 1):
        *group, own = name.split(".")
        number = int(value) if isinstance(low, int) else float(value)
        params = {group[0]: {own: number}} if group else {own: number}
        one = Recipe(recipe.pad, recipe.camera, recipe.method, json.dumps(params))
        begin = time.process_time()
        looks.look_json(subject, one, [view], "frame")
        times.append(1e3 * (time.process_time() - begin))
    return np.array(times[1:])


def main(arguments: list[str] | None = None) -> None:
    """Print a line a frame and slider."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--flight", type=Path, default=FOOTAGE / "flights" / "landing.mp4")
    parser.add_argument("--pad", type=Path, default=FOOTAGE / "pad_a.json")
    parser.add_argument("--camera", default=str(FOOTAGE / "camera_drone_2k7.yaml"))
    parser.add_argument("--frame", type=int, action="append", help="of the video; again for more")
    parser.add_argument("--methods", default="dense,paper")
    wanted = parser.parse_args(arguments)
    pad, camera = Pad.load(wanted.pad).dumps(), Camera.load(wanted.camera).to_ros_yaml()
    frames = {f"frame {n}": frame_of(wanted.flight, n) for n in wanted.frame or [0, 20]}
    frames["covered"] = covered(next(iter(frames.values())))
    print(f"{'frame':12}{'method':8}{'parameter':28}{'median ms':>10}{'95 % ms':>9}")
    with tempfile.TemporaryDirectory() as folder:
        for name, image in frames.items():
            place = Path(folder) / f"{name}.png"
            cv2.imwrite(str(place), image)
            subject = bench.Subject(name, place, 50_000_000)
            for method in wanted.methods.split(","):
                for slider in SLIDERS[method]:
                    took = drag(Recipe(pad, camera, method), subject, slider)
                    middle, worst = np.percentile(took, [50, 95])
                    print(
                        f"{name:12}{method:8}{slider[0]:28}{middle:10.0f}{worst:9.0f}", flush=True
                    )


if __name__ == "__main__":
    main(sys.argv[1:])
