"""Holds the import directions of docs/architecture.md: one ordered list of all folders."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import padstudio

PACKAGE = Path(padstudio.__file__).parent

#: Every folder, and every module that stands in none, from the ground up. Each may import only
#: what stands above it in this list.
ORDER = (
    "__init__.py",
    "errors.py",
    "bounded_files.py",
    "network.py",
    "text.py",
    "resources.py",
    "arrays.py",
    "color.py",
    "machine_code.py",
    "compiled.py",
    "geometry/camera_files/parts",
    "geometry/camera_files/forms",
    "geometry/camera_files",
    "geometry",
    "pad",
    "pad/sheets",
    "pad/coverage",
    "pad/coding/search",
    "pad/coding",
    "render/painters",
    "render/pdf",
    "render",
    "simulate/lay",
    "simulate/radiance",
    "simulate",
    "vision/stage",
    "vision/fusion",
    "vision/frame",
    "vision/cells",
    "vision/search",
    "vision/pose",
    "vision/pose/pattern",
    "vision/refine",
    "vision/bend",
    "vision/outline",
    "vision/reasons",
    "vision/dense",
    "vision/baseline",
    "vision",
    "vision/overlays",
    "media",
    "media/recordings",
    "media/telemetry",
    "autopilot",
    "live/reports",
    "live/stream",
    "live/recording",
    "live/outputs/mavlink",
    "live/outputs",
    "live",
    "calibration",
    "experiments/figures",
    "experiments",
    "experiments/reproduction",
    "experiments/shootout/boards",
    "experiments/shootout",
    "experiments/budget",
    "store/migrations/versions",
    "store/migrations",
    "store/database",
    "store/uploads",
    "store",
    "workers",
    "live/watched",
    "flights/cluster",
    "flights/tasks",
    "flights/results",
    "flights/recorded",
    "flights/vehicle",
    "flights/pictures",
    "flights/tuning",
    "flights/bundles",
    "flights/exports/frames",
    "flights/exports",
    "flights",
    "web/schemas",
    "web/schemas/experiments",
    "web/server/callbacks",
    "web/server/live",
    "web/server",
    "web/pages",
    "web/http",
    "web/api",
    "web/api/experiments",
    "web/api/flights",
    "web/api/tuning",
    "web",
    "web/monitor",
    "warm.py",
    "cli",
    "cli/cameras",
    "cli/pads",
    "cli/bundles",
    "cli/remote",
    "cli/live",
    "cli/experiments",
)

#: A folder with more modules than this is no room any more but a hall.
MOST_MODULES = 14

#: Names in the package's head that everything may fetch from there.
PUBLIC = {"__version__"}

#: Libraries that only some modules may import.
CONFINED = {
    "alembic": ("store/",),
    "apsw": ("media/recordings/",),
    "av": (
        "media/video",
        "simulate/video_writer",
        "simulate/video_stream",
        "live/reports/",
        "live/stream/",
        "live/recording/",
    ),
    "dask": ("flights/cluster/",),
    "distributed": ("flights/cluster/",),
    "fastapi": ("web/",),
    "fsspec": ("media/",),
    "httpx": ("web/server/callbacks/", "cli/remote/"),
    "jinja2": ("web/",),
    "google": ("media/recordings/",),
    "lz4": ("media/recordings/",),
    "mcap": ("flights/exports/", "media/recordings/"),
    "llvmlite": ("machine_code.py",),
    "numba": ("compiled.py", "machine_code.py"),
    "pydantic": ("web/",),
    "pydantic_settings": ("web/",),
    "pymavlink": ("flights/exports/", "media/telemetry/", "autopilot/", "live/outputs/"),
    "pyulog": ("media/telemetry/",),
    "reportlab": ("render/pdf/",),
    "rich": ("cli/",),
    "rosbags": ("flights/exports/", "media/recordings/"),
    "sqlalchemy": ("store/", "flights/"),
    "starlette": ("web/",),
    "typer": ("cli/",),
    "uvicorn": ("web/",),
    "zstandard": ("media/recordings/",),
}

MODULES = sorted(PACKAGE.rglob("*.py"))
NAMES = {
    ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__"): path
    for path in MODULES
}


def place_of(path: Path) -> str:
    """The folder of a module, or the module itself where it stands in none."""
    inside = path.relative_to(PACKAGE)
    return inside.as_posix() if len(inside.parts) == 1 else inside.parent.as_posix()


def imported_names(source: str) -> Iterator[str]:
    """Absolute names of all imports, those in functions and for types only too."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative import"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@cache
def names_in(path: Path) -> frozenset[str]:
    """`imported_names` of a module."""
    return frozenset(imported_names(path.read_text(encoding="utf-8")))


def imported_modules(path: Path) -> set[Path]:
    """The package's own modules that a module imports."""
    found = set()
    for name in names_in(path):
        owner = name
        while owner and owner not in NAMES:
            owner = owner.rpartition(".")[0]
        if owner and name.removeprefix("padstudio.") not in PUBLIC:
            found.add(NAMES[owner])
    return found - {path}


def test_the_list_holds_every_folder_once() -> None:
    assert sorted(ORDER) == sorted({place_of(path) for path in MODULES})


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_module_imports_only_what_stands_below_it(path: Path) -> None:
    if path == PACKAGE / "__init__.py":
        return  # hands out public names lazily
    below = set(ORDER[: ORDER.index(place_of(path)) + 1])
    wrong = {str(other) for other in imported_modules(path) if place_of(other) not in below}
    assert not wrong


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_library_is_imported_only_where_it_belongs(path: Path) -> None:
    inside = path.relative_to(PACKAGE).as_posix()
    roots = {name.partition(".")[0] for name in names_in(path)}
    assert not [r for r in roots & set(CONFINED) if not inside.startswith(CONFINED[r])]


def test_modules_do_not_import_in_circles() -> None:
    done: set[Path] = set()

    def visit(path: Path, way: list[Path]) -> None:
        circle = way[way.index(path) :] if path in way else []
        assert not circle, " -> ".join(str(p.relative_to(PACKAGE)) for p in [*circle, path])
        if path not in done and path != PACKAGE / "__init__.py":
            for other in sorted(imported_modules(path)):
                visit(other, [*way, path])
        done.add(path)

    for path in MODULES:
        visit(path, [])


def test_no_folder_holds_more_modules_than_a_reader_takes_in() -> None:
    count: dict[Path, int] = defaultdict(int)
    for path in MODULES:
        if path.name != "__init__.py":
            count[path.parent] += 1
    assert not {str(f): n for f, n in count.items() if n > MOST_MODULES}


@pytest.mark.parametrize(
    "source",
    [
        "def f():\n    from padstudio.web import app",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from padstudio.web import app",
        "import padstudio.web.app",
    ],
)
def test_no_import_is_overlooked(source: str) -> None:
    assert any(name.startswith("padstudio.web") for name in imported_names(source))
