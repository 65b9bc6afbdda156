"""A client generated from the OpenAPI document does a user's work, as docs/rest.md shows it."""

from __future__ import annotations

import ast
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from document_blocks import ROOT, block, run_python, run_shell, serving

PAGE = "docs/rest.md"


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with serving(tmp_path_factory.mktemp("data")) as url:
        yield url


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, address: str) -> Path:
    """Where a user has the samples and generates the client."""
    path = tmp_path_factory.mktemp("user")
    shutil.copytree(ROOT / "samples", path / "samples")
    said = run_shell(block(PAGE, "sh", "openapi-python-client"), path, address)
    assert "WARNING" not in said, said
    return path


def test_the_program_of_the_page(folder: Path, address: str) -> None:
    said = run_python(block(PAGE, "python", "pad_studio_client"), folder, address).splitlines()
    detected, flown = said
    assert ast.literal_eval(detected)[2] == pytest.approx(450, rel=0.02)
    state, frames, position = flown.split(maxsplit=2)
    assert (state, frames) == ("done", "12")
    assert ast.literal_eval(position)[2] > 0


def test_a_refusal_is_an_error_body(folder: Path, address: str) -> None:
    said = run_python(
        "from pad_studio_client import Client\n"
        "from pad_studio_client.api.pads import get_pad\n"
        "from pad_studio_client.api.uploads import get_upload_offset\n"
        "from pad_studio_client.models import GetUploadOffsetTusResumable as Version\n"
        f"client = Client('{address}', raise_on_unexpected_status=True)\n"
        "print(get_pad.sync('none', client=client).error.code)\n"
        "answer = get_upload_offset.sync_detailed(\n"
        "    'none', client=client, tus_resumable=Version.VALUE_0)\n"
        "print(answer.status_code.value)\n",
        folder,
    )
    assert said.split() == ["not_found", "404"]
