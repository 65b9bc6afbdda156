"""Flights over REST, from upload to pictures, with real workers; and everything that is refused."""

from __future__ import annotations

import json
import re
import shutil
import time
from collections.abc import Callable
from typing import Any

import pytest
import score
import vehicle_logs
from dense_frames import random_pad
from flight_api import API, Api
from places import FOOTAGE

from padstudio.pad.spec import Pad

Refused = Callable[..., dict[str, Any]]


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
    small = api.client.get(f"{base}/pictures/frame.webp?width=320")
    assert len(small.content) < len(api.client.get(f"{base}/pictures/frame.webp").content)
    missing = api.client.get(f"{base}/pictures/no_stage.webp")
    refused(missing, 404, "no_picture")
    beyond = api.client.get(f"{API}/flights/{flight['id']}/frames/60/pictures/frame.webp")
    refused(beyond, 404, "no_such_frame")


def test_small_pictures_are_there_and_made_again(api: Api, flight: dict[str, Any]) -> None:
    def group(number: int) -> tuple[dict[str, Any], bytes]:
        data = api.client.get(f"{API}/flights/{flight['id']}/proxies/{number}").content
        start = 4 + int.from_bytes(data[:4], "little")
        return json.loads(data[4:start]), data[start:]

    for number, frames in ((0, range(16)), (3, range(48, 60)), (4, range(0))):
        head, pictures = group(number)
        assert head["complete"]
        assert [each["frame"] for each in head["frames"]] == list(frames)
        assert sum(each["bytes"] for each in head["frames"]) == len(pictures)
    assert head["making"] is None
    # As after an update, or where others pushed them out.
    for folder in (api.data / "proxies").iterdir():
        shutil.rmtree(folder)
    end = time.monotonic() + 60
    while not (found := group(2)[0])["complete"]:
        assert 0 <= found["making"]["done"] <= found["making"]["total"]
        assert time.monotonic() < end
        time.sleep(0.05)
    assert [each["frame"] for each in found["frames"]] == list(range(32, 48))


def test_outlines_lie_where_poses_say(api: Api, flight: dict[str, Any]) -> None:
    items = api.get(f"{flight['id']}/outlines?first_frame=20&limit=5")["items"]
    assert [item["frame"] for item in items] == [20, 21, 22, 23, 24]
    for item in items:
        roles = [line["role"] for line in item["lines"]]
        assert {"x", "y", "z"} & set(roles)
        assert all(len(line["points"]) > 1 for line in item["lines"])


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


def test_a_rerun_of_failed_frames_reads_no_others(
    api: Api, flight: dict[str, Any], refused: Refused
) -> None:
    rerun = f"{API}/flights/{flight['id']}/rerun"
    blind = api.client.post(
        rerun, json={"params": {"search": {"least_edges": 90_000}}, "stride": 4}
    )
    first = api.finished(blind.json()["id"])
    items = api.get(f"{first['id']}/frames")["items"]
    failed = [item["frame"] for item in items if item["status"] == "failed"]
    reasons = {item["reason"] for item in items if item["status"] == "failed"}
    assert 0 < len(failed) < len(items) or failed == [item["frame"] for item in items]
    again = f"{API}/flights/{first['id']}/rerun"
    answer = api.client.post(again, json={"params": {}, "only": {"status": "failed"}})
    assert answer.status_code == 202, answer.text
    second = api.finished(answer.json()["id"])
    assert second["request"]["only"] == {"flight": first["id"], "reason": None}
    assert second["frames_total"] == second["frames_done"] == len(failed)
    found = api.get(f"{second['id']}/frames")["items"]
    assert [item["frame"] for item in found] == failed
    whole = {item["frame"]: item for item in api.get(f"{flight['id']}/frames")["items"]}
    assert [item["time_s"] for item in found] == [whole[n]["time_s"] for n in failed]
    assert api.get(f"{second['id']}/summary")["frames"] == len(failed)
    # Exports, pictures and further runs keep to them.
    lines = api.client.get(f"{API}/flights/{second['id']}/export/csv").text.splitlines()
    assert len(lines) == 1 + len(failed)
    assert api.client.get(
        f"{API}/flights/{second['id']}/frames/{failed[-1]}/preview.jpg"
    ).is_success
    other = next(n for n in range(60) if n not in failed)
    missing = api.client.get(f"{API}/flights/{second['id']}/frames/{other}/preview.jpg")
    refused(missing, 404, "no_result")
    kept = api.client.post(f"{API}/flights/{second['id']}/rerun", json={})
    assert api.finished(kept.json()["id"])["frames_total"] == len(failed)
    everything = api.client.post(f"{API}/flights/{second['id']}/rerun", json={"only": None})
    assert api.finished(everything.json()["id"])["frames_total"] == 15
    wrong = {"only": {"status": "failed", "reason": "warped"}}
    assert "warped" not in reasons
    refused(api.client.post(again, json=wrong), 422, "no_frames")


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
    # Under a name of its own, or it would be the pad of the other tests.
    content = Pad.load(FOOTAGE / "pad_a.json").to_dict() | {"name": "goes"}
    pad = api.post_file("/pads/import", "pad.json", json.dumps(content).encode())
    flight = api.order(pad=pad, stride=30).json()["id"]
    assert api.client.delete(f"{API}/pads/{pad}").status_code == 204
    assert api.finished(flight)["frames_ok"] == 2
    picture = api.client.get(f"{API}/flights/{flight}/frames/30/pictures/result.webp")
    assert picture.status_code == 200


def test_of_several_pads_each_frame_names_its_own(api: Api, refused: Refused) -> None:
    other = api.post_file(
        "/pads/import", "other.json", random_pad(7, cells=(60, 12)).dumps().encode()
    )
    flight = api.order(pad=[other, api.pad], stride=20).json()
    named = {pad["id"]: pad["pad_id"] for pad in flight["request"]["pads"]}
    assert list(named) == [other, api.pad]
    assert api.finished(flight["id"])["frames_ok"] == 3
    frames = api.get(f"{flight['id']}/frames?limit=100")["items"]
    assert {frame["pad_id"] for frame in frames} == {named[api.pad]}
    assert {frame["estimate"] for frame in frames} == {"filtered"}
    export = f"{API}/flights/{flight['id']}/export"
    assert named[api.pad] in api.client.get(f"{export}/csv").text
    refused(api.client.get(f"{export}/tum"), 422, "several_pads")
    refused(api.client.get(f"{export}/tum?pad_id=NOSUCHPD"), 422, "unknown_pad")
    refused(api.client.get(f"{export}/tum?pad_id={named[other]}"), 422, "empty_export")
    text = api.client.get(f"{export}/tum?pad_id={named[api.pad]}").text
    assert len(re.findall("(?m)^[^#]", text)) == 3
    preview = api.client.get(f"{API}/flights/{flight['id']}/frames/20/preview.jpg")
    assert preview.raise_for_status().content[:2] == b"\xff\xd8"
    again = api.client.post(f"{API}/flights/{flight['id']}/rerun", json={"stride": 40}).json()
    assert again["request"]["pads"] == flight["request"]["pads"]
    assert api.finished(again["id"])["frames_ok"] == 2


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
    refused(api.client.get(f"{API}/flights/{found['id']}/vehicle"), 404, "no_telemetry")
    cue = b"1\n00:00:00,000 --> 00:00:00,033\n[rel_alt: 1.043 abs_alt: 400.1]\n"
    srt = api.upload(cue, "landing.srt")
    both = api.finished(api.order(api.video, srt, stride=30).json()["id"])
    assert both["telemetry"]
    vehicle = api.get(f"{both['id']}/vehicle")
    assert (vehicle["kind"], vehicle["clock"]["offset_s"]) == ("srt", 0.0)
    assert vehicle["mount_reason"] == "the log holds no attitude"
    assert len(vehicle["columns"]["pose_m"]) == 2
    assert api.get(f"{both['id']}/telemetry")["height_m"] == [1.043]
    refused(api.order(api.video, stills[0]), 422, "mixed_uploads")
    refused(api.order(srt), 422, "mixed_uploads")
    refused(api.order(srt, stills[0]), 422, "mixed_uploads")


def test_a_log_on_a_clock_of_its_own(api: Api) -> None:
    # Two seconds of flight are too few to find it among forty.
    log = api.upload(vehicle_logs.dataflash(vehicle_logs.wandering(40.0)), "flight.bin")
    flight = api.finished(api.order(api.video, log, stride=10).json()["id"])
    columns = api.get(f"{flight['id']}/telemetry")
    assert (columns["kind"], len(columns["qw"])) == ("dataflash", len(columns["time_s"]))
    vehicle = api.get(f"{flight['id']}/vehicle")
    assert (vehicle["kind"], vehicle["clock"]["offset_s"]) == ("dataflash", None)
    assert "three seconds" in vehicle["clock"]["reason"]
    assert api.get(f"{flight['id']}/figures")["heights"] is None


def test_orders_that_are_refused(api: Api, flight: dict[str, Any], refused: Refused) -> None:
    refused(api.order("0" * 16), 404, "not_found")
    refused(api.order(pad=[api.pad, api.pad]), 422, "pads_alike")
    other = api.post_file(
        "/pads/import", "other.json", random_pad(7, cells=(60, 12)).dumps().encode()
    )
    refused(api.order(pad=[api.pad, other], method="paper"), 422, "several_pads")
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
