from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import fake_analysis
import httpx
import numpy as np
import pytest
from web_server import PRESET, PRESET_SIZE, running, settings_for, store_pad

DETECT = "/api/v1/detect"
Refused = Callable[..., dict[str, Any]]


def _send(
    client: httpx.Client,
    pad: str,
    content: bytes,
    *,
    name: str = "frame.png",
    camera: str = PRESET,
    **form: str,
) -> httpx.Response:
    return client.post(
        DETECT, files={"image": (name, content)}, data={"pad": pad, "camera": camera, **form}
    )


def _empty_png(width: int, height: int) -> bytes:
    """A PNG that states a size and holds a few bytes only."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = zlib.compress(bytes(1000))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        [chunk(b"IHDR", header), chunk(b"IDAT", data), chunk(b"IEND", b"")]
    )


@pytest.fixture(scope="module")
def jpeg() -> bytes:
    width, height = PRESET_SIZE
    noise = np.random.default_rng(0).integers(0, 255, (height, width, 3), np.uint8)
    return cv2.imencode(".jpg", noise)[1].tobytes()


def test_answer_without_a_trace(studio: httpx.Client, pad_id: str, picture: bytes) -> None:
    body = _send(studio, pad_id, picture, name="../dir/fra\nme.png").raise_for_status().json()
    assert body["result"]["source"] == "fra%0Ame.png"
    assert body["image"] == {"width": 1280, "height": 720}
    assert body["camera_scale"] == 1.0
    assert body["trace"] is None


def test_several_pads_are_named(
    studio: httpx.Client, pad_id: str, picture: bytes, refused: Refused
) -> None:
    other = store_pad(studio)["id"]
    files = {"image": ("frame.png", picture)}
    data = {"pad": [pad_id, other], "camera": PRESET}
    body = studio.post(DETECT, files=files, data=data).raise_for_status().json()
    assert [pad["id"] for pad in body["pads"]] == [pad_id, other]
    assert all(len(pad["pad_id"]) == 8 for pad in body["pads"])
    assert body["results"] == [body["result"]]
    data = {"pad": [pad_id, "0" * 16], "camera": PRESET}
    refused(studio.post(DETECT, files=files, data=data), 404, "not_found")


def test_trace_can_be_read_again_with_its_pictures(
    studio: httpx.Client, pad_id: str, picture: bytes, refused: Refused
) -> None:
    body = _send(studio, pad_id, picture, trace="true").raise_for_status().json()
    trace = body["trace"]
    assert studio.get(f"{DETECT}/{trace['id']}").json() == body
    edges, choose = trace["stages"]
    assert (edges["name"], edges["channel"]) == ("edges", "red")
    assert (choose["picture"], choose["thumbnail"]) == (None, None)
    sizes, forms = [], []
    for url in (trace["result_picture"], edges["picture"], edges["thumbnail"]):
        answer = studio.get(url).raise_for_status()
        forms.append(answer.headers["content-type"])
        assert "immutable" in answer.headers["cache-control"]
        assert "private" in answer.headers["cache-control"]
        sizes.append(cv2.imdecode(np.frombuffer(answer.content, np.uint8), -1).shape[1])
    assert sizes == [1280, 1280, 320]
    assert forms == ["image/png", "image/png", "image/webp"]
    pictures = f"{DETECT}/{trace['id']}/pictures"
    refused(studio.get(f"{pictures}/blue-edges.png"), 404, "not_found")
    refused(studio.get(f"{pictures}/..%2f..%2f..%2fpadstudio.db"), 404, "not_found")
    refused(studio.get(f"{pictures}/lock.txt"), 422, "invalid_request")
    refused(studio.get(f"{DETECT}/0123456789abcdef"), 404, "not_found")


def test_the_calibration_is_scaled_to_the_picture(studio: httpx.Client, pad_id: str) -> None:
    half = cv2.imencode(".png", np.zeros((360, 640, 3), np.uint8))[1].tobytes()
    assert _send(studio, pad_id, half).json()["camera_scale"] == 0.5


@pytest.mark.parametrize("content", [b"just a text", b"%PDF-1.4 ...", b"<svg/>", b"GIF89a" * 50])
def test_files_that_are_no_picture(
    studio: httpx.Client, pad_id: str, refused: Refused, content: bytes
) -> None:
    error = refused(_send(studio, pad_id, content, name="x.jpg"), 422, "not_an_image")
    assert "JPEG" in error["message"]


def test_an_empty_upload(studio: httpx.Client, pad_id: str, refused: Refused) -> None:
    refused(_send(studio, pad_id, b""), 422, "empty_file")


@pytest.mark.parametrize("part", [0.3, 0.9, 0.999])
def test_a_truncated_jpeg(
    studio: httpx.Client, pad_id: str, jpeg: bytes, refused: Refused, part: float
) -> None:
    _send(studio, pad_id, jpeg).raise_for_status()
    cut = jpeg[: int(len(jpeg) * part)]
    error = refused(_send(studio, pad_id, cut), 422, "truncated_image")
    assert "copy it again" in error["message"]


@pytest.mark.parametrize("size", [(10_000, 10_000), (2_000_000, 50), (2**31 - 1, 2**31 - 1)])
def test_a_hundred_megapixels(
    studio: httpx.Client, pad_id: str, refused: Refused, size: tuple[int, int]
) -> None:
    error = refused(_send(studio, pad_id, _empty_png(*size)), 413, "too_many_pixels")
    assert "megapixels" in error["message"]


def test_a_picture_that_holds_less_than_it_states(
    studio: httpx.Client, pad_id: str, refused: Refused
) -> None:
    width, height = PRESET_SIZE
    refused(_send(studio, pad_id, _empty_png(width, height)), 422, "invalid_image")


def test_a_camera_of_another_size(studio: httpx.Client, pad_id: str, refused: Refused) -> None:
    square = cv2.imencode(".png", np.zeros((300, 300, 3), np.uint8))[1].tobytes()
    error = refused(_send(studio, pad_id, square), 422, "camera_size_mismatch")
    assert error["detail"] == {"frame": [300, 300], "camera": [1280, 720], "turned": False}


def test_what_is_named_must_be_there(
    studio: httpx.Client, pad_id: str, picture: bytes, refused: Refused
) -> None:
    refused(_send(studio, "0123456789abcdef", picture), 404, "not_found")
    refused(_send(studio, pad_id, picture, camera="preset-none"), 404, "not_found")
    refused(_send(studio, pad_id, picture, method="magic"), 422, "invalid_request")
    refused(studio.post(DETECT, data={"pad": pad_id}), 422, "invalid_request")
    wrong = studio.post(DETECT, data={"pad": pad_id, "camera": PRESET, "image": "text"})
    assert "image must be a file" in refused(wrong, 422, "invalid_request")["message"]


@pytest.mark.parametrize(
    ("name", "status", "code"),
    [
        ("crash.png", 422, "worker_crashed"),
        ("slow.png", 422, "time_limit"),
        ("huge.png", 413, "limit_exceeded"),
        ("defect.png", 500, "internal_error"),
    ],
)
def test_the_server_outlives_its_workers_and_keeps_nothing(
    tmp_path: Path, picture: bytes, refused: Refused, name: str, status: int, code: str
) -> None:
    settings = settings_for(tmp_path, detect_seconds=5 if name == "slow.png" else 20)
    with running(settings, analyze=fake_analysis.analyze) as client:
        pad = store_pad(client)["id"]
        answer = _send(client, pad, picture, name=name, trace="true")
        refused(answer, status, code)
        assert "default-src 'none'" in answer.headers["content-security-policy"]
        assert _send(client, pad, picture).status_code == 200
        for folder in ("work", "traces"):
            assert not list((tmp_path / folder).iterdir())


def test_traces_survive_a_restart_and_only_the_newest_stay(
    tmp_path: Path, picture: bytes, refused: Refused
) -> None:
    settings = settings_for(tmp_path, keep_traces=2)
    with running(settings, analyze=fake_analysis.analyze) as client:
        pad = store_pad(client)["id"]
        bodies = [_send(client, pad, picture, trace="true").json() for _ in range(3)]
    with running(settings, analyze=fake_analysis.analyze) as client:
        refused(client.get(f"{DETECT}/{bodies[0]['trace']['id']}"), 404, "not_found")
        for body in bodies[1:]:
            assert client.get(f"{DETECT}/{body['trace']['id']}").json() == body
            assert client.get(body["trace"]["result_picture"]).content == picture
    assert len(list((tmp_path / "traces").iterdir())) == 2
