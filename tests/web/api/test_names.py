"""Names: things are renamed, found by their names, and recognised when they come again."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from typing import Any

import httpx
import numpy as np
import pytest
from PIL import Image
from web_server import PRESET

from padstudio.geometry.camera import Camera
from padstudio.geometry.presets import PRESETS
from padstudio.pad.spec import Pad

API = "/api/v1"
Refused = Callable[..., dict[str, Any]]


def _pad(studio: httpx.Client, name: str, seed: int = 1) -> str:
    spec = {"name": name, "rows": 12, "cols": 18, "ratio": 2, "distance": 1, "seed": seed}
    made: str = studio.post(f"{API}/pads", json=spec).raise_for_status().json()["id"]
    return made


def _camera(studio: httpx.Client, name: str, focal: float = 500.0) -> str:
    camera = Camera(640, 480, np.array([[focal, 0, 320], [0, focal, 240], [0, 0, 1.0]]), name=name)
    files = {"file": ("camera.yaml", camera.to_ros_yaml())}
    made: str = studio.post(f"{API}/cameras", files=files).raise_for_status().json()["id"]
    return made


@pytest.mark.parametrize("make", [_pad, _camera])
def test_the_same_again_adds_nothing(
    studio: httpx.Client, make: Callable[[httpx.Client, str], str]
) -> None:
    kind = make.__name__[1:] + "s"
    first = make(studio, "twice")
    total = studio.get(f"{API}/{kind}").json()["total"]
    assert make(studio, "twice") == first
    assert studio.get(f"{API}/{kind}").json()["total"] == total
    assert make(studio, "other name") != first


def test_an_import_of_what_is_there_says_so(studio: httpx.Client) -> None:
    pad = studio.get(f"{API}/pads/{_pad(studio, 'known')}").json()["pad"]
    files = {"file": ("again.json", Pad.from_dict(pad).dumps())}
    answer = studio.post(f"{API}/pads/import", files=files)
    assert (answer.status_code, answer.json()["name"]) == (200, "known")


@pytest.mark.parametrize("make", [_pad, _camera])
def test_renamed_in_list_and_file(
    studio: httpx.Client, refused: Refused, make: Callable[[httpx.Client, str], str]
) -> None:
    kind = make.__name__[1:] + "s"
    made = make(studio, f"old {kind}")
    before = studio.get(f"{API}/{kind}/{made}").json()
    answer = studio.patch(f"{API}/{kind}/{made}", json={"name": " new ü "}).raise_for_status()
    assert answer.json()["name"] == "new ü"
    after = studio.get(f"{API}/{kind}/{made}").json()
    if kind == "pads":
        assert after["pad"] == {**before["pad"], "name": "new ü"}
    else:
        assert after == {**before, "name": "new ü"}
        file = studio.get(f"{API}/cameras/{made}/files/camera.yaml").content
        assert Camera.loads(file, "camera").name == "new ü"
    for bad in ("", "  ", "x" * 201):
        refused(studio.patch(f"{API}/{kind}/{made}", json={"name": bad}), 422, "invalid_request")
    refused(studio.patch(f"{API}/{kind}/0123", json={"name": "x"}), 404, "not_found")


def test_presets_keep_their_names(studio: httpx.Client, refused: Refused) -> None:
    refused(studio.patch(f"{API}/cameras/{PRESET}", json={"name": "x"}), 409, "conflict")


def test_requests_take_names(studio: httpx.Client, refused: Refused) -> None:
    _pad(studio, "by name", seed=2)
    camera_id = _camera(studio, "its camera", 510.0)
    picture = BytesIO()
    Image.new("RGB", (64, 48), (90, 90, 90)).save(picture, "PNG")

    def detect(pad: str, camera: str) -> httpx.Response:
        files = {"image": ("grey.png", picture.getvalue())}
        return studio.post(f"{API}/detect", data={"pad": pad, "camera": camera}, files=files)

    for camera in ("its camera", camera_id):
        assert detect("by name", camera).status_code == 200
    query = {"camera": PRESETS[PRESET].camera.name}
    found = studio.get(f"{API}/pads/{_pad(studio, 'covered')}/coverage", params=query)
    assert found.json()["view"]["width_px"] == PRESETS[PRESET].camera.width
    refused(detect("by nam", "its camera"), 404, "not_found")
    _pad(studio, "by name", seed=3)
    refused(detect("by name", "its camera"), 409, "ambiguous_name")


@pytest.mark.parametrize(("make", "size"), [(_pad, (240, 160)), (_camera, (240, 180))])
def test_thumbnails_are_small_pictures(
    studio: httpx.Client, make: Callable[[httpx.Client, str], str], size: tuple[int, int]
) -> None:
    kind = make.__name__[1:] + "s"
    answer = studio.get(f"{API}/{kind}/{make(studio, 'pictured')}/thumbnail.png")
    assert answer.headers["content-type"] == "image/png"
    picture = Image.open(BytesIO(answer.content))
    assert picture.size == size
    low, high = picture.convert("L").getextrema()
    assert low < high
