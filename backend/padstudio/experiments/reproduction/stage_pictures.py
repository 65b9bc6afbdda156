"""The method's stages on one frame, and the five rows of sampled points, as pictures."""

from __future__ import annotations

import cv2
import numpy as np

from padstudio.arrays import Array, Image
from padstudio.experiments.report import Cell, Column, Figure, Table
from padstudio.experiments.reproduction.plan import (
    SERIES_MM,
    WINDOW,
    Shot,
    imaging_of,
    noise_of,
    paper_camera,
    scene_of,
)
from padstudio.experiments.reproduction.reading import detector
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Channel
from padstudio.simulate.render import render
from padstudio.vision.baseline.decode import WindowRead
from padstudio.vision.overlays.stages import stage_picture
from padstudio.vision.stage.detection import Detection

#: Heights of the pictures that show the five rows of sampled points, mm.
SAMPLED_MM = (1500.0, 200.0, 80.0)
#: The stages in the article's order, a to f, and their words.
_STAGES = (
    ("stretch", "frame"),
    ("channel", "channel"),
    ("clean", "block mean, cleaned"),
    ("edges", "edges"),
    ("lines", "lines"),
    ("grid", "central window"),
)
_TILE = (420, 236)
# A picture of a document stays below this, however much there is to see.
_MOST_BYTES = 58_000
_GREEN, _YELLOW, _WHITE, _BLACK = (90, 220, 90), (60, 210, 250), (255, 255, 255), (0, 0, 0)


def stages_figure() -> Figure:
    """Stages a to f of the paper's method, in the channel that its pose rests on."""
    found = _traced(SERIES_MM)
    channel = _channel(found)
    tiles = []
    for letter, (name, words) in zip("abcdef", _STAGES, strict=True):
        assert found.trace is not None
        shown = None if name == "stretch" else channel
        picture = stage_picture(found.trace, name, shown)
        tiles.append(_tile(picture, f"{letter}  {words}"))
    return Figure(
        "stages",
        ".webp",
        _webp(np.vstack([np.hstack(tiles[:3]), np.hstack(tiles[3:])])),
        f"The stages a to f on a frame from {SERIES_MM / 10:g} cm: {_listed()}.",
        "Six pictures: a photograph of the pad, and what five stages make of it.",
    )


def sampling() -> tuple[Figure, Table]:
    """The central window from three heights with its rows of sampled points, and their values."""
    tiles, rows = [], []
    for height_mm in SAMPLED_MM:
        found = _traced(height_mm)
        read = _window(found)
        words = f"{height_mm / 10:g} cm"
        tiles.append(_sampled_tile(found, read, words))
        rows += _values(height_mm, read)
    figure = Figure(
        "sampling",
        ".webp",
        _webp(np.hstack(tiles)),
        "The central window and the points at which its five rows are sampled, from "
        + ", ".join(f"{height / 10:g} cm" for height in SAMPLED_MM)
        + ".",
        "Three windows of five by five cells, each with five rows of five points.",
    )
    columns = (
        Column("height, cm", 0),
        Column("layer"),
        Column("row"),
        *(Column(f"cell {k + 1}", 0) for k in range(WINDOW)),
        Column("levels read"),
        Column("levels of the pad"),
    )
    table = Table(
        "sampling",
        "Grey values (0 … 255) at the sampled points, row by row, and the levels they are read as.",
        columns,
        tuple(rows),
    )
    return figure, table


def _listed() -> str:
    return ", ".join(
        f"({letter}) {words}" for letter, (_, words) in zip("abcdef", _STAGES, strict=True)
    )


def _traced(height_mm: float) -> Detection:
    """A frame from straight above, read by the paper's method with a trace."""
    shot = Shot("stages", 0, 0)
    pose = look_at_pad(
        height_mm, tilt_deg=1.5, heading_deg=8.0, tilt_towards_deg=60.0, target_mm=(12.0, -7.0)
    )
    imaging, noise = imaging_of(shot), noise_of(shot)
    image = render(scene_of(shot), paper_camera(), pose, imaging, noise).image
    return detector("paper").detect(image, trace=True)


def _channel(found: Detection) -> Channel:
    return "red" if found.layer == "red" else "blue"


def _window(found: Detection) -> WindowRead | None:
    """The window that the pose rests on, or the last one that was read."""
    assert found.trace is not None
    record = found.trace.get("decode", _channel(found))
    return record.output if record and isinstance(record.output, WindowRead) else None


def _part(read: WindowRead) -> tuple[slice, slice]:
    """The window's cells among all that were read."""
    row, column = read.window.row - read.cells.row0, read.window.column - read.cells.column0
    return slice(row, row + WINDOW), slice(column, column + WINDOW)


def _sampled_tile(found: Detection, read: WindowRead | None, words: str) -> Image:
    assert found.trace is not None
    if read is None:
        return _tile(found.trace.image, f"{words}: no window")
    corners = read.window.corners_xy
    low, high = corners.min(axis=0), corners.max(axis=0)
    half = 0.62 * float((high - low).max())
    scale = _TILE[1] / (2 * half)
    move = np.array(_TILE) / 2 - scale * (low + high) / 2
    matrix = np.array([[scale, 0, move[0]], [0, scale, move[1]]])
    mode = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    picture = np.asarray(cv2.warpAffine(found.trace.image, matrix, _TILE, flags=mode), np.uint8)
    _stroke(picture, corners * scale + move, closed=True)
    points = read.cells.xy[_part(read)] * scale + move
    for row in points:
        _stroke(picture, row, closed=False)
        for x, y in row:
            place = (round(float(x)), round(float(y)))
            cv2.circle(picture, place, 5, _BLACK, -1, cv2.LINE_AA)
            cv2.circle(picture, place, 4, _YELLOW, -1, cv2.LINE_AA)
    return _labelled(picture, f"{words}, {read.layer.channel}")


def _stroke(picture: Image, points: Array, *, closed: bool) -> None:
    color = _GREEN if closed else _YELLOW
    shown = np.round(points).astype(np.int32).reshape(-1, 1, 2)
    cv2.polylines(picture, [shown], closed, color, 2 if closed else 1, cv2.LINE_AA)


def _values(height_mm: float, read: WindowRead | None) -> list[tuple[Cell, ...]]:
    if read is None:
        return [(height_mm / 10, "none", None, *[None] * WINDOW, None, None)]
    part = _part(read)
    values = read.cells.values[part]
    levels, expected = read.cells.levels(2)[part], read.expected[part]
    return [
        (
            height_mm / 10,
            read.layer.channel,
            row + 1,
            *(float(value) for value in values[row]),
            "".join(str(level) for level in levels[row]),
            "".join(str(level) for level in expected[row]),
        )
        for row in range(len(values))
    ]


def _tile(picture: Image | None, words: str) -> Image:
    if picture is None:
        picture = np.zeros((_TILE[1], _TILE[0], 3), np.uint8)
    height, width = picture.shape[:2]
    share = min(_TILE[0] / width, _TILE[1] / height)
    size = (max(1, round(width * share)), max(1, round(height * share)))
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    out = np.zeros((_TILE[1], _TILE[0], 3), np.uint8)
    top, left = (_TILE[1] - size[1]) // 2, (_TILE[0] - size[0]) // 2
    out[top : top + size[1], left : left + size[0]] = small
    return _labelled(out, words)


def _labelled(picture: Image, words: str) -> Image:
    font = cv2.FONT_HERSHEY_SIMPLEX
    width = cv2.getTextSize(words, font, 0.5, 1)[0][0]
    cv2.rectangle(picture, (0, 0), (12 + width, 24), _BLACK, -1)
    cv2.putText(picture, words, (6, 17), font, 0.5, _WHITE, 1, cv2.LINE_AA)
    picture[:, -2:] = picture[-2:] = 255
    return picture


def _webp(picture: Image) -> bytes:
    """WebP of the best quality that stays small."""
    data = b""
    for quality in (85, 75, 65, 55, 45, 35, 25):
        _, coded = cv2.imencode(".webp", picture, [cv2.IMWRITE_WEBP_QUALITY, quality])
        data = coded.tobytes()
        if len(data) <= _MOST_BYTES:
            break
    return data
