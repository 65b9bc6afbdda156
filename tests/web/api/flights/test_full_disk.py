"""A flight that waits for a full disk says so, and goes on."""

from __future__ import annotations

from typing import Any

import pytest
from flight_api import Api
from sqlalchemy.exc import OperationalError
from web_server import wait_until

from padstudio.flights.chunks import Chunks


def test_a_full_disk_is_told_while_a_flight_waits(
    api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("padstudio.flights.runner._RETRY_S", 0.1)
    finish_plan, is_full = Chunks.finish_plan, [True]

    def finish(chunks: Chunks, *given: Any) -> bool:
        if is_full:
            raise OperationalError("INSERT", {}, Exception("database or disk is full"))
        return finish_plan(chunks, *given)

    monkeypatch.setattr(Chunks, "finish_plan", finish)
    flight = api.order(end_frame=1).raise_for_status().json()["id"]
    wait_until(lambda: api.get(flight)["notice"] is not None)
    waiting = api.get(flight)
    assert waiting["state"] == "running"
    assert "the disk that holds the database is full; make room" in waiting["notice"]
    is_full.clear()
    over = api.finished(flight)
    assert (over["state"], over["frames_done"], over["notice"]) == ("done", 1, None)
