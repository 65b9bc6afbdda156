"""A page's modules, joined into one script, do in the browser what they did apart."""

from __future__ import annotations

from collections.abc import Callable

from joined_modules import joined
from playwright.sync_api import Page


def test_a_script_runs_as_its_modules_do(open_page: Callable[..., Page]) -> None:
    said = open_page("/diagnose").evaluate(
        "() => { const said = []; const log = (...words) => said.push(...words);\n"
        + joined().script
        + "return said; }"
    )
    assert said == ["numbers", "words", "hello you 2", 8, 1]
