"""The pages: each is a template with a small dataclass as its context."""

from __future__ import annotations

from dataclasses import dataclass

from fastapi import APIRouter, Request
from fastapi.templating import Jinja2Templates
from starlette.responses import Response

from padstudio import __version__, resources
from padstudio.experiments.budget.conditions import QUANTITIES
from padstudio.experiments.shootout.boards.catalogue import BOARDS, EXTRA
from padstudio.web.pages import static
from padstudio.web.pages.headers import CAMERA_DEVICE, CHARTS_POLICY
from padstudio.web.server.services import ItemId
from padstudio.web.server.settings import Settings

router = APIRouter(include_in_schema=False)
router.include_router(static.router)
templates = Jinja2Templates(directory=resources.web_folder("templates"))
templates.env.globals["file_address"] = static.address

# A page changes with the program alone; the browser asks each time whether it has.
_HEADERS = {"Cache-Control": "no-cache"}
_CAMERA_HEADERS = _HEADERS | {"Permissions-Policy": CAMERA_DEVICE}
_CHART_HEADERS = _HEADERS | {"Content-Security-Policy": CHARTS_POLICY}


@dataclass(frozen=True)
class Page:
    """Context of a page of the studio.

    Attributes
    ----------
    name : str
        ``home``, ``design``, ``plan``, ``diagnose``, ``live``, ``flights``, ``cameras`` or
        ``experiments``; also the template's name.
    version : str
    max_upload_bytes, max_image_pixels : int
        Limits to check before a picture is sent.
    max_window, max_levels, max_cells : int
        Bounds of the form of a new pad.
    """

    name: str
    max_upload_bytes: int
    max_image_pixels: int
    max_window: int
    max_levels: int
    max_cells: int
    version: str = __version__


@dataclass(frozen=True)
class FlightPage:
    """Context of the page of one flight."""

    name: str = "flight"
    version: str = __version__


@dataclass(frozen=True)
class ErrorPage:
    """Context of the error page."""

    status: int
    title: str
    message: str
    name: str = "error"
    version: str = __version__


@router.get("/")
def home(request: Request) -> Response:
    return _page(request, "home")


@router.get("/design")
def design(request: Request) -> Response:
    return _page(request, "design", _CHART_HEADERS)


@router.get("/plan")
def plan(request: Request) -> Response:
    return _page(request, "plan", _CHART_HEADERS)


@router.get("/diagnose")
def diagnose(request: Request) -> Response:
    return _page(request, "diagnose")


@router.get("/live")
def live(request: Request) -> Response:
    return _page(request, "live", _CAMERA_HEADERS)


@router.get("/flights")
def flights(request: Request) -> Response:
    return _page(request, "flights")


@router.get("/cameras")
def cameras(request: Request) -> Response:
    return _page(request, "cameras")


@router.get("/experiments")
def experiments(request: Request) -> Response:
    return _page(request, "experiments", boards=BOARDS, extra=EXTRA, quantities=QUANTITIES)


@router.get("/flights/{flight_id}")
def flight(request: Request, flight_id: ItemId) -> Response:
    context = {"page": FlightPage()}
    return templates.TemplateResponse(request, "flight.html", context, headers=_CHART_HEADERS)


def error_page(request: Request, status: int, title: str, message: str) -> Response:
    """The page that says why another cannot be shown."""
    page = ErrorPage(status, title, message[:1].upper() + message[1:])
    return templates.TemplateResponse(
        request, "error.html", {"page": page}, status, headers={"Cache-Control": "no-store"}
    )


def _page(
    request: Request, name: str, headers: dict[str, str] = _HEADERS, **more: object
) -> Response:
    settings: Settings = request.app.state.settings
    page = Page(
        name,
        settings.max_upload_bytes,
        settings.max_image_pixels,
        settings.max_window,
        settings.max_levels,
        settings.max_cells,
    )
    context = {"page": page, **more}
    return templates.TemplateResponse(request, f"{name}.html", context, headers=headers)
