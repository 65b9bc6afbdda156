"""Holds the import directions of docs/architecture.md."""

import ast
from collections import defaultdict
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "backend" / "padstudio"

#: Which parts each part may import. Every part may import itself and `errors`.
ALLOWED = {
    "errors": set(),
    "resources": set(),
    "geometry": set(),
    "pad": set(),
    "render": {"pad"},
    "vision": {"pad", "geometry"},
    "simulate": {"pad", "geometry", "render"},
    "flights": {"pad", "geometry", "vision", "render"},
    "web": {"pad", "geometry", "vision", "render", "simulate", "flights", "resources"},
    "warm": {"pad", "vision"},
    "cli": {"pad", "geometry", "vision", "render", "simulate", "flights", "web", "resources"},
}

#: Libraries that only some modules may import.
CONFINED = {
    "fastapi": ("web/",),
    "starlette": ("web/",),
    "jinja2": ("web/",),
    "pydantic": ("web/",),
    "pydantic_settings": ("web/",),
    "uvicorn": ("web/",),
    "reportlab": ("render/pdf",),
    "sqlalchemy": ("flights/",),
    "alembic": ("flights/",),
    "av": ("flights/video", "simulate/video"),
    "mcap": ("flights/exports/",),
    "pymavlink": ("flights/exports/",),
    "dask": ("flights/engine", "flights/cluster_worker"),
    "distributed": ("flights/engine", "flights/cluster_worker"),
    "fsspec": ("flights/",),
    "sse_starlette": ("web/",),
    "typer": ("cli",),
    "rich": ("cli",),
}


def part_of(path):
    first = path.relative_to(PACKAGE).parts[0]
    return "cli" if first.startswith("cli") else first.removesuffix(".py")


def imported_modules(path):
    """Absolute names of all imports of a module, those within functions too."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


MODULES = [path for path in sorted(PACKAGE.rglob("*.py")) if path.parent != PACKAGE] + [
    path for path in sorted(PACKAGE.glob("*.py")) if path.name != "__init__.py"
]


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_module_imports_only_what_its_part_may(path):
    part = part_of(path)
    allowed = ALLOWED[part] | {part, "errors", "__version__"}
    wrong = []
    for name in imported_modules(path):
        root, _, rest = name.partition(".")
        if root == "padstudio":
            other = rest.partition(".")[0]
            other = "cli" if other.startswith("cli") else other
            if other not in allowed:
                wrong.append(name)
        elif root in CONFINED:
            inside = path.relative_to(PACKAGE).as_posix()
            if not inside.startswith(CONFINED[root]):
                wrong.append(name)
    assert not wrong


def test_modules_do_not_import_in_circles():
    graph = defaultdict(set)
    names = {".".join(p.relative_to(PACKAGE.parent).with_suffix("").parts): p for p in MODULES}
    for name, path in names.items():
        for imported in top_level_imports(path):
            while imported and imported not in names:
                imported = imported.rpartition(".")[0]
            if imported and imported != name:
                graph[name].add(imported)
    done = set()

    def visit(name, way):
        assert name not in way, " -> ".join([*way[way.index(name) :], name])
        if name not in done:
            for other in graph[name]:
                visit(other, [*way, name])
            done.add(name)

    for name in names:
        visit(name, [])


def top_level_imports(path):
    """Imports that run when the module is loaded: not those in functions or for types only."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@pytest.mark.parametrize(
    ("path", "expected"),
    [("cli_detect.py", "cli"), ("pad/spec.py", "pad"), ("errors.py", "errors")],
)
def test_parts_by_path(path, expected):
    assert part_of(PACKAGE / path) == expected
