from __future__ import annotations

from collections.abc import Callable
from typing import Any

import httpx
from web_server import wait_until

from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad

SAMPLES = "/api/v1/samples"


def test_every_listed_file_is_served_and_is_what_it_says(studio: httpx.Client) -> None:
    body = studio.get(SAMPLES).json()
    pad = Pad.loads(studio.get(body["pad"]).raise_for_status().content)
    assert pad.window >= 2
    camera = Camera.loads(studio.get(body["camera"]).raise_for_status().content, "camera")
    assert camera.width > camera.height
    assert len(body["pictures"]) >= 3
    for address in body["pictures"]:
        response = studio.get(address).raise_for_status()
        assert response.headers["content-type"] == "image/jpeg"
        assert response.content.startswith(b"\xff\xd8")


def test_pictures_come_from_the_highest_to_the_lowest(studio: httpx.Client) -> None:
    names = [address.rsplit("/", 1)[1] for address in studio.get(SAMPLES).json()["pictures"]]
    heights = [int(name[7:-6]) for name in names if name.startswith("height_")]
    assert heights == sorted(heights, reverse=True)
    assert not names[-1].startswith("height_")


def test_only_files_of_the_sample_are_served(
    studio: httpx.Client, refused: Callable[..., dict[str, Any]]
) -> None:
    refused(studio.get(f"{SAMPLES}/other.jpg"), 404, "not_found")
    refused(studio.get(f"{SAMPLES}/app.py"), 422, "invalid_request")
    refused(studio.get(f"{SAMPLES}/..%2Fpad.json"), 404, "not_found")


def test_the_sample_flight_is_read_and_is_the_same_flight_again(studio: httpx.Client) -> None:
    first = studio.post(f"{SAMPLES}/flight")
    again = studio.post(f"{SAMPLES}/flight")
    assert (first.status_code, again.status_code) == (202, 200)
    assert again.json()["id"] == first.json()["id"]
    address = f"/api/v1/flights/{first.json()['id']}"
    wait_until(lambda: studio.get(address).json()["state"] not in ("queued", "running"))
    flight = studio.get(address).json()
    assert (flight["state"], flight["frames_total"]) == ("done", 72)
    assert flight["frames_ok"] >= 70
    studio.delete(address)
    assert studio.post(f"{SAMPLES}/flight").json()["id"] != first.json()["id"]
