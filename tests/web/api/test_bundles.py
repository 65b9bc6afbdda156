"""Bundles over REST: made on one server of a still and of a flight's frame, opened on another."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from flight_api import Api
from places import FOOTAGE
from web_server import running, settings_for

from padstudio.flights.bundles.replay import differing
from padstudio.web.server.settings import Settings

Refused = Callable[..., dict[str, Any]]
STILL = FOOTAGE / "stills" / "a_cast0_1300.jpg"
API = "/api/v1"
VIEW = {"view": "red-edges", "at": "812,604,6", "corners": "1,2,3,4", "rest": "1"}
PARAMS = {"search": {"least_step": 0.5}, "refine": {"at_rest": True}}


def _settings(data: Path, **values: int) -> Settings:
    limits = {"max_image_pixels": 8_000_000, "max_upload_bytes": 5_000_000, "detect_seconds": 60}
    return settings_for(data, **limits, **values)


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    with running(_settings(tmp_path_factory.mktemp("first"), chunk_frames=30)) as client:
        client.timeout = httpx.Timeout(90)
        yield Api(client, tmp_path_factory.getbasetemp())


@pytest.fixture(scope="module")
def other(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """A second, fresh install."""
    values = _settings(tmp_path_factory.mktemp("second"), max_bundle_bytes=20_000_000)
    with running(values) as client:
        client.timeout = httpx.Timeout(90)
        yield client


@pytest.fixture(scope="module")
def still(api: Api) -> bytes:
    answer = api.client.post(
        f"{API}/detect",
        files={"image": (STILL.name, STILL.read_bytes())},
        data={"pad": api.pad, "camera": _half(api), "trace": "true", "paint": "false"},
    )
    trace = answer.raise_for_status().json()["trace"]["id"]
    asked = {"trace": trace, "pad": api.pad, "camera": _half(api), "params": PARAMS, "view": VIEW}
    made = api.client.post(f"{API}/bundles", json=asked).raise_for_status()
    assert made.headers["content-type"] == "application/zip"
    assert "a_cast0_1300" in made.headers["content-disposition"]
    return made.content


def _half(api: Api) -> str:
    camera = (FOOTAGE / "camera_drone_half.yaml").read_bytes()
    return api.post_file("/cameras", "camera.yaml", camera)


@pytest.fixture(scope="module")
def flight(api: Api) -> str:
    found = api.finished(api.order(params={"search": {"least_step": 0.5}}).json()["id"])
    assert found["state"] == "done", found["error"]
    return str(found["id"])


@pytest.fixture(scope="module")
def flown(api: Api, flight: str) -> bytes:
    asked = {"flight": flight, "frame": 41, "params": PARAMS, "view": {"view": "pose"}}
    made = api.client.post(f"{API}/bundles", json=asked)
    assert made.status_code == 200, made.text
    return made.content


def _open(client: httpx.Client, data: bytes) -> httpx.Response:
    return client.post(f"{API}/bundles/open", files={"file": ("a.zip", data)})


def _members(data: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def _packed(members: dict[str, bytes]) -> bytes:
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return written.getvalue()


def test_a_still_opens_in_another_install_as_it_was(
    api: Api, still: bytes, other: httpx.Client
) -> None:
    answer = _open(other, still)
    assert answer.status_code == 201, answer.text
    found = answer.json()
    bundle, trace = found["bundle"], found["trace"]["id"]
    assert bundle["same"], bundle
    assert (bundle["reading"], bundle["view"], bundle["params"]) == ("still", VIEW, PARAMS)
    assert bundle["versions"] == []
    assert found["result"]["status"] == "ok"
    assert found["result"]["position_mm"] == pytest.approx(bundle["result"]["position_mm"])
    assert found["result"]["source"] == STILL.name
    kept = other.get(f"{API}/detect/{trace}").raise_for_status().json()
    assert kept == found
    # The frame, the pad and the camera are there, for the workbench to read.
    asked = {"trace": trace, "pad": bundle["pad"], "camera": bundle["camera"], "params": PARAMS}
    look = other.post(f"{API}/looks", json=asked).raise_for_status().json()
    assert look["result"]["position_mm"] == pytest.approx(bundle["result"]["position_mm"])
    # Opened again, nothing is stored twice; where it was made, they are known.
    again, home = _open(other, still).json()["bundle"], _open(api.client, still).json()["bundle"]
    assert (again["pad"], again["camera"]) == (bundle["pad"], bundle["camera"])
    assert (home["pad"], home["camera"]) == (api.pad, _half(api))


def test_a_preset_stays_one(api: Api, other: httpx.Client) -> None:
    preset = "preset-dji-mini-27k"
    picture = cv2.imencode(".png", np.full((1530, 2720, 3), 90, np.uint8))[1].tobytes()
    data = {"pad": api.pad, "camera": preset, "trace": "true", "paint": "false"}
    kept = api.client.post(f"{API}/detect", files={"image": ("b.png", picture)}, data=data)
    trace = kept.raise_for_status().json()["trace"]["id"]
    asked = {"trace": trace, "pad": api.pad, "camera": preset}
    made = api.client.post(f"{API}/bundles", json=asked).raise_for_status().content
    found = _open(other, made).json()
    assert found["bundle"]["camera"] == preset
    assert (found["result"]["status"], found["bundle"]["same"]) == ("failed", True)


def test_a_frame_of_a_flight_tells_the_run_and_the_frame_apart(
    api: Api, flight: str, flown: bytes, other: httpx.Client
) -> None:
    recorded = api.get(f"{flight}/frames/41")
    bundle = (found := _open(other, flown).json())["bundle"]
    assert bundle["same"], bundle
    assert bundle["reading"] == "run"
    # The run's, to the last digits that count, and read so once more here.
    assert bundle["recorded"]["position_mm"] == recorded["position_mm"]
    assert differing(bundle["recorded"], bundle["recorded_now"]) == []
    assert bundle["recorded"]["estimate"] == "filtered"
    assert bundle["recorded_version"]
    # The frame by itself, under the workbench's parameters, which is what the page shows.
    assert bundle["params"] == PARAMS
    assert found["result"] == bundle["alone_now"]
    assert bundle["alone"]["position_mm"] != pytest.approx(recorded["position_mm"])
    assert [each["offset"] for each in bundle["neighbours"]] == [-1, 1]
    for each, number in zip(bundle["neighbours"], (40, 42), strict=True):
        assert each["result"]["position_mm"] == api.get(f"{flight}/frames/{number}")["position_mm"]
        picture = other.get(each["picture"]).raise_for_status()
        assert picture.headers["content-type"] == "image/png"
        assert cv2.imdecode(np.frombuffer(picture.content, np.uint8), 1).shape == (1530, 2720, 3)
        assert other.get(each["picture"] + "?width=160").status_code == 200


def test_a_still_of_a_flight_is_bundled_too(api: Api, other: httpx.Client) -> None:
    upload = api.upload(STILL.read_bytes(), STILL.name)
    order = api.order(upload, camera=_half(api))
    run = api.finished(order.raise_for_status().json()["id"])["id"]
    made = api.client.post(f"{API}/bundles", json={"flight": run, "frame": 0}).raise_for_status()
    assert _members(made.content)["frame.original"] == STILL.read_bytes()
    bundle = _open(other, made.content).json()["bundle"]
    assert (bundle["same"], bundle["reading"], bundle["neighbours"]) == (True, "run", [])


def test_what_is_otherwise_is_told(flown: bytes, other: httpx.Client) -> None:
    members = _members(flown)
    manifest = json.loads(members["bundle.json"])
    manifest["result"]["cells_read"] += 1
    manifest["recorded"]["tilt_deg"] += 1
    manifest["alone"]["result"]["layer"] = "red?"
    manifest["versions"]["numpy"] = "1.0"
    bundle = _open(other, _packed(members | {"bundle.json": json.dumps(manifest).encode()})).json()[
        "bundle"
    ]
    assert not bundle["same"]
    fields = ("differences", "recorded_differences", "alone_differences")
    assert [[each["field"] for each in bundle[name]] for name in fields] == [
        ["cells_read"],
        ["tilt_deg"],
        ["layer"],
    ]
    assert [each["name"] for each in bundle["versions"]] == ["numpy"]


@pytest.mark.parametrize(
    ("change", "status", "code"),
    [
        ({"../../evil": b"x"}, 422, "unknown_member"),
        ({"/etc/passwd": b"x"}, 422, "unknown_member"),
        ({"trace.json": b" " * 30_000_000}, 413, "bundle_too_large"),
        ({f"{k}.txt": b"" for k in range(5000)}, 413, "too_many_members"),
        ({"pad.json": b'{"format": "padstudio.pad"}'}, 422, "invalid_pad_file"),
        ({"frame.original": b"\x89PNG\r\n\x1a\n"}, 422, "not_an_image"),
        ({"bundle.json": b'{"a": 1e999}'}, 422, "invalid_bundle"),
    ],
)
def test_hostile_zips_are_refused_whole(
    still: bytes, other: httpx.Client, refused: Refused, change: Any, status: int, code: str
) -> None:
    before = [other.get(f"{API}/{kind}").json()["total"] for kind in ("pads", "cameras")]
    refused(_open(other, _packed(_members(still) | change)), status, code)
    assert [other.get(f"{API}/{kind}").json()["total"] for kind in ("pads", "cameras")] == before


@pytest.mark.parametrize("name", ["bundle.json", "pad.json", "camera.yaml", "frame.original"])
def test_a_missing_member_refuses(
    still: bytes, other: httpx.Client, refused: Refused, name: str
) -> None:
    members = _members(still)
    del members[name]
    code = "not_a_bundle" if name == "bundle.json" else "invalid_bundle"
    refused(_open(other, _packed(members)), 422, code)


def test_an_altered_pad_is_another_pad_and_gives_another_result(
    still: bytes, other: httpx.Client
) -> None:
    members = _members(still)
    pad = json.loads(members["pad.json"])
    for layer in pad["layers"]:
        layer["codes"] = [row[::-1] for row in layer["codes"]]
    bundle = _open(other, _packed(members | {"pad.json": json.dumps(pad).encode()})).json()[
        "bundle"
    ]
    assert not bundle["same"]
    assert bundle["pad"] != _open(other, still).json()["bundle"]["pad"]
    assert "status" in {each["field"] for each in bundle["differences"]}


def test_large_bundles_are_refused(other: httpx.Client, refused: Refused) -> None:
    refused(_open(other, bytes(20_200_000)), 413, "limit_exceeded")
    # Other uploads keep their own limit.
    files = {"file": ("a.json", bytes(6_000_000))}
    refused(other.post(f"{API}/pads/import", files=files), 413, "limit_exceeded")


def test_odd_requests_are_refused(api: Api, flight: str, refused: Refused) -> None:
    def ask(**values: Any) -> httpx.Response:
        return api.client.post(f"{API}/bundles", json=values)

    refused(ask(flight=flight, frame=41, pad=api.pad), 422, "invalid_request")
    refused(ask(flight=flight, frame=41, view={"../x": "1"}), 422, "invalid_request")
    refused(ask(flight=flight, frame=41, view={"a": "x" * 5000}), 422, "invalid_request")
    refused(ask(flight=flight, frame=4000), 404, "no_such_frame")
    refused(ask(flight=flight, frame=41, params={"no": 1}), 422, "invalid_parameter")
    refused(ask(trace="gone", pad=api.pad, camera=_half(api)), 404, "not_found")
    left = api.data
    assert not list(left.glob("first*/work/*"))
