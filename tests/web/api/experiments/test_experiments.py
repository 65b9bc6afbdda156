"""Experiments through the interface: from an order to files that outlive the server."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest
import small_experiment
from web_server import running, settings_for, wait_until

from padstudio.experiments.writers import HTML_POLICY
from padstudio.web.api.experiments import kinds

ADDRESS = "/api/v1/experiments"
ORDER = {"kind": "reproduction", "seeds": 3, "only": ["attitude"]}
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module", autouse=True)
def _small() -> Iterator[None]:
    """Orders are made by an experiment that takes a moment."""
    known = kinds.KINDS["reproduction"]
    small = replace(known, make=small_experiment.make)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(kinds.KINDS, "reproduction", small)
        yield


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("data")


@pytest.fixture(scope="module")
def made(data: Path) -> dict[str, Any]:
    """An experiment that was made by a server that is gone."""
    with running(settings_for(data)) as server:
        answer = server.post(ADDRESS, json=ORDER | {"name": "tilts"})
        assert answer.status_code == 202, answer.text
        address = answer.headers["Location"]
        seen: list[int] = []

        def is_over() -> bool:
            job = server.get(address).json()
            seen.append(job["steps_done"])
            return job["state"] not in ("queued", "running")

        wait_until(is_over)
        assert seen == sorted(seen)
        job: dict[str, Any] = server.get(address).json()
    assert job["state"] == "done", job
    return job


@pytest.fixture(scope="module")
def server(data: Path, made: dict[str, Any]) -> Iterator[httpx.Client]:
    with running(settings_for(data)) as client:
        yield client


def test_what_was_made_outlives_the_server(server: httpx.Client, made: dict[str, Any]) -> None:
    assert server.get(f"{ADDRESS}/{made['id']}").json() == made
    (item,) = server.get(ADDRESS).json()["items"]
    assert item == {key: made[key] for key in item}
    assert item["order"] == ORDER | {"name": "tilts"}


def test_the_report_says_what_was_found(made: dict[str, Any]) -> None:
    assert made["steps_done"] == made["steps_total"] == 3
    (section,) = made["result"]["sections"]
    assert section["claims"][0]["sentence"] == "Held within reason."
    assert section["tables"][0]["rows"] == [["a", "1.23"], ["b", "0.00"], ["c", "–"]]
    assert section["figures"][0]["file"] == "sketch.svg"


def test_files_are_served_so_that_they_can_do_no_harm(
    server: httpx.Client, made: dict[str, Any], refused: Refused
) -> None:
    names = [file["name"] for file in made["files"]]
    assert {"report.md", "report.html", "small.csv", "sketch.svg"} <= set(names)
    for file in made["files"]:
        answer = server.get(f"{ADDRESS}/{made['id']}/files/{file['name']}").raise_for_status()
        assert len(answer.content) == file["size_bytes"]
        assert answer.headers["content-type"].startswith(file["media_type"])
        assert answer.headers["x-content-type-options"] == "nosniff"
        if file["name"].endswith((".md", ".csv")):
            assert answer.headers["content-disposition"].startswith("attachment")
        else:
            assert "sandbox" in answer.headers["content-security-policy"]
    page = server.get(f"{ADDRESS}/{made['id']}/files/report.html")
    assert page.headers["content-security-policy"] == HTML_POLICY
    for name in ("record.json", "result.json", "none.csv"):
        refused(server.get(f"{ADDRESS}/{made['id']}/files/{name}"), 404, "not_found")


@pytest.mark.parametrize(
    "change", [{"seeds": 0}, {"seeds": 101}, {"only": ["flight"]}, {"kind": "none"}, {"pad": "a"}]
)
def test_wrong_orders_are_refused(
    server: httpx.Client, refused: Refused, change: dict[str, Any]
) -> None:
    refused(server.post(ADDRESS, json=ORDER | change), 422, "invalid_request")


def test_one_that_runs_is_stopped_and_one_that_is_over_forgotten(
    server: httpx.Client, made: dict[str, Any], refused: Refused
) -> None:
    started = server.post(ADDRESS, json=ORDER | {"seeds": small_experiment.ENDLESS}).json()["id"]
    assert server.delete(f"{ADDRESS}/{started}").status_code == 204
    wait_until(lambda: server.get(f"{ADDRESS}/{started}").json()["state"] == "cancelled")
    assert server.delete(f"{ADDRESS}/{started}").status_code == 204
    assert server.delete(f"{ADDRESS}/{made['id']}").status_code == 204
    for gone in (started, made["id"]):
        refused(server.get(f"{ADDRESS}/{gone}"), 404, "not_found")
    assert server.get(ADDRESS).json()["items"] == []


def test_frames_beyond_the_servers_limit_are_refused(tmp_path: Path, refused: Refused) -> None:
    with running(settings_for(tmp_path, max_simulated_pixels=4_000_000)) as server:
        refused(server.post(ADDRESS, json=ORDER), 413, "too_many_pixels")
        assert server.get(ADDRESS).json()["items"] == []
