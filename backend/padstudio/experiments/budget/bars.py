"""Bars with bounds of confidence, as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from padstudio.experiments.budget.amounts import Amount
from padstudio.experiments.report import NONE

_COLORS = {"random": "#2b6cb0", "systematic": "#b7791f", "together": "#4a5568"}
_ROW, _TOP, _LEFT, _WIDE, _RIGHT = 30, 46, 200, 420, 150


@dataclass(frozen=True)
class Bar:
    """A bar.

    Attributes
    ----------
    title : str
    kind : {"random", "systematic", "together"}
    amount : Amount or None
        None where it is not measured.
    """

    title: str
    kind: str
    amount: Amount | None


def bars_svg(bars: Sequence[Bar], unit: str) -> bytes:
    """Horizontal bars; what cannot be told from nothing has an outline alone.

    Parameters
    ----------
    bars : sequence of Bar
    unit : str
    """
    longest = max((bar.amount.high for bar in bars if bar.amount), default=0.0) or 1.0
    width, height = _LEFT + _WIDE + _RIGHT, _TOP + _ROW * len(bars) + 12
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}" font-family="system-ui, sans-serif" font-size="13">',
        f'<rect width="{width}" height="{height}" fill="#fff"/>',
        *_legend(),
    ]
    for place, bar in enumerate(bars):
        parts += _row(bar, _TOP + _ROW * place, _WIDE / longest, unit)
    return "\n".join([*parts, "</svg>"]).encode()


def _legend() -> list[str]:
    parts, x = [], 10
    for kind, color in _COLORS.items():
        parts.append(f'<rect x="{x}" y="12" width="12" height="12" fill="{color}"/>')
        parts.append(f'<text x="{x + 18}" y="23" fill="#1a202c">{kind}</text>')
        x += 110
    parts.append(
        f'<rect x="{x}" y="12" width="12" height="12" fill="#fff" stroke="#4a5568" '
        'stroke-dasharray="3 2"/>'
    )
    note = "not to be told from nothing; lines: 95 % confidence"
    parts.append(f'<text x="{x + 18}" y="23" fill="#1a202c">{note}</text>')
    return parts


def _row(bar: Bar, y: int, scale: float, unit: str) -> list[str]:
    middle, color = y + _ROW / 2, _COLORS[bar.kind]
    parts = [
        f'<text x="{_LEFT - 10}" y="{middle + 4}" text-anchor="end" fill="#1a202c">'
        f"{escape(bar.title)}</text>"
    ]
    amount = bar.amount
    if amount is None:
        parts.append(
            f'<text x="{_LEFT}" y="{middle + 4}" fill="#1a202c">{NONE} not measured</text>'
        )
        return parts
    fill = f'fill="{color}"'
    length = amount.value * scale
    if not amount.is_resolved:
        fill = f'fill="#fff" stroke="{color}" stroke-dasharray="3 2"'
        length = amount.high * scale
    parts.append(f'<rect x="{_LEFT}" y="{y + 6}" width="{length:.1f}" height="18" {fill}/>')
    low, high = _LEFT + amount.low * scale, _LEFT + amount.high * scale
    parts.append(
        f'<path d="M{low:.1f} {middle}H{high:.1f}M{low:.1f} {middle - 4}v8M{high:.1f} '
        f'{middle - 4}v8" stroke="#1a202c" fill="none"/>'
    )
    told = f"{amount.value:.3g}" if amount.is_resolved else f"below {amount.high:.3g}"
    parts.append(
        f'<text x="{high + 8:.1f}" y="{middle + 4}" fill="#1a202c">{told} {escape(unit)}</text>'
    )
    return parts
