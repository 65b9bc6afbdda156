"""The pages' files under addresses that change with their content, so that browsers keep them.

A page asks for one script (its modules, joined), one style sheet, the theme's script and the icon.
Files are made when they are first asked for, and anew when one of their sources has changed.
"""

from __future__ import annotations

import gzip
import hashlib
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.util import find_spec
from pathlib import Path
from time import monotonic

from fastapi import APIRouter, Request
from starlette.responses import Response

from padstudio import resources
from padstudio.errors import NotFoundError, shown
from padstudio.web.pages.bundles import bundle

router = APIRouter(include_in_schema=False)

#: Plotly's JavaScript, from its Python package.
CHARTS = "plotly.min.js"

_FRONTEND = resources.web_folder("frontend")
_EVERY_PAGE = ("tokens", "base", "controls", "layout", "lists")
#: Style sheets of each page, in their order.
_SHEETS = {
    "home": (*_EVERY_PAGE, "home"),
    "design": (*_EVERY_PAGE, "viewer", "design", "print"),
    "plan": (*_EVERY_PAGE, "diagnose", "plan"),
    "diagnose": (*_EVERY_PAGE, "diagnose", "report", "viewer", "workbench"),
    "live": (*_EVERY_PAGE, "diagnose", "live"),
    "flights": (*_EVERY_PAGE, "diagnose", "flights"),
    "flight": (
        *_EVERY_PAGE,
        "diagnose",
        "report",
        "viewer",
        "workbench",
        "flights",
        "flight",
        "frames",
    ),
    "cameras": (*_EVERY_PAGE, "diagnose", "flights", "cameras"),
    "experiments": (*_EVERY_PAGE, "experiments"),
    "error": _EVERY_PAGE,
}
_MEDIA_TYPES = {
    ".js": "text/javascript",
    ".css": "text/css",
    ".map": "application/json",
    ".svg": "image/svg+xml",
}
# Hundreds of files are looked at, which takes longer than all else of a page.
_LOOK_AGAIN_S = 1.0
_FOR_GOOD = "public, max-age=31536000, immutable"


@dataclass(frozen=True)
class _File:
    """A file as it is sent."""

    content: bytes

    @cached_property
    def digest(self) -> str:
        return hashlib.sha256(self.content).hexdigest()[:16]

    @cached_property
    def packed(self) -> bytes:
        return gzip.compress(self.content, 6, mtime=0)


def address(name: str) -> str:
    """Address of a page's file: ``design.js``, ``design.css``, ``theme.js``, ``icon.svg``, …"""
    return f"/static/{_file(name, _changed()).digest}/{name}"


@router.get("/static/{digest}/{name}")
def get_file(request: Request, digest: str, name: str) -> Response:
    file = _file(name, _changed())
    # An address of before a change gets the file of after it, and is asked for again.
    kept = _FOR_GOOD if digest == file.digest else "no-cache"
    headers = {"Cache-Control": kept, "Vary": "Accept-Encoding"}
    packed = "gzip" in request.headers.get("accept-encoding", "")
    if packed:
        headers["Content-Encoding"] = "gzip"
    content = file.packed if packed else file.content
    return Response(content, media_type=_MEDIA_TYPES[Path(name).suffix], headers=headers)


def _changed() -> int:
    """When a file of the pages last changed, ns; looked up once a second at the most."""
    return _changed_by(int(monotonic() / _LOOK_AGAIN_S))


@lru_cache(maxsize=1)
def _changed_by(_look: int) -> int:
    return max(path.stat().st_mtime_ns for path in (_FRONTEND, *_FRONTEND.rglob("*")))


@lru_cache(maxsize=64)
def _file(name: str, changed: int) -> _File:
    """The file of a name; `changed` tells one state of the sources from another."""
    if name == CHARTS:
        return _charts()
    if name == "icon.svg":
        return _File((_FRONTEND / name).read_bytes())
    if name == "theme.js":
        return _File((_FRONTEND / "js" / name).read_bytes())
    page, _, form = name.partition(".")
    if page in _SHEETS and form == "css":
        sheets = (_FRONTEND / "css" / f"{sheet}.css" for sheet in _SHEETS[page])
        return _File(b"".join(sheet.read_bytes() for sheet in sheets))
    if page in _SHEETS and page != "error" and form in ("js", "js.map"):
        joined = bundle(f"{page}/{page}.js", _read_module)
        script = f"{joined.script}//# sourceMappingURL={page}.js.map\n"
        return _File((script if form == "js" else joined.source_map).encode())
    raise NotFoundError(f"no file {shown(name)} belongs to the pages")


def _read_module(name: str) -> str:
    return (_FRONTEND / "js" / name).read_text(encoding="utf-8")


@lru_cache(maxsize=1)
def _charts() -> _File:
    # Found without importing the package, which takes half a second.
    spec = find_spec("plotly")
    for folder in (spec.submodule_search_locations if spec else None) or []:
        path = Path(folder) / "package_data" / CHARTS
        if path.is_file():
            return _File(path.read_bytes())
    raise NotFoundError("Plotly's JavaScript is missing: install the package plotly again")
