"""Opens a bundle from anywhere: refused as a whole where anything in it is odd."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np

from padstudio.arrays import Image, YuvFrame
from padstudio.errors import StudioError, shown
from padstudio.flights.bundles import contents
from padstudio.flights.bundles.around import Around
from padstudio.flights.bundles.contents import Alone, Bundle, Neighbour
from padstudio.flights.bundles.members import BundleError, json_object, members_of
from padstudio.flights.tasks.detectors import Recipe, params_from
from padstudio.geometry.camera import Camera
from padstudio.media import images
from padstudio.pad.spec import Pad
from padstudio.vision.dense.tracker import Expectation

_VIEW_NAME = re.compile(r"^[a-z]{1,20}$")
_MOST_VIEWS, _VIEW_LENGTH = 40, 4000
_VERSION_LENGTH = 60
# A plane's rows against the picture's; decoders round them up.
_MOST_ROW = 2
_Field = dict[str, Any]


def unpack(data: bytes, max_pixels: int = images.MAX_PIXELS) -> Bundle:
    """Open a bundle.

    Parameters
    ----------
    data : bytes
        The zip's.
    max_pixels : int
        Limit on the frame.

    Raises
    ------
    BundleError
        If it is no bundle, damaged, of a newer kind, or holds what bundles do not.
    LimitError
        If it is beyond a limit; nothing has been unpacked then.
    StudioError
        If its pad, camera, parameters or frame cannot be used.
    """
    members = members_of(data)
    manifest = json_object(members, contents.MANIFEST)
    if manifest.get("format") != contents.FORMAT:
        raise BundleError("the zip is no bundle of Pad Studio; choose one", code="not_a_bundle")
    if manifest.get("format_version") != contents.FORMAT_VERSION:
        raise BundleError(
            f"the bundle is of format {shown(manifest.get('format_version'))}, this program reads "
            f"{contents.FORMAT_VERSION}; open it with a newer one",
            code="bundle_version",
        )
    for name in (contents.PAD, contents.CAMERA):
        if name not in members:
            raise BundleError(f"the bundle lacks {name}; make it again")
    try:
        return _bundle(members, manifest, max_pixels)
    except StudioError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise BundleError(
            f"the bundle's {contents.MANIFEST} is damaged ({error!r}); make the bundle again"
        ) from error


def _bundle(members: Mapping[str, bytes], manifest: _Field, max_pixels: int) -> Bundle:
    recipe = _recipe(members, manifest)
    frame, original = _frame(members, manifest["planes"], max_pixels)
    reading = manifest["reading"]
    if reading not in ("still", "run"):
        raise ValueError(f"reading {shown(reading)}")
    expected = manifest["expected"]
    return Bundle(
        recipe,
        frame,
        original,
        reading,
        None if expected is None else Expectation.from_dict(expected),
        _known(manifest["result"]),
        recorded=_record(manifest["recorded"]),
        recorded_version=str(manifest["recorded_version"])[:_VERSION_LENGTH],
        alone=_alone(manifest["alone"]),
        around=_around(members),
        trace=_stages(members),
        view=_view(manifest["view"]),
        neighbours=_neighbours(members, manifest["neighbours"], max_pixels),
        versions={
            str(k)[:_VERSION_LENGTH]: str(v)[:_VERSION_LENGTH]
            for k, v in list(manifest["versions"].items())[:20]
        },
    )


def _recipe(members: Mapping[str, bytes], manifest: _Field) -> Recipe:
    method, params = _way(manifest)
    pads = [members[contents.PAD].decode()]
    while (name := contents.other_pad(len(pads) - 1)) in members:
        pads.append(members[name].decode())
    camera = members[contents.CAMERA].decode()
    for pad in pads:
        Pad.loads(pad)
    Camera.loads(camera)
    return Recipe(pads[0], camera, method, params, tuple(pads[1:]))


def _way(given: _Field) -> tuple[Any, str]:
    """A method, and its parameters as a recipe has them."""
    method, params = given["method"], given["params"]
    if method not in ("dense", "paper"):
        raise ValueError(f"method {shown(method)}")
    params_from(params)
    return method, json.dumps(params, sort_keys=True)


def _frame(
    members: Mapping[str, bytes], planes: _Field | None, max_pixels: int
) -> tuple[Image | YuvFrame, bytes | None]:
    original = members.get(contents.ORIGINAL)
    bgr = images.decode(original or members[contents.PIXELS], max_pixels)
    if planes is None:
        return bgr, original
    height, width = bgr.shape[:2]
    half = (-(-height // 2), -(-width // 2))
    if planes["standard"] not in ("bt601", "bt709") or type(planes["full_range"]) is not bool:
        raise ValueError("planes of another kind")
    y, u, v = (_plane(members[name], max_pixels) for name in contents.PLANES)
    # Rows may hold more than the picture.
    sizes = (y.shape, (height, width)), (u.shape, half), (v.shape, half)
    if u.shape != v.shape or any(is_[0] != be[0] or is_[1] < be[1] for is_, be in sizes):
        raise ValueError("planes of another size than the picture")
    kind = planes["standard"], planes["full_range"]
    return YuvFrame(y, u, v, width, *kind, make_bgr=lambda: bgr), None


def _plane(data: bytes, max_pixels: int) -> Image:
    images.read_header(data, _MOST_ROW * max_pixels)
    plane = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    if plane is None or plane.ndim != 2 or plane.dtype != np.uint8:
        raise ValueError("a plane that is no grey picture")
    return np.asarray(plane, np.uint8)


def _neighbours(
    members: Mapping[str, bytes], given: list[_Field], max_pixels: int
) -> tuple[Neighbour, ...]:
    if len(given) > contents.MOST_NEIGHBOURS:
        raise ValueError("more neighbours than two")
    found = []
    for each in given:
        offset = -1 if each["offset"] < 0 else 1
        name = contents.neighbour_name(offset)
        picture = images.decode(members[name], max_pixels) if each["picture"] else None
        found.append(Neighbour(offset, picture, _record(each["result"])))
    return tuple(found)


def _around(members: Mapping[str, bytes]) -> Around | None:
    if contents.AROUND not in members:
        return None
    return Around.from_dict(json_object(members, contents.AROUND))


def _alone(value: _Field | None) -> Alone | None:
    if value is None:
        return None
    return Alone(*_way(value), _known(value["result"]))


def _known(value: Any) -> _Field:
    record = _record(value)
    if record is None:
        raise ValueError("no result")
    return record


def _record(value: Any) -> _Field | None:
    if value is not None and not isinstance(value, dict):
        raise ValueError("a result that is no object")
    if value is not None and value.get("status") not in ("ok", "failed"):
        raise ValueError("a result without a status")
    return value


def _stages(members: Mapping[str, bytes]) -> list[_Field]:
    stages = json_object(members, contents.TRACE)["stages"]
    for each in stages:
        if not isinstance(each["name"], str) or not isinstance(each["channel"], str | None):
            raise ValueError("stages that are none")
    return list(stages)


def _view(value: Any) -> dict[str, str]:
    """What of an address may be taken over: short texts under plain names."""
    if not isinstance(value, dict) or len(value) > _MOST_VIEWS:
        raise ValueError("a view that is none")
    for name, text in value.items():
        if not _VIEW_NAME.match(name) or not isinstance(text, str) or len(text) > _VIEW_LENGTH:
            raise ValueError(f"a view of {shown(name)}")
    return value
