#!/usr/bin/env python3
"""Simulated video beside independent video of the same poses and movements.

    bench_simulate_video.py [--footage FOLDER] [--places N] [--png FOLDER]

For some places of each flight of a folder (by default tests/footage) 24 frames are simulated from
the true poses, with velocities from the poses round them, and encoded as the flight is. Four in the
middle are compared, after decoding both, as encoders look ahead and keep noise from frame to frame:
brightness; largest difference of a cell kind's median
colour (of 255) at equal brightness; ratios, simulated over footage, of the noise within cells, the
gradient at cell edges and the bytes a frame. The camera's exposure and readout are not in the
footage: 4 and 12 ms let the pictures lie over each other best. `--png` keeps pairs of pictures.
"""

from __future__ import annotations

import argparse
import json
import statistics
import tempfile
from pathlib import Path

import av
import cv2
import numpy as np
from bench_simulate import FOOTAGE, cell_kinds, figures

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.spec import Pad
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.video_writer import VideoWriter

CAMERA = Imaging(jpeg_quality=None, exposure_ms=4.0, readout_ms=12.0)
CODECS = {"h264": "h264", "hevc": "h265"}
FRAMES, COMPARED, QUIET_MM = 24, range(12, 16), 40.0


def pose_of(record):
    """The true pose of a frame."""
    return Pose(np.array(record["position_mm"]), np.array(record["rotation"]))


def motion_at(records, number, fps):
    """Velocities at a frame, by central differences of the poses before and after."""
    before, after = records[max(number - 1, 0)], records[min(number + 1, len(records) - 1)]
    seconds = (after["frame"] - before["frame"]) / fps
    velocity = np.subtract(after["position_mm"], before["position_mm"]) / seconds
    turned = np.array(before["rotation"]).T @ np.array(after["rotation"])
    rate = np.degrees(cv2.Rodrigues(turned)[0].ravel()) / seconds
    return Motion(velocity_mm_s=tuple(velocity.tolist()), angular_deg_s=tuple(rate.tolist()))


def read(path, numbers):
    """Codec, frames (BGR) of some numbers, and bytes of every frame of a video."""
    with av.open(str(path)) as container:
        codec = container.streams.video[0].codec_context.name
        frames = {
            number: frame.to_ndarray(format="bgr24")
            for number, frame in enumerate(container.decode(video=0))
            if number in numbers
        }
    with av.open(str(path)) as container:
        sizes = [packet.size for packet in container.demux(video=0) if packet.size]
    return codec, frames, sizes


def simulated(path, pad, camera, records, first, fps, codec):
    """Frames of a simulated video, and their bytes."""
    with VideoWriter(path, width=camera.width, height=camera.height, fps=fps, codec=codec) as out:
        for number in range(first, first + FRAMES):
            frame = render(
                Scene(pad=pad, quiet_mm=QUIET_MM),
                camera,
                pose_of(records[number]),
                CAMERA,
                number,
                motion=motion_at(records, number, fps),
            )
            out.write(frame.image)
    _, frames, sizes = read(path, range(FRAMES))
    return frames, sizes


def differences(theirs, ours, kinds):
    """Brightness, colour at equal brightness, noise and edges of one frame against another."""
    theirs, ours = figures(theirs, kinds), figures(ours, kinds)
    gain = np.nansum(ours[0]) / np.nansum(theirs[0])
    color = np.nanmax(np.abs(ours[0] / gain - theirs[0]))
    return gain, color, np.nanmean(ours[1] / theirs[1]), ours[2] / theirs[2]


def compare(flight, pad, places, png):
    """Print a line for each of some places of a flight."""
    head = json.loads(flight.with_suffix(".truth.json").read_text())
    records, fps = head["frames"], head["fps"]
    camera = Camera.load(flight.parents[1] / head["camera"])
    # From above the middle of the flight cells are too small to measure noise within.
    middle, last = len(records) // 3, len(records) - FRAMES
    starts = [round(at) for at in np.linspace(middle, last, places)]
    wanted = {start + k for start in starts for k in range(FRAMES)}
    codec, theirs, sizes = read(flight, wanted)
    for start in starts:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "simulated.mp4"
            ours, our_sizes = simulated(path, pad, camera, records, start, fps, CODECS[codec])
        found = []
        for k in COMPARED:
            kinds = cell_kinds(pad, camera, pose_of(records[start + k]))
            found.append(differences(theirs[start + k], ours[k], kinds))
        # From the fifth on, so that a key frame of only one of both does not count.
        size = statistics.mean(our_sizes[4:20]) / statistics.mean(sizes[start + 4 : start + 20])
        gain, color, noise, edges = np.mean(found, axis=0)
        print(
            f"{flight.stem:20} {start:5} {records[start]['position_mm'][2]:6.0f} mm {gain:10.3f} "
            f"{color:6.1f} {noise:6.3f} {edges:6.3f} {size:6.2f}"
        )
        if png:
            pair = np.hstack([theirs[start + COMPARED[-1]], ours[COMPARED[-1]]])
            cv2.imwrite(str(png / f"{flight.stem}-{start}.png"), pair)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--footage", type=Path, default=FOOTAGE)
    parser.add_argument("--places", type=int, default=4)
    parser.add_argument("--png", type=Path)
    options = parser.parse_args()
    pad = Pad.load(options.footage / "pad_a.json")
    print("flight               frame    height brightness colour  noise  edges  bytes")
    for flight in sorted((options.footage / "flights").glob("*.mp4")):
        compare(flight, pad, options.places, options.png)


if __name__ == "__main__":
    main()
