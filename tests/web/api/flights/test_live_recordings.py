"""What a live session recorded opens as a flight with its poses already there."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from flight_api import API, Api
from live_sessions import MISSED, lines_of, record_landing, session_of, zip_of
from places import FOOTAGE

FRAMES = 60


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record_landing(tmp_path_factory.mktemp("live") / "landing")


@pytest.fixture(scope="module")
def lines(folder: Path) -> list[dict[str, Any]]:
    """The poses that the session wrote."""
    segments = session_of(folder)["segments"]
    return [line for segment in segments for line in lines_of(folder / segment["poses"])]


def from_recording(api: Api, **order: Any) -> httpx.Response:
    return api.client.post(f"{API}/flights/from-recording", json=order)


def opened(api: Api, **order: Any) -> dict[str, Any]:
    return api.finished(from_recording(api, **order).raise_for_status().json()["id"])


def send(api: Api, path: Path, change: dict[str, bytes] | None = None) -> list[str]:
    """A recording's files as uploads, but for those that only people need."""
    own = ("pad.json", "camera.yaml")
    contents = {p.name: p.read_bytes() for p in sorted(path.iterdir()) if p.name not in own}
    return [api.upload(data, name) for name, data in (contents | (change or {})).items() if data]


def frames_of(api: Api, flight: str) -> list[dict[str, Any]]:
    return list(api.get(f"{flight}/frames?limit=1000")["items"])


@pytest.fixture(scope="module")
def flight(api: Api, folder: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Opened from a zip."""
    path = zip_of(folder, tmp_path_factory.mktemp("zip") / "landing.zip")
    return opened(api, uploads=[api.upload(path.read_bytes(), "landing.zip")])


def test_the_flight_has_all_frames_and_the_poses_that_were_sent(
    api: Api, flight: dict[str, Any], lines: list[dict[str, Any]]
) -> None:
    assert (flight["state"], flight["frames_total"]) == ("done", FRAMES)
    frames = frames_of(api, flight["id"])
    assert [frame["frame"] for frame in frames] == list(range(FRAMES))
    for frame, line in zip(frames, lines, strict=True):
        for name in (*("source", "frame", "time_s", "status", "live", "elapsed_ms"),):
            assert frame[name] == line[name], name
        if frame["frame"] in MISSED:
            assert (frame["stage"], frame["reason"]) == ("read", "dropped_live")
            assert "run the flight again" in frame["advice"]
            continue
        for name in (
            "position_mm",
            "quaternion_xyzw",
            "covariance",
            "single",
            "estimate",
            "pad_id",
        ):
            assert frame[name] == line[name], name
        for name in ("heading_deg", "tilt_deg", "range_sigma_mm", "bearing_sigma_deg"):
            assert frame[name] == pytest.approx(line[name], rel=1e-9), name
        assert frame["quality"] == line["quality"]
    assert {frame["estimate"] for frame in frames if frame["status"] == "ok"} == {"filtered"}


def test_it_says_what_it_is_of(api: Api, flight: dict[str, Any], folder: Path) -> None:
    about = flight["request"]["live"]
    assert about["source"] == "rtsp://pilot@drone.local/live"
    assert about["is_whole"]
    assert flight["request"]["version"] == session_of(folder)["program"]
    assert flight["name"].startswith("live 20")
    assert "poses" not in flight["sources"][0], "where workers find files is nobody's business"
    pads = api.client.get(f"{API}/pads").json()["items"]
    assert flight["request"]["pads"][0]["id"] in {pad["id"] for pad in pads}
    assert flight["request"]["camera_id"] == api.camera, "it was stored already"


def test_its_zip_is_taken_apart(api: Api, flight: dict[str, Any], folder: Path) -> None:
    kept = api.client.get(f"{API}/uploads").json()["items"]
    names = {upload["name"]: upload["kind"] for upload in kept}
    assert "landing.zip" not in names
    assert names["0001.mp4"] == "video"
    assert names["0001.jsonl"] == "live"


def test_files_are_the_same_as_their_zip(api: Api, folder: Path, flight: dict[str, Any]) -> None:
    same = opened(api, uploads=send(api, folder)[::-1], name="by files")
    assert same["name"] == "by files"
    assert frames_of(api, same["id"]) == frames_of(api, flight["id"])


def test_a_recording_of_this_server_opens_by_its_id_once(
    api: Api, folder: Path, flight: dict[str, Any]
) -> None:
    shutil.copytree(folder, api.data / "live" / "5d2f0a91c3b7e846")
    first = from_recording(api, recording="5d2f0a91c3b7e846")
    assert first.status_code == 202
    assert frames_of(api, api.finished(first.json()["id"])["id"]) == frames_of(api, flight["id"])
    again = from_recording(api, recording="5d2f0a91c3b7e846")
    assert (again.status_code, again.json()["id"]) == (200, first.json()["id"])


def test_a_recording_that_goes_on_opens_as_far_as_it_is_and_later_as_a_whole(
    api: Api, folder: Path
) -> None:
    own = shutil.copytree(folder, api.data / "live" / "77c0a1de52b94f38")
    session = session_of(own)
    whole = (own / "session.json").read_text()
    session["ended"] = None
    (own / "session.json").write_text(json.dumps(session))
    now = api.finished(from_recording(api, recording=own.name).json()["id"])
    (own / "session.json").write_text(whole)
    later = from_recording(api, recording=own.name)
    assert later.status_code == 202
    assert later.json()["id"] != now["id"]


@pytest.mark.parametrize("recording", ["..", "../live", "a/b", "%2e%2e", ""])
def test_no_path_reaches_the_disk(api: Api, recording: str) -> None:
    assert from_recording(api, recording=recording).status_code == 422


def test_an_unknown_recording_is_said_to_be_gone(api: Api) -> None:
    assert from_recording(api, recording="0123456789abcdef").status_code == 404
    assert from_recording(api).status_code == 422
    assert from_recording(api, recording="0123456789abcdef", uploads=["a"]).status_code == 422


def test_run_again_reads_every_frame_and_agrees_with_the_session(
    api: Api, flight: dict[str, Any]
) -> None:
    answer = api.client.post(f"{API}/flights/{flight['id']}/rerun", json={})
    again = api.finished(answer.raise_for_status().json()["id"])
    assert again["rerun_of"] == flight["id"]
    assert "live" not in again["request"]
    assert (again["state"], again["frames_ok"]) == ("done", FRAMES)
    truth = json.loads((FOOTAGE / "flights" / "landing.truth.json").read_text())["frames"]
    off = {
        name: [
            np.linalg.norm(np.subtract(frame["position_mm"], truth[frame["frame"]]["position_mm"]))
            for frame in frames_of(api, each["id"])
            if frame["status"] == "ok"
        ]
        for name, each in (("live", flight), ("offline", again))
    }
    assert len(off["live"]) == FRAMES - len(MISSED)
    # Up to the first frame that was missed both knew the same; behind gaps the session knew less.
    same = min(MISSED)
    np.testing.assert_allclose(off["live"][:same], off["offline"][:same], rtol=0, atol=1e-6)
    assert np.median(off["offline"]) <= np.median(off["live"]) < 2
    compared = api.get(f"{again['id']}/comparison/{flight['id']}")
    assert (compared["won"], compared["lost"]) == (len(MISSED), 0)
    assert compared["both"] == FRAMES - len(MISSED)


def test_only_what_was_dropped_is_read_where_that_is_asked_for(
    api: Api, flight: dict[str, Any]
) -> None:
    only = {"only": {"status": "failed", "reason": "dropped_live"}}
    answer = api.client.post(f"{API}/flights/{flight['id']}/rerun", json=only)
    again = api.finished(answer.raise_for_status().json()["id"])
    frames = frames_of(api, again["id"])
    assert [frame["frame"] for frame in frames] == sorted(MISSED)
    assert all(frame["status"] == "ok" for frame in frames)


def test_everything_else_is_as_on_any_flight(api: Api, flight: dict[str, Any]) -> None:
    base = f"{API}/flights/{flight['id']}"
    summary = api.get(f"{flight['id']}/summary")
    assert (summary["frames"], summary["ok"]) == (FRAMES, FRAMES - len(MISSED))
    assert summary["reasons"] == {"dropped_live": len(MISSED)}
    assert api.get(f"{flight['id']}/figures")
    table = api.client.get(f"{base}/export/csv").raise_for_status().text
    assert "dropped_live" in table
    for form in ("jsonl", "tum", "mcap"):
        answer = api.client.get(f"{base}/export/{form}")
        assert answer.status_code == 200, (form, answer.text[:300])
    # A frame that was dropped has its picture and its stages.
    looked = api.get(f"{flight['id']}/frames/5/stages")
    assert {"decode", "pose"} <= {stage["name"] for stage in looked["stages"]}
    picture = api.client.get(f"{base}/frames/34/preview.jpg")
    assert picture.headers["content-type"] == "image/jpeg"
    for frame in (20, 34):
        order = {"flight": flight["id"], "frame": frame}
        made = api.client.post(f"{API}/bundles", json=order)
        assert made.status_code == 200, made.text
        back = api.client.post(f"{API}/bundles/open", files={"file": ("b.zip", made.content)})
        assert back.status_code == 201, back.text
        recorded = back.json()["bundle"]["recorded"]
        assert recorded["status"] == ("failed" if frame in MISSED else "ok")


def test_a_session_that_broke_off_opens_as_far_as_it_came(
    api: Api, folder: Path, lines: list[dict[str, Any]]
) -> None:
    session = session_of(folder)
    session["ended"] = None
    last = session["segments"][-1]
    last["frames"] = last["duration_s"] = None
    video = (folder / last["video"]).read_bytes()
    poses = (folder / last["poses"]).read_bytes()
    change = {
        "session.json": json.dumps(session).encode(),
        # Killed amid a frame; one more was read already, and the line of another begun.
        last["video"]: video[: len(video) * 2 // 3],
        last["poses"]: poses[: len(poses) * 3 // 4],
    }
    flight = opened(api, uploads=send(api, folder, change))
    assert flight["state"] == "done", flight["error"]
    assert 30 < flight["frames_total"] < FRAMES
    frames = frames_of(api, flight["id"])
    known = {line["live"].get("number"): line for line in lines}
    live = [frame for frame in frames if "number" in frame["live"]]
    assert len(live) > 35
    for frame in live:
        assert frame["position_mm"] == known[frame["live"]["number"]]["position_mm"]


def test_a_session_that_broke_off_before_a_frame_opens_without_its_last_segment(
    api: Api, folder: Path
) -> None:
    session = session_of(folder)
    session["ended"] = None
    for stump in (b"", (folder / "0002.mp4").read_bytes()[:300]):
        change = {
            "session.json": json.dumps(session).encode(),
            "0002.mp4": stump,
            "0002.jsonl": b"",
        }
        flight = opened(api, uploads=send(api, folder, change))
        assert (flight["state"], flight["frames_total"]) == ("done", 30)


Change = Callable[[dict[str, Any]], None]


def changed_session(folder: Path, change: Change) -> dict[str, bytes]:
    session = session_of(folder)
    change(session)
    return {"session.json": json.dumps(session).encode()}


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda s: s.update(version=2), "live_recording_version"),
        (lambda s: s.update(pads=[]), "invalid_live_recording"),
        (lambda s: s["pads"][0]["layers"][0].update(codes=["0"]), "invalid_pad_file"),
        (lambda s: s.update(camera="width: 3"), "invalid_camera_file"),
        (lambda s: s.update(params={"refine": {"unheard": 1}}), "invalid_parameter"),
        (lambda s: s["segments"][0].update(video="../../etc/passwd"), "invalid_live_recording"),
        (lambda s: s["segments"].append(dict(s["segments"][0])), "invalid_live_recording"),
        (lambda s: s["started"].update(unix_s=float("inf")), "invalid_live_recording"),
        (lambda s: s.update(source="a\0b"), "invalid_live_recording"),
        (lambda s: s.pop("segments"), "invalid_live_recording"),
    ],
)
def test_a_session_that_is_none_is_refused_and_nothing_is_kept(
    api: Api, folder: Path, tmp_path: Path, change: Change, code: str
) -> None:
    path = zip_of(folder, tmp_path / "a.zip", changed_session(folder, change))
    upload = api.upload(path.read_bytes(), "a.zip")
    before = {each["id"] for each in api.client.get(f"{API}/uploads").json()["items"]}
    flights = api.client.get(f"{API}/flights").json()["total"]
    answer = from_recording(api, uploads=[upload])
    assert (answer.status_code, answer.json()["error"]["code"]) == (422, code), answer.text
    assert {each["id"] for each in api.client.get(f"{API}/uploads").json()["items"]} == before
    assert api.client.get(f"{API}/flights").json()["total"] == flights


def changed_line(line: dict[str, Any], **values: Any) -> dict[str, Any]:
    return {key: value for key, value in (line | values).items() if value is not ...}


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"position_mm": [1e300, 0, 0]}, "beyond"),
        ({"position_mm": ["1", 0, 0]}, "no number"),
        ({"position_mm": [1, 2]}, "3 entries"),
        ({"quaternion_xyzw": [0, 0, 0, 0]}, "no rotation"),
        ({"covariance": [-1.0] * 21}, "covariance"),
        ({"cells_read": -4}, "whole number"),
        ({"layer": "violet"}, "violet"),
        ({"pad_id": "AAAAAAAA"}, "a pad that the recording does not have"),
        ({"status": "perhaps"}, "ok or failed"),
        ({"surprise": 1}, "surprise"),
        ({"live": {"program": "x"}}, "session"),
        ({"pts": 10**9}, "frames that the video does not have"),
        ({"elapsed_ms": ...}, "elapsed_ms"),
    ],
)
def test_poses_that_are_none_are_refused_as_a_whole_by_name(
    api: Api, folder: Path, values: dict[str, Any], told: str
) -> None:
    lines = lines_of(folder / "0001.jsonl")
    lines[11] = changed_line(lines[11], **values)
    text = "".join(json.dumps(line) + "\n" for line in lines).encode()
    flight = opened(api, uploads=send(api, folder, {"0001.jsonl": text}))
    assert flight["state"] == "failed"
    assert flight["error"]["message"].startswith("the poses of 0001.mp4")
    assert told in flight["error"]["message"]
    assert (flight["frames_total"], frames_of(api, flight["id"])) == (None, [])


def test_numbers_that_json_does_not_have_are_refused(api: Api, folder: Path) -> None:
    text = (
        (folder / "0001.jsonl")
        .read_text()
        .replace('"reprojection_px": ', '"reprojection_px": NaN, "x": ')
    )
    flight = opened(api, uploads=send(api, folder, {"0001.jsonl": text.encode()}))
    assert "NaN is no number" in flight["error"]["message"]


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"0002.mp4": b""}, "live_files_missing"),
        ({"0001.jsonl": b""}, "live_files_missing"),
        ({"session.json": b""}, "live_files_missing"),
    ],
)
def test_a_part_of_a_recording_is_refused_by_name(
    api: Api, folder: Path, change: dict[str, bytes], code: str
) -> None:
    answer = from_recording(api, uploads=send(api, folder, change))
    assert (answer.status_code, answer.json()["error"]["code"]) == (422, code)
    assert next(iter(change)) in answer.json()["error"]["message"]


def test_files_of_others_are_refused_by_name(api: Api, folder: Path) -> None:
    uploads = [*send(api, folder), api.video]
    answer = from_recording(api, uploads=uploads)
    assert answer.json()["error"]["code"] == "live_files_mixed"
    assert "landing.mp4" in answer.json()["error"]["message"]


def test_poses_alone_make_no_flight(api: Api, folder: Path) -> None:
    uploads = send(api, folder)
    answer = api.order(*uploads)
    assert answer.json()["error"]["code"] == "live_recording"
    assert "from-recording" in answer.json()["error"]["message"]
