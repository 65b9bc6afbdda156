"""One run against another over REST, on a real flight."""

from __future__ import annotations

from typing import Any

import pytest

API = "/api/v1/flights"


@pytest.fixture(scope="module")
def runs(api: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """A flight, and a run of it that loses frames."""
    first = api.finished(api.order().json()["id"])
    changes = {"params": {"search": {"least_edges": 90_000}}, "end_frame": 40}
    second = api.client.post(f"{API}/{first['id']}/rerun", json=changes)
    return first, api.finished(second.json()["id"])


def test_what_one_run_lost_the_other_won(api: Any, runs: Any) -> None:
    first, second = (run["id"] for run in runs)
    found = api.get(f"{second}/comparison/{first}?columns=7")
    back = api.get(f"{first}/comparison/{second}")
    assert found["frames"] == back["frames"] == 40
    assert (found["only_first"], found["only_second"]) == (20, 0)
    assert (found["won"], found["lost"]) == (back["lost"], back["won"])
    statuses = [
        {item["frame"]: item["status"] for item in api.get(f"{run}/frames")["items"]}
        for run in (first, second)
    ]
    lost = [f for f, status in statuses[1].items() if (statuses[0][f], status) == ("ok", "failed")]
    assert found["lost"] == len(lost)
    assert len(found["columns"]) <= 7
    assert sum(column["lost"] for column in found["columns"]) == len(lost)
    items = api.get(f"{second}/comparison/{first}/frames?kind=lost")["items"]
    assert [item["frame"] for item in items] == lost
    for item in items:
        assert (item["own"]["status"], item["other"]["status"]) == ("failed", "ok")


def test_pages_go_both_ways(api: Any, runs: Any) -> None:
    first, second = (run["id"] for run in runs)
    pages = f"{second}/comparison/{first}/frames"
    page = api.get(f"{pages}?limit=15")
    frames = [item["frame"] for item in page["items"]]
    assert (frames, page["next_after"]) == (list(range(15)), 14)
    rest = api.get(f"{pages}?limit=30&after={page['next_after']}")
    assert [item["frame"] for item in rest["items"]] == list(range(15, 40))
    assert rest["next_after"] is None
    before = api.get(f"{pages}?limit=3&before=20")
    assert [item["frame"] for item in before["items"]] == [17, 18, 19]


def test_a_run_beside_itself_changes_nothing(api: Any, runs: Any) -> None:
    first = runs[0]["id"]
    found = api.get(f"{first}/comparison/{first}")
    assert (found["won"], found["lost"], found["frames"]) == (0, 0, 60)
    if found["moved"]:
        assert found["moved"]["worst_mm"] == 0.0
    assert api.get(f"{first}/comparison/{first}/frames?kind=changed")["items"] == []
    assert (
        len(api.get(f"{first}/comparison/{first}/frames?kind=moved&least_mm=0")["items"])
        == (found["both"])
    )


def test_flights_of_other_files_are_refused(api: Any, runs: Any, refused: Any) -> None:
    sample = api.client.post("/api/v1/samples/flight").json()["id"]
    api.finished(sample)
    first = runs[0]["id"]
    refused(api.client.get(f"{API}/{first}/comparison/{sample}"), 409, "other_files")
    refused(api.client.get(f"{API}/{first}/comparison/0123456789abcdef"), 404, "not_found")
    refused(api.client.get(f"{API}/{first}/comparison/x!"), 422, "invalid_request")
