"""The topic that is meant and the camera beside it; what is beyond a limit."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import cv2
import lz4.frame
import numpy as np
import pytest
import recordings as made
import videos
import zstandard
from mcap.writer import Writer as McapWriter
from recordings import INFO, ROS2, TOPIC, Scene
from rosbags.rosbag2 import Writer

from padstudio.errors import CameraFormatError, LimitError, SpecError
from padstudio.flights.exports.forms import export
from padstudio.flights.exports.options import ExportOptions
from padstudio.geometry.camera import Camera
from padstudio.media.content import ContentError
from padstudio.media.recordings import storage, unpacking
from padstudio.media.recordings.folders import members_of
from padstudio.media.recordings.frames import read_frames
from padstudio.media.recordings.index import read_index
from padstudio.media.recordings.storage import RecordingError
from padstudio.media.recordings.topics import Look, camera_of, look
from padstudio.media.zip_stills import ZipLimits

MATRIX = np.array([[210.5, 0, 95.25], [0, 211.0, 63.5], [0, 0, 1]])
CAMERA = Camera(videos.WIDTH, videos.HEIGHT, MATRIX, [-0.2, 0.05, 0.001, -0.0005, 0.0])
SIDES = ("/left/image_raw/compressed", "/right/image_raw")


def _scene(**more: Any) -> Scene:
    return Scene(made.shots(2), kind="compressed", **more)


@pytest.mark.parametrize("kind", ["bag1", "bag2"])
def test_the_recorded_calibration_is_the_camera(kind: str, tmp_path: Path) -> None:
    scene = _scene(camera=CAMERA)
    write = made.write_bag1 if kind == "bag1" else made.write_bag2
    found = look(str(write(tmp_path / f"a.{kind}", scene)))
    assert (found.topic, found.topics) == (TOPIC, (TOPIC,))
    camera = Camera.loads(found.camera or "")
    assert (camera.width, camera.height, camera.model) == (CAMERA.width, CAMERA.height, "radtan")
    assert np.array_equal(camera.matrix, MATRIX)
    points = np.random.default_rng(1).uniform([-0.3, -0.2, 1], [0.3, 0.2, 2], (100, 3))
    assert np.abs(camera.project(points) - CAMERA.project(points)).max() < 1e-9


def _write_info(folder: Path, topic: str, info: str, **changed: Any) -> Path:
    """A bag of a picture and a calibration with changed fields."""
    types = ROS2.types
    stamp = types["builtin_interfaces/msg/Time"](1, 2)
    header = types["std_msgs/msg/Header"](stamp, "cam")
    names = ("header", "height", "width", "distortion_model", "d", "k", "r", "p")
    names += ("binning_x", "binning_y", "roi")
    fields = dict(zip(names, made.camera_info(CAMERA, header, types), strict=True)) | changed
    rows = made.encode(videos.picture(0), "bgr8")
    sides = (videos.HEIGHT, videos.WIDTH)
    image = types["sensor_msgs/msg/Image"](header, *sides, "bgr8", 0, rows.shape[1], rows.ravel())
    with Writer(folder, version=8) as writer:
        for name, kind, message in (
            (info, "sensor_msgs/msg/CameraInfo", types["sensor_msgs/msg/CameraInfo"](**fields)),
            (topic, "sensor_msgs/msg/Image", image),
        ):
            connection = writer.add_connection(name, kind, typestore=ROS2)
            writer.write(connection, 10, ROS2.serialize_cdr(message, kind))
    return folder


@pytest.mark.parametrize(
    ("topic", "info"),
    [
        ("/a/image_raw", "/a/camera_info"),
        ("/a/image_raw/compressed", "/a/camera_info"),
        ("/image", "/camera_info"),
        ("/a/image_raw", None),
    ],
)
def test_the_calibration_stands_beside_the_topic(
    topic: str, info: str | None, tmp_path: Path
) -> None:
    found = look(str(_write_info(tmp_path / "a", topic, info or "/b/camera_info")))
    assert (found.camera is not None) == (info is not None)
    if info is None:
        with pytest.raises(SpecError, match=f"no calibration beside {topic}"):
            camera_of([found])


def test_undistorted_pictures_have_the_projections_camera(tmp_path: Path) -> None:
    projection = np.array([200.0, 0, 90, 0, 0, 201, 60, 0, 0, 0, 1, 0])
    found = look(str(_write_info(tmp_path / "a", "/a/image_rect", "/a/camera_info", p=projection)))
    camera = Camera.loads(found.camera or "")
    assert np.array_equal(camera.matrix, projection.reshape(3, 4)[:, :3])
    assert not camera.distortion.any()


def test_a_region_of_the_sensor_and_joined_pixels_count(tmp_path: Path) -> None:
    kind = ROS2.types["sensor_msgs/msg/RegionOfInterest"]
    region = kind(x_offset=20, y_offset=40, height=60, width=100, do_rectify=False)
    path = _write_info(tmp_path / "a", TOPIC, INFO, roi=region, binning_x=2, binning_y=2)
    camera = Camera.loads(look(str(path)).camera or "")
    assert (camera.width, camera.height) == (50, 30)
    assert camera.matrix[0, 0] == pytest.approx(MATRIX[0, 0] / 2)
    # Pixel 0 of joined pairs lies between pixels 0 and 1.
    centre = [(95.25 - 20 - 0.5) / 2, (63.5 - 40 - 0.5) / 2]
    assert camera.matrix[:2, 2] == pytest.approx(centre)


def test_a_lens_model_that_is_not_known_is_refused(tmp_path: Path) -> None:
    path = _write_info(tmp_path / "a", TOPIC, INFO, distortion_model="thin_prism")
    with pytest.raises(CameraFormatError, match=f"on {INFO} cannot be used: .*thin_prism"):
        look(str(path))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"d": np.zeros(0)}, "holds no distortion coefficients; give a camera file$"),
        ({"k": np.zeros(9)}, "all 0: the camera was never calibrated; give a camera file$"),
    ],
)
def test_a_calibration_that_was_not_made_is_refused(
    fields: dict[str, Any], message: str, tmp_path: Path
) -> None:
    path = _write_info(tmp_path / "a", TOPIC, INFO, **fields)
    with pytest.raises(CameraFormatError, match=message):
        look(str(path))


def test_a_calibration_that_changes_is_told(tmp_path: Path) -> None:
    path = _write_info(tmp_path / "a", TOPIC, INFO)
    other_camera = Camera(CAMERA.width, CAMERA.height, MATRIX * [[2], [2], [1]])
    scene = Scene(made.shots(2), camera=other_camera)
    other = made.write_bag2(tmp_path / "b", scene)
    (path / "metadata.yaml").unlink()
    next(other.glob("*.db3")).rename(path / "b.db3")
    damage = read_index(str(path)).video.info.damage
    assert any("calibration beside /cam/image_raw changes on the way" in each for each in damage)


def test_one_of_several_topics_is_to_be_chosen(tmp_path: Path) -> None:
    path = str(made.write_mcap(tmp_path / "a.mcap", _scene(topics=SIDES)))
    with pytest.raises(
        RecordingError, match=r"2 topics with pictures: /left/\S+, /right"
    ) as caught:
        look(path)
    assert caught.value.error_code == "several_topics"
    assert caught.value.detail == {"topics": sorted(SIDES)}
    assert look(path, SIDES[1]).topic == SIDES[1]
    assert read_index(path, SIDES[0]).times.topic == SIDES[0]
    with pytest.raises(RecordingError, match="no pictures on '/up'; topics with pictures are"):
        look(path, "/up")


def test_recordings_must_agree_on_their_camera() -> None:
    looks = [Look(TOPIC, (TOPIC,), camera) for camera in ("one", "another")]
    assert camera_of(looks[:1] * 2) == "one"
    with pytest.raises(SpecError, match="different calibrations"):
        camera_of(looks)
    with pytest.raises(SpecError, match="give the camera"):
        camera_of([])


def test_a_recording_without_pictures_names_what_it_has(tmp_path: Path) -> None:
    with Writer(tmp_path / "a", version=8) as writer:
        writer.add_connection("/scan", "sensor_msgs/msg/LaserScan", typestore=ROS2)
    with pytest.raises(RecordingError, match=r"/scan \(sensor_msgs/msg/LaserScan\)") as caught:
        look(str(tmp_path / "a"))
    assert caught.value.error_code == "no_pictures"


@pytest.mark.parametrize("kind", ["bag1", "bag2", "mcap"])
def test_messages_beyond_the_limit(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(storage, "MAX_MESSAGE_BYTES", 1000)
    write = {"bag1": made.write_bag1, "bag2": made.write_bag2, "mcap": made.write_mcap}[kind]
    path = write(tmp_path / f"a.{kind}", Scene(made.shots(2)))
    with pytest.raises(LimitError, match=r"a message of 0 MB; the limit is 0\.001 MB"):
        read_index(str(path))


@pytest.mark.parametrize("kind", ["zstd", "lz4", "bz2"])
def test_nothing_unpacks_to_more_than_a_limit(kind: str) -> None:
    import bz2

    data = bytes(20_000_000)
    pack = {"zstd": zstandard.compress, "lz4": lz4.frame.compress, "bz2": bz2.compress}[kind]
    packed = pack(data)
    assert unpacking.unpack(packed, kind, len(data)) == data
    with pytest.raises(unpacking.UnpackError, match=r"more than 10 MB"):
        unpacking.unpack(packed, kind, 10_000_000)
    with pytest.raises(unpacking.UnpackError):
        unpacking.unpack(b"?" * 40, kind, 1000)


def _zip(names: list[str], data: bytes = b"x") -> io.BytesIO:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            archive.writestr(name, data)
    return file


def test_a_zip_holds_one_recording(tmp_path: Path) -> None:
    path = tmp_path / "a.zip"
    for names, expected in (
        (["a/metadata.yaml", "a/a_0.db3", "a/a_1.db3"], ["a/a_0.db3", "a/a_1.db3"]),
        (["a/1.jpg", "__MACOSX/a.bag"], []),
    ):
        path.write_bytes(_zip(names).getvalue())
        assert members_of(path, ZipLimits()) == expected
    for names in (["a.bag", "b.bag"], ["a/a.db3", "b/b.db3"]):
        path.write_bytes(_zip(names).getvalue())
        with pytest.raises(ContentError, match="upload each by itself"):
            members_of(path, ZipLimits())
    path.write_bytes(_zip(["a.bag"], bytes(10_000_000)).getvalue())
    with pytest.raises(LimitError, match="which pictures do not"):
        members_of(path, ZipLimits())


@pytest.mark.parametrize("model", ["radtan", "fisheye"])
def test_our_own_recordings_are_read_back(model: Any, tmp_path: Path) -> None:
    distortion = [-0.03, 0.008, -0.004, 0.0006] if model == "fisheye" else [-0.2, 0.05, 0, 0, 0]
    camera = Camera(videos.WIDTH, videos.HEIGHT, MATRIX, distortion, model=model)
    failed = {"status": "failed", "stage": "lines", "reason": "no_lattice", "source": "a"}
    size = {"frame_px": [videos.WIDTH, videos.HEIGHT]}
    records = [failed | size | {"frame": n, "time_s": n / 25} for n in range(3)]
    options = ExportOptions(
        camera=camera,
        picture=lambda record: bytes(cv2.imencode(".png", videos.picture(record["frame"]))[1]),
        start_unix_s=1_750_000_000.0,
    )
    path = tmp_path / "a.mcap"
    path.write_bytes(b"".join(export("mcap", records, options)))
    found = look(str(path))
    assert found.topic == "/camera/image"
    again = Camera.loads(found.camera or "")
    assert (again.model, again.matrix.tolist()) == (model, MATRIX.tolist())
    assert again.distortion[:4].tolist() == distortion[:4]
    index = read_index(str(path))
    assert index.video.pts.tolist() == [1_750_000_000 * 10**9 + n * 40_000_000 for n in range(3)]
    pictures = read_frames(str(path), index.video.pts.tolist(), index.times)
    assert [videos.number_of(p.bgr) for p in pictures if p.bgr is not None] == [0, 1, 2]


def test_messages_of_ros_1_in_mcap(tmp_path: Path) -> None:
    shots = made.shots(3)
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile="ros1", library="test")
        schema = writer.register_schema("sensor_msgs/Image", "ros1msg", b"")
        channel = writer.register_channel(TOPIC, "ros1", schema)
        for log_ns, _, name, message in made.ros_messages(Scene(shots), made.ROS1, is_ros1=True):
            data = bytes(made.ROS1.serialize_ros1(message, name))
            writer.add_message(channel, log_ns, data, log_ns)
        writer.finish()
    index = read_index(str(path))
    assert index.video.pts.tolist() == [shot.stamp_ns for shot in shots]
    assert index.video.info.pixel_format == "bgr8"
