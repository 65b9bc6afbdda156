"""MCAP files, read back by the reference reader."""

from __future__ import annotations

import base64
import io
import json
from collections import defaultdict
from typing import Any

import cv2
import numpy as np
import pytest
from export_records import CAMERA, FAILED_AT, PAD_SIZE_MM, POSES, records, rotation, times
from mcap.reader import make_reader

from padstudio.flights.exports.forms import export
from padstudio.flights.exports.mcap_log import TOPICS, outline
from padstudio.flights.exports.options import ExportOptions
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad

JPEG = cv2.imencode(".jpg", np.zeros((480, 640, 3), np.uint8))[1].tobytes()


def _check(schema: dict[str, Any], value: Any) -> None:
    """The parts of JSON Schema that these schemas use."""
    kinds = {"object": dict, "array": list, "string": str, "integer": int, "number": (int, float)}
    assert isinstance(value, kinds[schema["type"]])
    if schema["type"] == "object":
        assert set(schema["required"]) <= set(value) <= set(schema["properties"])
        for name, part in value.items():
            _check(schema["properties"][name], part)
    if schema["type"] == "array":
        assert schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value))
        for item in value:
            _check(schema["items"], item)


def _read(bearing_at: tuple[int, ...] = (), **options: Any) -> dict[str, list[tuple[int, Any]]]:
    given = ExportOptions(camera=CAMERA, pad_size_mm=PAD_SIZE_MM, **options)
    reader = make_reader(io.BytesIO(b"".join(export("mcap", records(bearing_at), given))))
    topics = defaultdict(list)
    for schema, channel, message in reader.iter_messages():
        assert schema is not None
        assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
        assert schema.name == TOPICS[channel.topic]
        content = json.loads(message.data)
        described = json.loads(schema.data)
        assert described["title"] == schema.name
        _check(described, content)
        topics[channel.topic].append((message.log_time, content))
    return topics


def test_all_topics_are_there_at_their_times() -> None:
    read = _read(picture=lambda record: JPEG, start_unix_s=1_700_000_000.0)
    assert set(read) == set(TOPICS)
    for topic in ("/tf", "/camera/pose"):
        assert len(read[topic]) == len(POSES)
    for topic in ("/camera/image", "/camera/calibration", "/camera/annotations"):
        assert len(read[topic]) == len(records())
    for (log_ns, message), time_s in zip(read["/tf"], times(), strict=True):
        assert log_ns == 1_700_000_000 * 10**9 + round(time_s * 1e9)
        assert message["timestamp"] == {"sec": log_ns // 10**9, "nsec": log_ns % 10**9}


def test_images_are_the_pictures_given() -> None:
    pictures = {0: JPEG, 3: None}
    read = _read(picture=lambda record: pictures.get(record["frame"]))
    ((_, message),) = read["/camera/image"]
    assert base64.b64decode(message["data"]) == JPEG
    assert (message["format"], message["frame_id"]) == ("jpeg", "camera")


def test_poses_are_in_metres_in_the_pad_frame() -> None:
    read = _read()
    for (_, tf), (_, place), pose in zip(read["/tf"], read["/camera/pose"], POSES, strict=True):
        assert (tf["parent_frame_id"], tf["child_frame_id"]) == ("pad", "camera")
        assert place["frame_id"] == "pad"
        assert place["pose"] == {"position": tf["translation"], "orientation": tf["rotation"]}
        position = [tf["translation"][axis] * 1000 for axis in "xyz"]
        assert position == pytest.approx(pose.position_mm)
        turn = rotation([tf["rotation"][axis] for axis in "wxyz"])
        assert turn == pytest.approx(pose.rotation, abs=1e-9)


def test_a_pose_of_which_range_and_bearing_are_known_moves_no_transform() -> None:
    read = _read(bearing_at=(1,))
    assert len(read["/tf"]) == len(read["/camera/pose"]) == len(POSES) - 1
    found = [message for _, message in read["/camera/bearing"]]
    assert [message["quality"] for message in found] == ["full", "bearing", *["full"] * 3]
    for message, pose in zip(found, POSES, strict=True):
        x, y, z = (message["range"] * message["bearing"][axis] * 1000 for axis in "xyz")
        assert [x, y, z] == pytest.approx(pose.tvec_mm)
    assert found[1]["range_sigma"] == pytest.approx(1e-4)
    assert found[1]["bearing_sigma_deg"] < 0.02
    text = read["/camera/annotations"][1][1]["texts"][0]["text"]
    assert text == f"red, range {POSES[1].range_mm:.0f} mm, bearing only"


def test_the_convention_stands_in_the_file() -> None:
    data = b"".join(export("mcap", records(), ExportOptions(camera=CAMERA)))
    (metadata,) = make_reader(io.BytesIO(data)).iter_metadata()
    assert metadata.name == "padstudio.convention"
    assert "metres" in metadata.metadata["pad"]


@pytest.mark.parametrize(
    ("lens", "count", "name", "parameters"),
    [
        ("radtan", 0, "plumb_bob", 5),
        ("radtan", 4, "plumb_bob", 5),
        ("radtan", 5, "plumb_bob", 5),
        ("radtan", 8, "rational_polynomial", 8),
        ("fisheye", 4, "kannala_brandt", 4),
    ],
)
def test_calibrations(lens: Any, count: int, name: str, parameters: int) -> None:
    camera = Camera(640, 480, CAMERA.matrix, 0.01 * np.arange(1, count + 1), lens)
    data = b"".join(export("mcap", records(), ExportOptions(camera=camera)))
    reader = make_reader(io.BytesIO(data))
    _, _, message = next(iter(reader.iter_messages(topics=["/camera/calibration"])))
    found = json.loads(message.data)
    assert (found["distortion_model"], len(found["D"])) == (name, parameters)
    assert found["D"][:count] == camera.distortion.tolist()
    assert found["K"] == camera.matrix.ravel().tolist()
    assert (found["width"], found["height"]) == (640, 480)


def test_annotations_say_what_was_found() -> None:
    annotations = [message for _, message in _read()["/camera/annotations"]]
    assert annotations[0]["texts"][0]["text"] == "red, height 1200 mm"
    failed = annotations[FAILED_AT]
    assert failed["texts"][0]["text"] == "failed at lines: no_lattice"
    assert failed["points"] == []
    (line,) = annotations[0]["points"]
    points = {(round(p["x"] - 0.5, 6), round(p["y"] - 0.5, 6)) for p in line["points"]}
    corners = np.array([[-200, 150, 0], [200, 150, 0], [200, -150, 0], [-200, -150, 0]], float)
    seen = CAMERA.project((corners - POSES[0].position_mm) @ POSES[0].rotation)
    assert {(round(x, 6), round(y, 6)) for x, y in seen.tolist()} <= points


def test_an_outline_out_of_view_is_not_drawn() -> None:
    assert outline(look_at_pad(50.0), CAMERA, PAD_SIZE_MM).shape == (0, 2)
    partly = outline(look_at_pad(500.0, target_mm=(200, 0)), CAMERA, PAD_SIZE_MM)
    assert 0 < len(partly) < 2 * 64
    assert (np.abs(partly - (320, 240)) < (1.3 * 320, 1.3 * 240)).all()
