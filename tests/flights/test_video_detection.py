"""Frames as videos hold them, compressed and with colours at half scale, are read and followed."""

from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.media.video_frames import read_frames
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import FlightSpec, Setup, plan
from padstudio.simulate.video_writer import Codec, VideoWriter
from padstudio.vision.detector import Detector
from padstudio.vision.stage.detection import Detection

CAMERA = Camera(640, 480, np.array([[440.0, 0, 319.5], [0, 440.0, 239.5], [0, 0, 1]]))
FRAMES = 10


def pad() -> Pad:
    rng = np.random.default_rng(11)
    fine, coarse = (rng.integers(0, 2, (n, n)).astype(np.uint8) for n in (60, 12))
    return Pad((Layer("red", 10.0, fine), Layer("blue", 50.0, coarse)))


def filmed(path: Path, codec: Codec, from_mm: float, quality: int) -> tuple[list[int], list[Pose]]:
    """A landing's video: its timestamps and the true poses."""
    flight = plan(
        FlightSpec(kind="landing", frames=FRAMES, from_mm=from_mm, to_mm=0.6 * from_mm, seed=3)
    )
    setup = Setup(scene=Scene(pad=pad()), camera=CAMERA, imaging=Imaging(exposure_ms=1.0), seed=3)
    poses = []
    with VideoWriter(path, width=640, height=480, fps=30.0, codec=codec, quality=quality) as video:
        for shot in flight.frames(setup):
            video.write(shot.image)
            poses.append(shot.truth.pose)
    with av.open(str(path)) as container:
        packets = container.demux(video=0)
        return sorted(packet.pts for packet in packets if packet.pts is not None), poses


def errors(found: list[Detection], poses: list[Pose]) -> list[float]:
    """Percent of the height."""
    off = []
    for detection, true in zip(found, poses, strict=True):
        assert detection.pose is not None, detection.failure
        away = np.linalg.norm(detection.pose.position_mm - true.position_mm)
        off.append(100 * float(away / true.position_mm[2]))
    return off


@pytest.mark.parametrize("codec", ["h264", "h265"])
@pytest.mark.parametrize("from_mm", [250.0, 1100.0])
def test_compressed_frames_are_read_and_followed(
    codec: Codec, from_mm: float, tmp_path: Path
) -> None:
    path = tmp_path / "landing.mp4"
    timestamps, poses = filmed(path, codec, from_mm, quality=28)
    detector = Detector(pad(), CAMERA)
    pictures = list(read_frames(str(path), timestamps))
    frames = [picture.frame for picture in pictures if picture.frame is not None]
    assert len(frames) == FRAMES
    followed = errors(list(detector.track(frames)), poses)
    single = errors([detector.detect(frame) for frame in frames], poses)
    assert max(followed) < 0.6
    assert max(single) < 1.0
    assert np.median(followed) < 0.2
