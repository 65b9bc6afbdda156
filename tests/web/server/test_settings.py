from __future__ import annotations

import re
from pathlib import Path

import pytest
from places import DOCS

from padstudio.errors import SpecError
from padstudio.web.server import settings
from padstudio.web.server.settings import Settings, load_settings

PAGE = DOCS / "settings.md"


@pytest.fixture(autouse=True)
def _clean(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in Settings.model_fields:
        monkeypatch.delenv(f"PADSTUDIO_{name.upper()}", raising=False)


def test_every_setting_is_documented_with_its_default() -> None:
    rows = re.findall(r"^\| `PADSTUDIO_(\w+)` \| (.+?) \| (.+) \|$", PAGE.read_text(), re.MULTILINE)
    documented = {name.lower(): default.strip("`") for name, default, _ in rows}
    assert len(documented) == len(rows)
    assert documented.keys() == Settings.model_fields.keys()
    for name, field in Settings.model_fields.items():
        if name not in ("data", "token", "database_url", "allowed_hosts"):
            assert documented[name] == str(field.default), name
        assert field.description


def test_the_environment_is_read(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PADSTUDIO_DATA", str(tmp_path))
    monkeypatch.setenv("PADSTUDIO_MAX_CELLS", "50")
    monkeypatch.setenv("PADSTUDIO_ALLOWED_HOSTS", '["a.example"]')
    read = load_settings()
    assert (read.data, read.max_cells, read.allowed_hosts) == (tmp_path, 50, ("a.example",))
    assert load_settings(max_cells=7, port=None).max_cells == 7


def test_the_default_folder_follows_the_platform(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(settings.sys, "platform", "linux")
    monkeypatch.setenv("XDG_DATA_HOME", "/x")
    assert settings.default_data_folder() == Path("/x/padstudio")
    monkeypatch.delenv("XDG_DATA_HOME")
    assert settings.default_data_folder() == Path.home() / ".local/share/padstudio"
    monkeypatch.setattr(settings.sys, "platform", "darwin")
    assert settings.default_data_folder().parent.name == "Application Support"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("PADSTUDIO_PORT", "99999"),
        ("PADSTUDIO_PORT", "http"),
        ("PADSTUDIO_TOKEN", "short"),
        ("PADSTUDIO_TOKEN", "with spaces and & signs in it"),
        ("PADSTUDIO_MAX_IMAGE_PIXELS", "1000000000"),
    ],
)
def test_wrong_settings_are_named(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    monkeypatch.setenv(name, value)
    with pytest.raises(SpecError, match=name) as caught:
        load_settings()
    assert caught.value.error_code == "invalid_setting"


def test_secrets_are_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PADSTUDIO_TOKEN", "a-token-of-some-length")
    monkeypatch.setenv("PADSTUDIO_DATABASE_URL", "postgresql://me:password@db/x")
    assert "a-token" not in repr(load_settings())
    assert "password" not in repr(load_settings())
