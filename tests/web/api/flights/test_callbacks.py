"""Flights that call when they have ended, and flights that are ordered once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import videos
from callback_receiver import Receiver, receiving
from flight_orders import camera
from web_server import PAD_FILE, running, settings_for, wait_until

from padstudio.web.server.callbacks import service

Refused = Callable[..., dict[str, Any]]
API = "/api/v1"


class Client:
    """A client with a pad, a camera and a video uploaded."""

    def __init__(self, client: httpx.Client, folder: Path) -> None:
        self.client = client
        path = videos.write(folder / "a.mp4", 2)
        headers = {
            "Tus-Resumable": "1.0.0",
            "Upload-Length": str(path.stat().st_size),
            "Content-Type": "application/offset+octet-stream",
        }
        self.order = {
            "uploads": [self._id("/uploads", content=path.read_bytes(), headers=headers)],
            "pad": self._id("/pads/import", files={"file": ("pad.json", PAD_FILE)}),
            "camera": self._id("/cameras", files={"file": ("camera.yaml", camera())}),
        }

    def _id(self, path: str, **request: Any) -> str:
        return str(self.client.post(API + path, **request).raise_for_status().json()["id"])

    def post(self, key: str | None = None, **values: Any) -> httpx.Response:
        headers = {} if key is None else {"Idempotency-Key": key}
        return self.client.post(f"{API}/flights", json=self.order | values, headers=headers)

    def get(self, flight: str) -> dict[str, Any]:
        return dict(self.client.get(f"{API}/flights/{flight}").raise_for_status().json())


@pytest.fixture(scope="module")
def receiver() -> Iterator[Receiver]:
    with receiving() as found:
        yield found


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory, receiver: Receiver) -> Iterator[Client]:
    folder = tmp_path_factory.mktemp("called")
    settings = settings_for(
        folder / "data", callback_hosts=(receiver.host,), callback_secret="s" * 24
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(service, "WAITS_S", (0.01,) * 3)
        patch.setattr(service, "_LOOK_S", 0.05)
        with running(settings) as client:
            yield Client(client, folder)


def test_a_flight_calls_once_when_it_has_ended(server: Client, receiver: Receiver) -> None:
    receiver.answers += [500, 503]
    flight = server.post(callback=receiver.url).raise_for_status().json()
    assert flight["callback"]["url"] == receiver.url
    wait_until(lambda: server.get(flight["id"])["callback"]["state"] == "delivered")
    found = server.get(flight["id"])
    told = receiver.bodies()
    assert len(told) == found["callback"]["attempts"] == 3
    assert found["callback"]["error"] is None
    assert {each["data"]["state"] for each in told} == {found["state"]} == {"done"}
    assert told[0]["data"]["frames_total"] == found["frames_total"] == 2
    links = told[0]["data"]["links"]
    assert all(server.client.get(link).status_code == 200 for link in links.values())


def test_another_run_calls_where_it_is_told_to(server: Client, receiver: Receiver) -> None:
    flight = server.post().raise_for_status().json()
    assert flight["callback"] is None
    address = f"{API}/flights/{flight['id']}/rerun"
    changes = {"method": "paper", "callback": receiver.url}
    again = server.client.post(address, json=changes).raise_for_status().json()
    assert again["callback"]["state"] == "open"
    plain = server.client.post(address, json={}).raise_for_status().json()
    assert plain["callback"] is None


@pytest.mark.parametrize("url", ["https://other.example/", "http://127.0.0.1:1/", "no address"])
def test_hosts_that_are_not_listed_are_refused(server: Client, refused: Refused, url: str) -> None:
    before = server.client.get(f"{API}/flights").json()["total"]
    refused(server.post(callback=url), 422, "callback_refused")
    assert server.client.get(f"{API}/flights").json()["total"] == before


def test_an_order_under_the_same_key_makes_no_second_flight(server: Client) -> None:
    key = "0123456789abcdef"
    first, again = server.post(key), server.post(key, name="again")
    assert (first.status_code, again.status_code) == (202, 200)
    assert first.json()["id"] == again.json()["id"]
    assert first.headers["location"] == again.headers["location"]
    assert server.post("another-key-of-16").json()["id"] != first.json()["id"]
    server.client.delete(first.headers["location"]).raise_for_status()
    assert server.post(key).status_code == 202


def test_a_key_is_long_enough_to_be_nobody_elses(server: Client, refused: Refused) -> None:
    refused(server.post("short"), 422, "invalid_request")
