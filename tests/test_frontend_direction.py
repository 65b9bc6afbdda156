"""Holds the import directions of the pages' modules: server, shared, then one folder a page."""

from __future__ import annotations

import posixpath
import re
from collections import defaultdict
from pathlib import Path

import pytest
from places import ROOT

SCRIPTS = ROOT / "frontend" / "js"
MODULES = sorted(SCRIPTS.rglob("*.js"))
PAGES = (
    "design",
    "home",
    "diagnose",
    "flight",
    "flights",
    "plan",
    "cameras",
    "live",
    "experiments",
)

#: What a module of each folder may import, besides its own folder's modules.
MAY_IMPORT = {
    "theme.js": (),
    "server": (),
    "shared": ("server",),
    **dict.fromkeys(PAGES, ("server", "shared")),
}

#: A folder with more modules than this is no room any more but a hall.
MOST_MODULES = 14

# Imports for types only, in comments, are imports too.
_IMPORT = re.compile(r"""(?:\bfrom\s*|\bimport\s*\(?\s*)["']([^"']+\.js)["']""")
_ASKS_SERVER = re.compile(r"\b(?:fetch\(|EventSource|XMLHttpRequest|FormData|WebSocket|sendBeacon)")


def imports_of(module: Path) -> set[str]:
    """Modules that one imports, as paths within ``frontend/js``."""
    folder = module.relative_to(SCRIPTS).parent.as_posix()
    found = _IMPORT.findall(module.read_text(encoding="utf-8"))
    assert all(name.startswith(".") for name in found), f"{module}: an import is not relative"
    return {posixpath.normpath(posixpath.join(folder, name)) for name in found}


def part_of(name: str) -> str:
    return name.split("/")[0]


def name_of(module: Path) -> str:
    return module.relative_to(SCRIPTS).as_posix()


def test_every_folder_is_in_its_place() -> None:
    assert {part_of(name_of(module)) for module in MODULES} == set(MAY_IMPORT)


@pytest.mark.parametrize("module", MODULES, ids=name_of)
def test_imports_point_one_way(module: Path) -> None:
    part = part_of(name_of(module))
    allowed = {part, *MAY_IMPORT[part]}
    imported = imports_of(module)
    assert {name for name in imported if part_of(name) not in allowed} == set()
    assert {name for name in imported if not (SCRIPTS / name).is_file()} == set()


def test_only_server_talks_to_the_server() -> None:
    talkative = {
        name_of(module)
        for module in MODULES
        if _ASKS_SERVER.search(module.read_text(encoding="utf-8"))
    }
    assert {name for name in talkative if part_of(name) != "server"} == set()


def test_folders_are_rooms() -> None:
    counts: dict[str, int] = defaultdict(int)
    for module in MODULES:
        counts[name_of(module.parent)] += 1
    assert {name: count for name, count in counts.items() if count > MOST_MODULES} == {}
