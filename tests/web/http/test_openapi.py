from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest
from web_server import running, settings_for

from padstudio.web.http.openapi import DescribedApp


def test_the_document_is_made_once_and_not_in_the_event_loop(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []
    document = DescribedApp.openapi

    def noted(app: DescribedApp) -> dict[str, Any]:
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            made.append("beside")
        else:
            made.append("within")
        return document(app)

    monkeypatch.setattr(DescribedApp, "openapi", noted)
    with running(settings_for(tmp_path)) as client:
        answers = [client.get("/api/v1/openapi.json") for _ in range(3)]
    assert made == ["beside"]
    assert {answer.content for answer in answers} == {answers[0].content}
    assert "/api/v1/pads" in answers[0].json()["paths"]
