"""The workbench's routes: parameters, looks, cells, presets."""

from __future__ import annotations

import base64
import json
import time
from collections.abc import Callable, Iterator
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from flight_footage import FLIGHT_CAMERA, order_flight, write_flight
from places import FOOTAGE
from web_server import running, settings_for

from padstudio.vision.stage.parameter import parameters_of
from padstudio.vision.stage.params import DetectorParams

Refused = Callable[..., dict[str, Any]]
STILL = FOOTAGE / "stills" / "a_cast0_1300.jpg"
API = "/api/v1"


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """A server with the real detector."""
    with running(settings_for(tmp_path_factory.mktemp("bench"))) as client:
        yield client


@pytest.fixture(scope="module")
def reading(bench: httpx.Client) -> dict[str, Any]:
    """A kept picture, a pad and a camera."""
    pad, camera = (
        bench.post(f"{API}/{route}", files={"file": (name, (FOOTAGE / name).read_bytes())})
        .raise_for_status()
        .json()["id"]
        for route, name in (("pads/import", "pad_a.json"), ("cameras", "camera_drone_half.yaml"))
    )
    answer = bench.post(
        f"{API}/detect",
        files={"image": (STILL.name, STILL.read_bytes())},
        data={"pad": pad, "camera": camera, "trace": "true", "paint": "false"},
    )
    trace = answer.raise_for_status().json()["trace"]
    assert (trace["stages"], trace["result_picture"]) == ([], None)
    return {"trace": trace["id"], "pad": pad, "camera": camera}


def _look(bench: httpx.Client, reading: dict[str, Any], **more: Any) -> dict[str, Any]:
    answer = bench.post(f"{API}/looks", json={**reading, **more})
    return dict(answer.raise_for_status().json())


def test_every_parameter_is_listed(bench: httpx.Client) -> None:
    items = bench.get(f"{API}/parameters").raise_for_status().json()["items"]
    assert [item["name"] for item in items] == [p.name for p in parameters_of(DetectorParams())]
    step = next(item for item in items if item["name"] == "search.least_step")
    assert (step["default"], step["unit"], step["stages"]) == (0.6, "grey/px", ["edges"])
    assert (step["methods"], step["followed"]) == (["dense"], False)


def test_a_look_has_the_pose_the_stages_and_the_pictures(
    bench: httpx.Client, reading: dict[str, Any]
) -> None:
    views = [
        {"stage": "edges", "channel": "red", "scale": 0.25},
        {"stage": "frame", "channel": "blue", "scale": 1.0, "part": [100, 80, 140, 110]},
        {"stage": "lines", "channel": "blue", "scale": 0.5, "quick": True},
        {"stage": "unmix", "scale": 1.0},
    ]
    found = _look(bench, reading, views=views)
    assert (found["result"]["status"], found["result"]["source"]) == ("ok", STILL.name)
    stages = {(stage["name"], stage["channel"]): stage for stage in found["stages"]}
    assert {("edges", "red"), ("edges", "blue"), ("pose", None)} <= stages.keys()
    edges, frame, lines, nothing = found["pictures"]
    assert edges["part"] == stages["edges", "red"]["part"]
    picture = _decoded(frame)
    own = cv2.imread(str(STILL))[80:110, 100:140, 0]
    assert (frame["exact"], frame["part"]) == (True, [100, 80, 140, 110])
    assert np.array_equal(picture, own)
    assert (lines["media_type"], lines["exact"]) == ("image/jpeg", False)
    assert {line["kind"] for line in lines["marks"]["lines"]} >= {"found"}
    assert (nothing["part"], nothing["base64"]) == (None, None)


def _decoded(picture: dict[str, Any]) -> Any:
    data = np.frombuffer(base64.b64decode(picture["base64"]), np.uint8)
    return cv2.imdecode(data, cv2.IMREAD_UNCHANGED)


def test_a_parameter_has_its_effect(bench: httpx.Client, reading: dict[str, Any]) -> None:
    strict = {"search": {"least_edges": 100_000}, "outline": {"largest_px": 32}}
    assert _look(bench, reading)["result"]["status"] == "ok"
    found = _look(bench, reading, params=strict)["result"]
    assert (found["status"], found["stage"]) == ("failed", "edges")
    assert _look(bench, reading, method="paper")["result"]["source"] == STILL.name


def test_expected_against_read(
    bench: httpx.Client, reading: dict[str, Any], refused: Refused
) -> None:
    answer = bench.post(f"{API}/cells", json=reading).raise_for_status().json()
    pose = answer["pose"]
    red = next(layer for layer in answer["layers"] if layer["channel"] == "red")
    assert red["wrong"] < 0.02 * red["read"] == 0.02 * len(red["grey"])
    carried = {name: pose[name] for name in ("position_mm", "quaternion_xyzw")}
    again = bench.post(f"{API}/cells", json={**reading, "pose": carried}).json()
    assert again["layers"] == answer["layers"]
    away = {**carried, "position_mm": [pose["position_mm"][0] + 205, *pose["position_mm"][1:]]}
    moved = bench.post(f"{API}/cells", json={**reading, "pose": away}).json()
    red = next(layer for layer in moved["layers"] if layer["channel"] == "red")
    assert 0.3 < red["wrong"] / red["read"] < 0.7
    line = {"corners": [[0, 0], [1, 0], [2, 0], [3, 0]]}
    refused(bench.post(f"{API}/cells", json={**reading, **line}), 422, "no_pose")


@pytest.mark.parametrize(
    ("change", "status", "code"),
    [
        ({"params": {"search": {"least_step": 900}}}, 422, "invalid_spec"),
        ({"params": {"search": {"nothing": 1}}}, 422, "invalid_parameter"),
        ({"params": {"refine": 3}}, 422, "invalid_parameter"),
        ({"pad": None}, 422, "invalid_request"),
        ({"flight": "abc", "frame": 3}, 422, "invalid_request"),
        ({"trace": None}, 422, "invalid_request"),
        ({"trace": "0123456789abcdef"}, 404, "not_found"),
        ({"trace": None, "flight": "0123456789abcdef", "frame": 0}, 404, "not_found"),
        ({"views": [{"stage": "edges", "scale": 0}]}, 422, "invalid_request"),
        ({"views": [{"stage": "../x", "scale": 1}]}, 422, "invalid_request"),
    ],
)
def test_wrong_wishes_are_refused(
    bench: httpx.Client,
    reading: dict[str, Any],
    refused: Refused,
    change: dict[str, Any],
    status: int,
    code: str,
) -> None:
    refused(bench.post(f"{API}/looks", json={**reading, **change}), status, code)


def test_presets_are_kept_replaced_and_removed(bench: httpx.Client, refused: Refused) -> None:
    url = f"{API}/presets/faint print"
    params = {"search": {"least_step": 0.4}}
    kept = bench.put(url, json={"method": "dense", "params": params}).raise_for_status().json()
    assert (kept["name"], kept["params"]) == ("faint print", params)
    bench.put(url, json={"method": "dense", "params": {}}).raise_for_status()
    (only,) = bench.get(f"{API}/presets").json()["items"]
    assert (only["name"], only["params"]) == ("faint print", {})
    wrong = {"params": {"search": {"least_step": 900}}}
    refused(bench.put(url, json=wrong), 422, "invalid_spec")
    assert bench.delete(url).status_code == 204
    refused(bench.delete(url), 404, "not_found")
    assert json.loads(bench.get(f"{API}/presets").text) == {"items": []}


@pytest.fixture(scope="module")
def flight(bench: httpx.Client, tmp_path_factory: pytest.TempPathFactory) -> str:
    """A flight that is done."""
    footage = write_flight(tmp_path_factory.mktemp("footage"))
    url = str(bench.base_url).rstrip("/")
    return order_flight(url, footage, FOOTAGE / "pad_a.json", FLIGHT_CAMERA)


def test_a_frame_of_a_flight_is_read_with_the_flights_own_pad(
    bench: httpx.Client, flight: str
) -> None:
    found = _look(bench, {"flight": flight, "frame": 2})
    record = bench.get(f"{API}/flights/{flight}/frames/2").json()
    assert found["result"]["status"] == record["status"] == "ok"
    off = np.subtract(found["result"]["position_mm"], record["position_mm"])
    assert np.linalg.norm(off) < 0.05 * record["range_mm"]


def test_a_sweep_counts_frames_won_and_lost(
    bench: httpx.Client, flight: str, refused: Refused
) -> None:
    spec = {"parameter": "search.least_edges", "values": [40, 100_000], "failed": 3, "read": 4}
    spec["params"] = {"outline": {"largest_px": 32}}
    url = f"{API}/flights/{flight}/sweeps"
    begun = bench.post(url, json=spec)
    assert begun.status_code == 202
    sweep = begun.json()
    for _ in range(300):
        if sweep["state"] not in ("queued", "running"):
            break
        time.sleep(0.2)
        sweep = bench.get(begun.headers["location"]).raise_for_status().json()
    assert (sweep["state"], sweep["error"]) == ("done", None)
    assert sweep["frames_done"] == sweep["frames_total"]
    read = sum(frame["was_ok"] for frame in sweep["frames"])
    assert read == 4
    # Without edges nothing is found; as it is, all that was.
    assert sweep["lost"] == [0, read]
    assert sweep["won"][1] == 0
    refused(bench.post(url, json={**spec, "values": [3]}), 422, "invalid_spec")
    refused(bench.post(url, json={**spec, "parameter": "nothing"}), 422, "invalid_parameter")
    refused(bench.post(url, json={**spec, "failed": 0, "read": 0}), 422, "no_frames")
    assert bench.delete(begun.headers["location"]).status_code == 204
    refused(bench.get(f"{API}/sweeps/nothing"), 404, "not_found")
