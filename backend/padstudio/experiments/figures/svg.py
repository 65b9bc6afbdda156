"""Parts of plain SVG: lines, texts, dots.

No styles, no scripts: every colour is an attribute, so that a file looks alike everywhere. Figures
are drawn on white.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

#: Of what is compared, told apart by lightness, too.
COLORS = ("#0a6c62", "#c25514", "#2350d0", "#7b3fa0", "#4b525c")
#: Of words; of axes and what is said by the way; of a grid.
INK, QUIET, GRID = "#15181d", "#646b76", "#e3e6e9"
_FONT = 'font-family="system-ui, sans-serif"'

Point = tuple[float, float]


@dataclass(frozen=True)
class Key:
    """What a legend says of a series."""

    label: str
    color: str
    dashed: bool = False


def number(value: float) -> str:
    """A number beside a tick."""
    return f"{value:.6g}".replace("-", "−")


def line(a: Point, b: Point, color: str, width: float = 1) -> str:
    """A straight line."""
    return (
        f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" '
        f'stroke="{color}" stroke-width="{width:g}"/>'
    )


def polyline(points: Sequence[Point], color: str, dashed: bool = False) -> str:
    """A line through points."""
    dash = ' stroke-dasharray="6 4"' if dashed else ""
    return (
        f'<polyline points="{_places(points)}" fill="none" stroke="{color}" '
        f'stroke-width="1.8"{dash}/>'
    )


def polygon(points: Sequence[Point], fill: str, stroke: str, opacity: float = 1) -> str:
    """A closed shape."""
    return (
        f'<polygon points="{_places(points)}" fill="{fill}" fill-opacity="{opacity:g}" '
        f'stroke="{stroke}"/>'
    )


def _places(points: Sequence[Point]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def dot(x: float, y: float, color: str) -> str:
    """A point."""
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{color}"/>'


def text(words: str, x: float, y: float, anchor: str, color: str = QUIET, size: int = 12) -> str:
    """Words; `anchor` is start, middle or end."""
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{color}" '
        f'font-size="{size}" {_FONT}>{escape(words)}</text>'
    )


def legend(keys: Sequence[Key], left: float) -> str:
    """What each colour is, in a row at the top; keys without a label are left out."""
    parts = []
    for key in (key for key in keys if key.label):
        parts.append(polyline([(left, 16), (left + 22, 16)], key.color, key.dashed))
        parts.append(text(key.label, left + 28, 20, "start", INK))
        left += 50 + 6.6 * len(key.label)
    return "".join(parts)


def picture(parts: Sequence[str], size: tuple[int, int]) -> bytes:
    """A file of parts, on white."""
    width, height = size
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}"><rect width="{width}" height="{height}" '
        f'fill="#ffffff"/>{"".join(parts)}</svg>\n'
    ).encode()
