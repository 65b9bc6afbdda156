"""Flights over REST, from upload to pictures, with real workers; and everything that is refused."""

from __future__ import annotations

import base64
import json
import time
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
import score
from places import FOOTAGE
from web_server import running, settings_for

API = "/api/v1"
OVER = ("done", "failed", "cancelled")
Refused = Callable[..., dict[str, Any]]


class Api:
    """A client with a pad, a camera and a video uploaded."""

    def __init__(self, client: httpx.Client) -> None:
        self.client = client
        pad = (FOOTAGE / "pad_a.json").read_bytes()
        camera = (FOOTAGE / "camera_drone_2k7.yaml").read_bytes()
        self.pad = self.post_file("/pads/import", "pad.json", pad)
        self.camera = self.post_file("/cameras", "camera.yaml", camera)
        self.video = self.upload((FOOTAGE / "flights" / "landing.mp4").read_bytes(), "landing.mp4")

    def post_file(self, path: str, name: str, content: bytes) -> str:
        answer = self.client.post(API + path, files={"file": (name, content)})
        return str(answer.raise_for_status().json()["id"])

    def upload(self, content: bytes, name: str = "file") -> str:
        headers = {
            "Tus-Resumable": "1.0.0",
            "Upload-Length": str(len(content)),
            "Upload-Metadata": "filename " + base64.b64encode(name.encode()).decode(),
            "Content-Type": "application/offset+octet-stream",
        }
        answer = self.client.post(f"{API}/uploads", content=content, headers=headers)
        return str(answer.raise_for_status().json()["id"])

    def order(self, *uploads: str, **values: Any) -> httpx.Response:
        ids = {"uploads": list(uploads) or [self.video], "pad": self.pad, "camera": self.camera}
        return self.client.post(f"{API}/flights", json=ids | values)

    def finished(self, flight: str) -> dict[str, Any]:
        """Wait until a flight is over."""
        end = time.monotonic() + 120
        while (found := self.get(flight))["state"] not in OVER:
            assert time.monotonic() < end
            time.sleep(0.1)
        return found

    def get(self, path: str) -> dict[str, Any]:
        return dict(self.client.get(f"{API}/flights/{path}").raise_for_status().json())


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    settings = settings_for(
        tmp_path_factory.mktemp("data"),
        workers=1,
        max_image_pixels=8_000_000,
        max_upload_bytes=5_000_000,
        detect_seconds=60,
        chunk_frames=30,
    )
    with running(settings) as client:
        client.timeout = httpx.Timeout(90)
        yield Api(client)


@pytest.fixture(scope="module")
def flight(api: Api) -> dict[str, Any]:
    """A flight that is done."""
    answer = api.order(name="landing")
    assert answer.status_code == 202
    order = answer.json()
    assert answer.headers["location"] == f"{API}/flights/{order['id']}"
    assert order["state"] in ("queued", "running")
    return api.finished(order["id"])


def test_every_frame_is_read_and_true(api: Api, flight: dict[str, Any]) -> None:
    assert (flight["state"], flight["error"], flight["progress"]) == ("done", None, 1.0)
    assert flight["frames_total"] == flight["frames_done"] == 60
    [source] = flight["sources"]
    assert source["video"]["codec"] == "h264"
    assert source["video"]["damage"] == []
    assert "url" not in source
    frames = api.get(f"{flight['id']}/frames?limit=1000")["items"]
    assert [frame["frame"] for frame in frames] == list(range(60))
    truth = score.read_truth(FOOTAGE / "flights" / "landing.truth.json")
    poses = {("landing", frame["frame"]): frame for frame in frames}
    total = score.summary(score.score(truth, poses))["total"]
    assert total.get("false", 0) == 0
    assert total["good"] >= 57


def test_pages_and_filters(api: Api, flight: dict[str, Any]) -> None:
    address = f"{flight['id']}/frames?limit=25"
    first = api.get(address)
    second = api.get(f"{address}&after={first['next_after']}")
    third = api.get(f"{address}&after={second['next_after']}")
    numbers = [f["frame"] for page in (first, second, third) for f in page["items"]]
    assert numbers == list(range(60))
    assert third["next_after"] is None
    late = api.get(f"{flight['id']}/frames?from_s=1.0&to_s=1.1")["items"]
    assert [frame["frame"] for frame in late] == [30, 31, 32]
    low = api.get(f"{flight['id']}/frames?max_height=400&limit=1000")["items"]
    assert low
    assert all(frame["position_mm"][2] <= 400 for frame in low)
    assert api.get(f"{flight['id']}/frames?status=failed&reason=no_such")["items"] == []
    before = api.get(f"{flight['id']}/frames?before=10&limit=3")
    assert [frame["frame"] for frame in before["items"]] == [7, 8, 9]
    one = api.get(f"{flight['id']}/frames/31")
    assert one == late[1]
    assert len(one["covariance"]) == 21


def test_figures(api: Api, flight: dict[str, Any]) -> None:
    figures = api.get(f"{flight['id']}/summary")
    assert (figures["frames"], figures["ok"]) == (60, flight["frames_ok"])
    assert sum(figures["layers"].values()) == figures["ok"]
    assert sum(figures["stages"].values()) == 60 - figures["ok"]


def test_pictures_of_any_stage(api: Api, flight: dict[str, Any], refused: Refused) -> None:
    base = f"{API}/flights/{flight['id']}/frames/40"
    stages = api.client.get(f"{base}/stages").raise_for_status().json()
    assert stages["result"]["frame"] == 40
    names = {stage["name"] for stage in stages["stages"]}
    # Following a pad passes these over; they can be looked at all the same.
    assert {"edges", "lines", "grid", "decode", "choose", "pose"} <= names
    shown = [stage for stage in stages["stages"] if stage["picture"]]
    assert {stage["channel"] for stage in shown} >= {"red", "blue"}
    for stage in (*shown[:4], {"picture": stages["result_picture"]}):
        answer = api.client.get(stage["picture"])
        assert answer.headers["content-type"] == "image/webp"
        assert answer.content[8:12] == b"WEBP"
    png = api.client.get(f"{base}/pictures/result.png")
    assert png.content.startswith(b"\x89PNG")
    again = api.client.get(
        f"{base}/pictures/result.png", headers={"If-None-Match": png.headers["etag"]}
    )
    assert (again.status_code, again.content) == (304, b"")
    small = api.client.get(f"{base}/pictures/frame.webp?width=480")
    assert len(small.content) < len(api.client.get(f"{base}/pictures/frame.webp").content)
    missing = api.client.get(f"{base}/pictures/no_stage.webp")
    refused(missing, 404, "no_picture")
    beyond = api.client.get(f"{API}/flights/{flight['id']}/frames/60/pictures/frame.webp")
    refused(beyond, 404, "no_such_frame")


def test_progress_as_events(api: Api) -> None:
    flight = api.order(stride=20).json()["id"]
    states = []
    with api.client.stream("GET", f"{API}/flights/{flight}/events", timeout=120) as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        for line in stream.iter_lines():
            if line.startswith("data: "):
                states.append(json.loads(line.removeprefix("data: ")))
    assert states[-1]["state"] == "done"
    assert states[-1]["frames_done"] == 3
    assert [s["frames_done"] for s in states] == sorted(s["frames_done"] for s in states)


def test_a_rerun_stands_beside_the_first(api: Api, flight: dict[str, Any]) -> None:
    changes = {"params": {"refine": {"most_borders": 2000}}, "first_frame": 10, "end_frame": 20}
    answer = api.client.post(f"{API}/flights/{flight['id']}/rerun", json=changes | {"stride": 3})
    assert answer.status_code == 202
    second = api.finished(answer.json()["id"])
    assert second["rerun_of"] == flight["id"]
    assert second["request"]["params"] == changes["params"]
    assert second["request"]["pad_id"] == api.pad
    assert second["name"] == flight["name"]
    frames = api.get(f"{second['id']}/frames")["items"]
    assert [frame["frame"] for frame in frames] == [10, 13, 16, 19]
    assert api.get(flight["id"])["frames_done"] == 60


def test_cancel_retry_and_delete(api: Api, refused: Refused) -> None:
    flight = api.order().json()["id"]
    cancelled = api.client.post(f"{API}/flights/{flight}/cancel")
    assert cancelled.json()["state"] == "cancelled"
    again = api.client.post(f"{API}/flights/{flight}/retry")
    assert again.status_code == 202
    assert api.finished(flight)["frames_done"] == 60
    refused(api.client.post(f"{API}/flights/{flight}/retry"), 409, "not_retryable")
    assert api.client.delete(f"{API}/flights/{flight}").status_code == 204
    for path in ("", "/frames", "/summary", "/events", "/frames/0/pictures/frame.webp"):
        refused(api.client.get(f"{API}/flights/{flight}{path}"), 404, "not_found")


def test_pad_and_camera_may_go_while_in_use(api: Api) -> None:
    pad = api.post_file("/pads/import", "pad.json", (FOOTAGE / "pad_a.json").read_bytes())
    flight = api.order(pad=pad, stride=30).json()["id"]
    assert api.client.delete(f"{API}/pads/{pad}").status_code == 204
    assert api.finished(flight)["frames_ok"] == 2
    picture = api.client.get(f"{API}/flights/{flight}/frames/30/pictures/result.webp")
    assert picture.status_code == 200


def test_uploads_in_use_stay(api: Api, flight: dict[str, Any], refused: Refused) -> None:
    headers = {"Tus-Resumable": "1.0.0"}
    answer = api.client.delete(f"{API}/uploads/{api.video}", headers=headers)
    refused(answer, 409, "upload_in_use")


def test_stills_and_telemetry(api: Api, refused: Refused) -> None:
    names = ("a_bright0_150.jpg", "d05.jpg")
    stills = [api.upload((FOOTAGE / "stills" / name).read_bytes(), name) for name in names]
    found = api.finished(api.order(*stills).json()["id"])
    assert found["frames_total"] == 2
    frames = api.get(f"{found['id']}/frames")["items"]
    assert [(frame["frame"], frame["time_s"]) for frame in frames] == [(0, None), (1, None)]
    assert [frame["source"] for frame in frames] == list(names)
    refused(api.client.get(f"{API}/flights/{found['id']}/telemetry"), 404, "no_telemetry")
    cue = b"1\n00:00:00,000 --> 00:00:00,033\n[rel_alt: 1.043 abs_alt: 400.1]\n"
    srt = api.upload(cue, "landing.srt")
    both = api.finished(api.order(api.video, srt, stride=30).json()["id"])
    assert both["telemetry"]
    assert api.get(f"{both['id']}/telemetry")["height_m"] == [1.043]
    refused(api.order(api.video, stills[0]), 422, "mixed_uploads")
    refused(api.order(srt), 422, "mixed_uploads")
    refused(api.order(srt, stills[0]), 422, "mixed_uploads")


def test_orders_that_are_refused(api: Api, flight: dict[str, Any], refused: Refused) -> None:
    refused(api.order("0" * 16), 404, "not_found")
    refused(api.order(pad="0" * 16), 404, "not_found")
    refused(api.order(camera="0" * 16), 404, "not_found")
    refused(api.order(first_frame=9, end_frame=9), 422, "invalid_range")
    refused(api.order(stride=0), 422, "invalid_request")
    refused(api.order(shutter=1), 422, "invalid_request")
    refused(api.order(api.video, api.video), 422, "mixed_uploads")
    refused(api.order(params={"refine": {"most": 1}}), 422, "invalid_parameter")
    refused(api.order(params={"refine": {"most_borders": "many"}}), 422, "invalid_parameter")
    refused(api.order(params={"refine": 3}), 422, "invalid_parameter")
    refused(api.order(params={"refine": {"most_borders": 1}}), 422, "invalid_spec")
    rerun = api.client.post(f"{API}/flights/{flight['id']}/rerun", json={"uploads": []})
    refused(rerun, 422, "invalid_request")


def test_flights_that_fail_by_name(api: Api) -> None:
    beyond = api.finished(api.order(first_frame=60).json()["id"])
    assert (beyond["state"], beyond["error"]["code"]) == ("failed", "no_frames")
    content = (FOOTAGE / "flights" / "landing.mp4").read_bytes()
    cut = api.finished(api.order(api.upload(content[: len(content) // 2], "half.mp4")).json()["id"])
    assert (cut["state"], 10 < cut["frames_total"] < 50) == ("done", True)
    assert any("frames are missing" in loss for loss in cut["sources"][0]["video"]["damage"])
    cut = api.upload(content[:48], "cut.mp4")
    found = api.finished(api.order(cut).json()["id"])
    assert (found["state"], found["error"]["code"]) == ("failed", "no_video_stream")
    assert found["error"]["message"].startswith("cut.mp4: ")
    other = api.finished(api.order(camera="preset-raspberry-pi-2").json()["id"])
    assert (other["state"], other["error"]["code"]) == ("failed", "camera_size_mismatch")
