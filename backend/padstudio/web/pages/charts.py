"""Plotly's JavaScript, from its Python package: the flight page draws its figures with it."""

from __future__ import annotations

import gzip
from functools import lru_cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from fastapi import APIRouter, Request
from starlette.responses import Response

from padstudio.errors import NotFoundError
from padstudio.web.pages.headers import CONTENT_SECURITY_POLICY

router = APIRouter(include_in_schema=False)

#: Its address changes with its version, so that a browser may keep it for good.
SCRIPT_URL = f"/static/plotly-{version('plotly')}.min.js"

# Plotly places two style sheets in the page: an empty one, to which it adds rules, and one of maps,
# which changes with its version and is not missed where it is refused.
_STYLES = (
    "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='",
    "'sha256-ji27qzEtxXZW+7dun6UwjHXJ18e6WAin1VvNtkzIE/o='",
)
#: Pages with charts allow these, and like all others no further inline style or script.
CHARTS_POLICY = CONTENT_SECURITY_POLICY.replace(
    "style-src 'self'", f"style-src 'self' {' '.join(_STYLES)}"
)


@router.get(SCRIPT_URL)
def get_plotly(request: Request) -> Response:
    headers = {
        "Cache-Control": "public, max-age=31536000, immutable",
        "Vary": "Accept-Encoding",
    }
    packed = "gzip" in request.headers.get("accept-encoding", "")
    if packed:
        headers["Content-Encoding"] = "gzip"
    return Response(_script(packed), media_type="text/javascript", headers=headers)


@lru_cache(maxsize=2)
def _script(packed: bool) -> bytes:
    # Found without importing the package, which takes half a second.
    spec = find_spec("plotly")
    folders = (spec.submodule_search_locations if spec else None) or []
    for folder in folders:
        path = Path(folder) / "package_data" / "plotly.min.js"
        if path.is_file():
            script = path.read_bytes()
            return gzip.compress(script, 6) if packed else script
    raise NotFoundError("Plotly's JavaScript is missing: install the package plotly again")
